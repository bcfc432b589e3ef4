//! Conditions, loads and obstacles.

use super::frame::Frame;
use super::shape::{part, volume_of_hole};
use crate::scene::{Drift, Part, Place, Push, Rubs, Scene, Wall, Way};
use mtled::Vector3;
use mtled::geometry::{Extent, Field, Shape};
use mtled::problem::{
    Amplitude, BodyForce, Cavity, EssentialCondition, Fluid, Friction, Loads, Obstacle, Prescribed,
    Pressure, RigidMotion, RigidWay, Spring, Traction,
};

/// When loads are complete \[s\]: at the end of a static problem, at half of a motion.
pub(crate) fn ramp(scene: &Scene) -> Amplitude {
    let part = if scene.is_static() { 1.0 } else { 0.5 };
    Amplitude::Smooth { duration: part * duration(scene) }
}

/// How long a run lasts \[s\].
pub(crate) fn duration(scene: &Scene) -> f64 {
    match scene.way {
        Way::Newton => 1.0,
        Way::Motion { end, .. } => end * scene.wave_time(),
    }
}

pub(crate) fn conditions(scene: &Scene, frame: &Frame) -> Vec<EssentialCondition> {
    let end = duration(scene);
    let condition = |(n, hold): (usize, &crate::scene::Hold)| EssentialCondition {
        name: format!("hold {n}"),
        extent: if hold.inner { Extent::Volume } else { Extent::Surface },
        part: part(scene, frame, &hold.part),
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
                part: part(scene, frame, on),
                acceleration: acceleration(v).into(),
                amplitude,
            }),
            Push::Traction(on, v) => loads.tractions.push(Traction {
                name,
                part: part(scene, frame, on),
                traction: stress(v).into(),
                amplitude,
            }),
            Push::Pressure(on, p) => loads.pressures.push(Pressure {
                name,
                part: part(scene, frame, on),
                pressure: scene.young_modulus * p,
                amplitude,
            }),
            Push::Throw(on, v) => {
                let velocity = scene.size / scene.wave_time() * frame.direction(&(*v).into());
                loads.initial_velocities.push((part(scene, frame, on), velocity.into()));
            }
        }
    }
}

/// Adds the springs of a scene, and its hole with what fills it.
pub(crate) fn load_more(scene: &Scene, frame: &Frame, loads: &mut Loads) {
    if let Some(bed) = &scene.bed {
        let unit = scene.young_modulus / scene.size;
        loads.springs.push(Spring {
            name: "bed".into(),
            part: part(scene, frame, &bed.part),
            normal: unit * bed.normal,
            tangential: unit * bed.tangential,
        });
    }
    if scene.form.has_hole() {
        let fluid = scene.filling.map(|filling| Fluid {
            bulk_modulus: scene.young_modulus * filling.bulk_modulus,
            inflow: volume_of_hole(scene) * filling.inflow,
            amplitude: ramp(scene),
        });
        let part = part(scene, frame, &Part::Hole);
        loads.cavities.push(Cavity { name: "hole".into(), part, opening: None, fluid });
    }
}

pub(crate) fn obstacles(scene: &Scene, frame: &Frame) -> Vec<Obstacle> {
    let Some(Wall { round, gap, drift, rubs }) = scene.obstacle else { return Vec::new() };
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
    let friction = match rubs {
        Rubs::Free => Friction::Frictionless,
        Rubs::Sticks => Friction::NoSlip,
        Rubs::Coulomb(coefficient) => Friction::Coulomb(coefficient),
    };
    let motions = drift.map_or_else(Vec::new, |drift| motions(scene, frame, &below, &drift));
    vec![Obstacle { friction, motions, ..solid("wall", shape) }]
}

/// The motions of an obstacle whose highest point is given over the size.
fn motions(scene: &Scene, frame: &Frame, top: &Vector3, drift: &Drift) -> Vec<RigidMotion> {
    let motion = |way: RigidWay| RigidMotion { way, amplitude: ramp(scene) };
    let turn = RigidWay::Rotation {
        point: frame.point(top),
        axis: frame.direction(&Vector3::z()),
        // An axial vector keeps its sense in a mirror image.
        angle: frame.turn.determinant() * drift.turn,
    };
    let shift = RigidWay::Translation(frame.length(&drift.by.into()));
    let turns = (drift.turn != 0.0).then(|| motion(turn));
    turns.into_iter().chain([motion(shift)]).collect()
}

/// A frictionless obstacle.
pub(crate) fn solid(name: &str, shape: Shape) -> Obstacle {
    Obstacle::new(name, shape)
}
