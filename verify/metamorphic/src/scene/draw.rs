//! Scenes at random.

use super::{
    Basis, Cloud, Form, Gradients, Hold, Inclusion, Law, Part, Piece, Place, Push, Rubs, Scene,
    Wall, Way,
};
use fastrand::Rng;

/// One of several.
pub(super) fn one<T: Copy>(rng: &mut Rng, of: &[T]) -> T {
    of[rng.usize(..of.len())]
}

pub(super) fn chance(rng: &mut Rng, one_in: usize) -> bool {
    rng.usize(..one_in) == 0
}

/// Uniform between two numbers, with three digits, so that scenes are easy to read.
pub(super) fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    rounded(low + (high - low) * rng.f64())
}

/// Of a few digits.
fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// Components between −largest and largest, some of them 0; none out of a plane.
pub(super) fn vector(rng: &mut Rng, components: usize, largest: f64) -> [f64; 3] {
    let mut v = [0.0; 3];
    for c in &mut v[..components] {
        *c = if chance(rng, 3) { 0.0 } else { largest * between(rng, -1.0, 1.0) };
    }
    v
}

impl Scene {
    /// A scene from random numbers.
    pub fn draw(rng: &mut Rng) -> Scene {
        let thickness = chance(rng, 4).then(|| one(rng, &[1.0, 0.1, 0.37]));
        let forms = match thickness {
            None => &FORMS[..],
            Some(_) => &PLANE_FORMS[..],
        };
        let law = one(rng, &LAWS);
        let nearly = one(rng, &[0.42, 0.45, 0.49]);
        let poisson_ratio = match law {
            Law::MooneyRivlin | Law::Ogden => nearly,
            _ => one(rng, &[0.0, 0.25, 0.3, nearly]),
        };
        let motion = chance(rng, 3);
        let way = match motion {
            false => Way::Newton,
            true => {
                Way::Motion { end: between(rng, 0.3, 1.5), damping: one(rng, &[0.0, 0.0, 0.5]) }
            }
        };
        let mut scene = Scene {
            size: 10f64.powi(rng.i32(-3..=3)) * one(rng, &[1.0, 0.7, 1.3]),
            young_modulus: 10f64.powi(rng.i32(0..=9)) * one(rng, &[1.0, 3.0]),
            poisson_ratio,
            density: 10f64.powi(rng.i32(0..=4)),
            law,
            form: one(rng, forms),
            edges: edges(rng),
            thickness,
            spacings: if thickness.is_some() { rng.u32(6..=12) } else { rng.u32(3..=6) },
            cloud: one(rng, &[Cloud::Lattice, Cloud::Lattice, Cloud::Jittered, Cloud::Graded]),
            seed: rng.u32(..1000),
            basis: if chance(rng, 6) { Basis::Quadratic } else { Basis::Linear },
            gradients: one(rng, &GRADIENTS),
            direct: chance(rng, 4),
            even_mass: chance(rng, 4),
            projected: !chance(rng, 3),
            way,
            inclusion: None,
            obstacle: None,
            holds: Vec::new(),
            pushes: Vec::new(),
            bed: None,
            filling: None,
            memory: None,
            tension: None,
        };
        scene.even_mass |= scene.basis == Basis::Quadratic;
        // By a number that is drawn already, so that the other scenes stay what they were.
        scene.law = match scene.seed % 8 {
            3 => Law::Muscle,
            5 => Law::Sheets,
            _ => law,
        };
        scene.draw_conditions(rng);
        // By other numbers than those to come, for the same reason.
        let mut others = Rng::with_seed(!rng.clone().u64(..));
        scene.draw_more(&mut others);
        scene
    }

    fn draw_conditions(&mut self, rng: &mut Rng) {
        let d = self.components();
        if chance(rng, 4) {
            let axis = rng.u8(..d as u8);
            self.inclusion = Some(Inclusion {
                axis,
                stiffness: one(rng, &[0.3, 3.0, 10.0]),
                piece: Piece::Half,
            });
        }
        let motion = !self.is_static();
        let along = rng.u8(..d as u8);
        if !(motion && chance(rng, 3)) {
            self.holds.push(Hold {
                part: Part::End { axis: along, upper: false, depth: self.depth(rng) },
                inner: chance(rng, 6),
                to: Place::Still,
                release: None,
            });
            if !chance(rng, 3) {
                self.draw_second_hold(rng, along, motion);
            }
        }
        for _ in 0..one(rng, &[0, 1, 1, 2]) {
            let push = self.draw_push(rng, along, motion);
            self.pushes.push(push);
        }
        if chance(rng, 5) {
            let (round, gap) = (chance(rng, 3), one(rng, &[0.01, 0.05, 0.3]));
            self.obstacle = Some(Wall { round, gap, drift: None, rubs: Rubs::Free });
        }
    }

    /// How deep an end is: flat forms have faces, others need some depth.
    fn depth(&self, rng: &mut Rng) -> f64 {
        match self.form {
            Form::Box | Form::Corner | Form::Bored if !chance(rng, 4) => 1e-4,
            _ => between(rng, 0.15, 0.4),
        }
    }

    fn draw_second_hold(&mut self, rng: &mut Rng, along: u8, motion: bool) {
        let d = self.components();
        let to = match rng.usize(..5) {
            0 => Place::Roller(rng.u8(..d as u8)),
            1 => Place::Turned(if d == 2 { 2 } else { rng.u8(..3) }, between(rng, -0.4, 0.4)),
            2 => Place::Bent(between(rng, -0.1, 0.1)),
            _ => Place::By(vector(rng, d, 0.15)),
        };
        let part = match chance(rng, 4) {
            true => Part::Spot { axis: along, upper: true, radius: between(rng, 0.3, 0.6) },
            false => Part::End { axis: along, upper: true, depth: self.depth(rng) },
        };
        let release = (motion && chance(rng, 3)).then(|| between(rng, 0.2, 0.8));
        self.holds.push(Hold { part, inner: chance(rng, 6), to, release });
    }

    fn draw_push(&self, rng: &mut Rng, along: u8, motion: bool) -> Push {
        let d = self.components();
        let axis = if chance(rng, 2) { along } else { rng.u8(..d as u8) };
        let upper = axis == along || rng.bool();
        let part = match rng.usize(..4) {
            0 => Part::Spot { axis, upper, radius: between(rng, 0.4, 0.8) },
            1 => Part::Whole,
            _ => Part::End { axis, upper, depth: self.depth(rng) },
        };
        // Not in the middle, where nodes and points lie and round-off would choose.
        let half = Part::End { axis, upper, depth: 0.487 };
        match rng.usize(..6) {
            0 | 1 => Push::Gravity(vector(rng, d, 0.1)),
            2 => Push::Pull(half, vector(rng, d, 0.1)),
            3 => Push::Traction(part, vector(rng, d, 0.05)),
            4 => Push::Pressure(part, between(rng, -0.05, 0.05)),
            _ if motion => Push::Throw(half, vector(rng, d, 0.1)),
            _ => Push::Gravity(vector(rng, d, 0.05)),
        }
    }
}

const FORMS: [Form; 12] = [
    Form::Box,
    Form::Box,
    Form::Box,
    Form::Ball,
    Form::Ellipsoid,
    Form::Cylinder,
    Form::Corner,
    Form::Dome,
    Form::Bored,
    Form::Rounded,
    Form::Wedge,
    Form::Voxels,
];
/// Those that have a cross-section.
const PLANE_FORMS: [Form; 6] =
    [Form::Box, Form::Box, Form::Ellipsoid, Form::Corner, Form::Bored, Form::Dome];
const LAWS: [Law; 8] = [
    Law::LogJ,
    Law::LogJ,
    Law::LogJ,
    Law::Isochoric,
    Law::MooneyRivlin,
    Law::Ogden,
    Law::StVenantKirchhoff,
    Law::Linear,
];
const GRADIENTS: [Gradients; 4] =
    [Gradients::SecondOrder, Gradients::SecondOrder, Gradients::Consistent, Gradients::Plain];

/// One of them 1.
fn edges(rng: &mut Rng) -> [f64; 3] {
    let mut edges = [1.0; 3];
    let long = rng.usize(..3);
    for (axis, edge) in edges.iter_mut().enumerate() {
        if axis != long {
            *edge = one(rng, &[1.0, 0.8, 0.61, 0.5]);
        }
    }
    edges
}
