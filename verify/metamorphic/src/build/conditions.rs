//! Conditions, loads and obstacles.

use super::frame::Frame;
use super::shape::part;
use crate::scene::{Place, Push, Scene, Wall, Way};
use mtled::Vector3;
use mtled::geometry::{Extent, Field, Shape};
use mtled::problem::{
    Amplitude, BodyForce, EssentialCondition, Loads, Obstacle, Prescribed, Pressure, Traction,
};

/// When loads are complete \[s\]: at the end of a static problem, at half of a motion.
fn ramp(scene: &Scene) -> Amplitude {
    match scene.way {
        Way::Newton => Amplitude::Smooth { duration: 1.0 },
        Way::Motion { end, .. } => Amplitude::Smooth { duration: 0.5 * end * scene.wave_time() },
    }
}

pub fn conditions(scene: &Scene, frame: &Frame) -> Vec<EssentialCondition> {
    let end = match scene.way {
        Way::Newton => 1.0,
        Way::Motion { end, .. } => end * scene.wave_time(),
    };
    let condition = |(n, hold): (usize, &crate::scene::Hold)| EssentialCondition {
        name: format!("hold {n}"),
        extent: if hold.inner { Extent::Volume } else { Extent::Surface },
        part: part(frame, &hold.part),
        prescribed: prescribed(frame, &hold.to),
        amplitude: ramp(scene),
        release: hold.release.map(|fraction| fraction * end),
    };
    scene.holds.iter().enumerate().map(condition).collect()
}

fn prescribed(frame: &Frame, to: &Place) -> Prescribed {
    match *to {
        Place::Still => Prescribed::Displacement([Some(0.0); 3]),
        Place::Roller(axis) => {
            let axis = frame.axis(usize::from(axis));
            Prescribed::Displacement([0, 1, 2].map(|k| (k == axis).then_some(0.0)))
        }
        Place::By(by) => Prescribed::Displacement(frame.length(&by.into()).map(Some).into()),
        Place::Turned(axis, angle) => Prescribed::Rotation {
            point: frame.point(&frame.middle()),
            axis: frame.direction(&Vector3::ith(usize::from(axis), 1.0)),
            // An axial vector keeps its sense in a mirror image.
            angle: frame.turn.determinant() * angle,
        },
        Place::Bent(most) => {
            let frame = *frame;
            Prescribed::Field(Field::of(move |place| {
                let at = frame.home_of(place);
                frame.length(&Vector3::new(most * at.y, most * at.x * at.y, 0.0))
            }))
        }
    }
}

/// Adds the loads of a scene.
pub fn load(scene: &Scene, frame: &Frame, loads: &mut Loads) {
    let stress = |v: &[f64; 3]| scene.young_modulus * frame.direction(&(*v).into());
    let acceleration = |v: &[f64; 3]| stress(v) / (scene.density * scene.size);
    for (n, push) in scene.pushes.iter().enumerate() {
        let (name, amplitude) = (format!("push {n}"), ramp(scene));
        match push {
            Push::Gravity(v) => loads.body_forces.push(BodyForce {
                part: mtled::geometry::Selector::All,
                acceleration: acceleration(v).into(),
                amplitude,
            }),
            Push::Pull(on, v) => loads.body_forces.push(BodyForce {
                part: part(frame, on),
                acceleration: acceleration(v).into(),
                amplitude,
            }),
            Push::Traction(on, v) => loads.tractions.push(Traction {
                name,
                part: part(frame, on),
                traction: stress(v).into(),
                amplitude,
            }),
            Push::Pressure(on, p) => loads.pressures.push(Pressure {
                name,
                part: part(frame, on),
                pressure: scene.young_modulus * p,
                amplitude,
            }),
            Push::Throw(on, v) => {
                let velocity = scene.size / scene.wave_time() * frame.direction(&(*v).into());
                loads.initial_velocities.push((part(frame, on), velocity.into()));
            }
        }
    }
}

pub fn obstacles(scene: &Scene, frame: &Frame) -> Vec<Obstacle> {
    let Some(Wall { round, gap }) = scene.obstacle else { return Vec::new() };
    let mut below = frame.middle();
    below.y = -gap;
    let shape = match round {
        true => Shape::Sphere {
            centre: frame.point(&(below - 0.8 * Vector3::y())),
            radius: 0.8 * frame.size,
        },
        false => {
            Shape::HalfSpace { point: frame.point(&below), normal: frame.direction(&Vector3::y()) }
        }
    };
    vec![solid("wall", shape)]
}

/// A frictionless obstacle.
pub fn solid(name: &str, shape: Shape) -> Obstacle {
    Obstacle::new(name, shape)
}
