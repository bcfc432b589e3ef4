//! What acts on the body: forces per mass and area, pressures, springs, fluids in cavities.

use crate::algebra::tensor::Vector3;
use crate::geometry::{Field, Selector};
use crate::problem::amplitude::Amplitude;
use crate::problem::check::{Mistake, Mistakes, Wrong};

/// Every load, and the velocity at the start.
#[derive(Debug, Clone, Default)]
pub struct Loads {
    /// Forces per mass; they add up.
    pub body_forces: Vec<BodyForce>,
    /// Forces per reference area; they add up.
    pub tractions: Vec<Traction>,
    /// Pressures on the deformed surface; they add up.
    pub pressures: Vec<Pressure>,
    /// Elastic beds of parts of the surface; they add up.
    pub springs: Vec<Spring>,
    /// Surfaces that enclose a volume.
    pub cavities: Vec<Cavity>,
    /// Velocity at t = 0 \[m/s\], the first part that contains a node, at whose parameters it is set.
    pub initial_velocities: Vec<(Selector, Field)>,
}

impl Loads {
    /// The parts of the surface that something acts on, or whose volume is measured.
    pub fn parts_of_surface(&self) -> impl Iterator<Item = &Selector> {
        let tractions = self.tractions.iter().map(|row| &row.part);
        let pressures = self.pressures.iter().map(|row| &row.part);
        let springs = self.springs.iter().map(|row| &row.part);
        tractions.chain(pressures).chain(springs).chain(self.cavities.iter().map(|row| &row.part))
    }

    /// What is wrong with their numbers, each by its field.
    pub(super) fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        let fluids =
            || self.cavities.iter().enumerate().filter_map(|(n, c)| Some((n, c.fluid.as_ref()?)));
        let body_forces = self.body_forces.iter().map(|row| &row.amplitude).enumerate();
        let tractions = self.tractions.iter().map(|row| &row.amplitude).enumerate();
        let pressures = self.pressures.iter().map(|row| &row.amplitude).enumerate();
        let body_forces = body_forces.map(|(n, a)| (format!("body_forces[{n}]"), a));
        let tractions = tractions.map(|(n, a)| (format!("tractions[{n}]"), a));
        let pressures = pressures.map(|(n, a)| (format!("pressures[{n}]"), a));
        let filled = fluids().map(|(n, fluid)| (format!("cavities[{n}].fluid"), &fluid.amplitude));
        for (of, amplitude) in body_forces.chain(tractions).chain(pressures).chain(filled) {
            found.part(&format!("{of}.amplitude"), amplitude.check());
        }
        for (n, spring) in self.springs.iter().enumerate() {
            found.part(&format!("springs[{n}]"), spring.check());
        }
        for (n, fluid) in fluids() {
            found.part(&format!("cavities[{n}].fluid"), fluid.check());
        }
        found.0
    }
}

/// A force per mass \[N/kg\] on the body or a part of it, such as what lies above a fluid.
#[derive(Debug, Clone)]
pub struct BodyForce {
    /// The quadrature points that it acts on.
    pub part: Selector,
    /// At amplitude 1 \[N/kg\].
    pub acceleration: Field,
    /// The factor over time.
    pub amplitude: Amplitude,
}

/// A dead traction: force per reference area \[Pa\], whose direction stays as it is.
#[derive(Debug, Clone)]
pub struct Traction {
    /// Name in reports and messages.
    pub name: String,
    /// Which part of the boundary.
    pub part: Selector,
    /// At amplitude 1 \[Pa\].
    pub traction: Field,
    /// The factor over time.
    pub amplitude: Amplitude,
}

/// A pressure \[Pa\] along the inward normal of the deformed surface: it turns with the
/// surface, and its force goes with the deformed area.
#[derive(Debug, Clone)]
pub struct Pressure {
    /// Name in reports and messages.
    pub name: String,
    /// Which part of the boundary.
    pub part: Selector,
    /// At amplitude 1 \[Pa\]; positive where it presses on the body.
    pub pressure: f64,
    /// The factor over time.
    pub amplitude: Amplitude,
}

/// Springs all over a part of the boundary, between each point and where it was: a force
/// −(k_n N ⊗ N + k_t (1 − N ⊗ N)) u per reference area \[Pa\], with N the normal of the surface at
/// rest. A Robin condition.
#[derive(Debug, Clone)]
pub struct Spring {
    /// Name in reports and messages.
    pub name: String,
    /// Which part of the boundary.
    pub part: Selector,
    /// k_n, along the normal \[Pa/m\].
    pub normal: f64,
    /// k_t, along the surface \[Pa/m\].
    pub tangential: f64,
}

impl Spring {
    /// What is wrong with its numbers, each by its field.
    pub fn check(&self) -> Vec<Mistake> {
        let mut mistakes = Mistakes::default();
        for (field, stiffness) in [("normal", self.normal), ("tangential", self.tangential)] {
            mistakes.not_negative(field, stiffness);
            mistakes.finite(field, stiffness);
        }
        if self.normal == 0.0 && self.tangential == 0.0 {
            mistakes.add("normal", Some(Wrong::NoStiffness));
        }
        mistakes.0
    }
}

/// A part of the boundary that encloses a volume V = −⅓ ∮ (x − c)·n da, in a plane
/// −½ ∮ (x − c)·n da of the slab, with n out of the body and c a point of the opening, if there
/// is one.
#[derive(Debug, Clone)]
pub struct Cavity {
    /// Name in reports and messages.
    pub name: String,
    /// Which part of the boundary.
    pub part: Selector,
    /// A point of the plane of the opening \[m\], in which the rim stays; none where the surface is
    /// closed.
    pub opening: Option<Vector3>,
    /// What fills it; nothing where its volume is only measured.
    pub fluid: Option<Fluid>,
}

/// A fluid that fills a cavity and presses on its walls with p = κ (V₀ + inflow − V)/V₀.
#[derive(Debug, Clone)]
pub struct Fluid {
    /// κ \[Pa\]
    pub bulk_modulus: f64,
    /// Volume that is added at amplitude 1 \[m³\], in a plane to the cavity of the slab.
    pub inflow: f64,
    /// The factor over time.
    pub amplitude: Amplitude,
}

impl Fluid {
    /// Of water at 20 °C \[Pa\] (CRC Handbook of Chemistry and Physics: compressibility 4.59e-10 1/Pa).
    pub const WATER: f64 = 2.18e9;

    /// What is wrong with its numbers, each by its field.
    pub fn check(&self) -> Vec<Mistake> {
        let mut mistakes = Mistakes::default();
        mistakes.positive("bulk_modulus", self.bulk_modulus);
        mistakes.finite("bulk_modulus", self.bulk_modulus);
        mistakes.finite("inflow", self.inflow);
        mistakes.0
    }
}
