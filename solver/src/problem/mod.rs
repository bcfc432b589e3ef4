//! What is to be solved: plain data, read from a case file or written by hand.
#![allow(non_snake_case)]

mod amplitude;
mod check;
mod conditions;
pub mod defaults;
mod fibres;
mod loads;
mod motion;
mod obstacles;
mod recipe;

pub use crate::geometry::{Dimension, Field};
pub use amplitude::Amplitude;
pub(crate) use check::refuse;
pub use check::{Mistake, Wrong};
pub use conditions::{EssentialCondition, Prescribed};
pub use fibres::{ActiveStress, Fibres, NoDirection};
pub use loads::{BodyForce, Cavity, Fluid, Loads, Pressure, Spring, Traction};
pub use motion::{Motion, Newton, Relaxation, RelaxationMass, StepControl};
pub(crate) use obstacles::depends_on_way;
pub use obstacles::{Friction, Obstacle, ObstacleSide, RigidMotion, RigidWay};
pub use recipe::{
    BackgroundGrid, Basis, Cloud, Enforcement, GradientStorage, Gradients, InsideRule, MassRule,
    MaterialBorders, Recipe, Refinement, VolumetricProjection, WeightFunction,
};

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::geometry::{Selector, Shape};
use crate::material::{Material, PronySeries};
use check::Mistakes;

/// A whole problem: body, discretisation recipe, conditions, loads, motion.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Space, or plane strain.
    pub dimension: Dimension,
    /// The solid that deforms.
    pub body: Shape,
    /// Parts of the body with a material each; the first that contains a
    /// point owns it, and the last should contain everything.
    pub regions: Vec<Region>,
    /// How the body is discretised.
    pub recipe: Recipe,
    /// Prescribed displacements; where two prescribe a component of a node, they must
    /// agree, and the force counts with the first.
    pub conditions: Vec<EssentialCondition>,
    /// Body forces, tractions and initial velocities.
    pub loads: Loads,
    /// Rigid obstacles.
    pub obstacles: Vec<Obstacle>,
    /// Dynamic or static, with the settings of the method.
    pub motion: Motion,
}

impl Problem {
    /// A body of one material in three dimensions without conditions, loads
    /// and obstacles, to be relaxed to a static solution.
    pub fn new(body: Shape, material: Material, recipe: Recipe) -> Problem {
        Problem {
            dimension: Dimension::Three,
            body,
            regions: vec![Region::new("body", Selector::All, material)],
            recipe,
            conditions: Vec::new(),
            loads: Loads::default(),
            obstacles: Vec::new(),
            motion: Motion::Static(Relaxation::default()),
        }
    }

    /// Every number with which it cannot be solved, in the order of its fields. What needs the
    /// geometry, such as selections of nothing, is refused when the problem is discretised.
    pub fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        for (n, region) in self.regions.iter().enumerate() {
            found.positive(&format!("regions[{n}].material.density"), region.material.density);
            found.part(&format!("regions[{n}]"), region.check());
        }
        found.part("recipe", self.recipe.check());
        for (n, condition) in self.conditions.iter().enumerate() {
            found.part(&format!("conditions[{n}].amplitude"), condition.amplitude.check());
        }
        found.part("loads", self.loads.check());
        for (n, obstacle) in self.obstacles.iter().enumerate() {
            found.part(&format!("obstacles[{n}]"), obstacle.check());
        }
        found.part("motion", self.motion.check());
        found.add("motion", self.rubs_in_newton().then_some(Wrong::NoFriction));
        found.add("motion", self.follows_no_time().then_some(Wrong::NoTime));
        found.0
    }

    /// Whether a material has a memory of what the method of solution has no time for.
    fn follows_no_time(&self) -> bool {
        let relaxes = match self.motion {
            Motion::Relaxed(_) => true,
            Motion::Static(_) => depends_on_way(&self.obstacles),
            Motion::Newton(_) | Motion::Dynamic { .. } => false,
        };
        relaxes && self.has_memory()
    }

    /// Whether friction is asked of Newton's method, which has only its limits.
    fn rubs_in_newton(&self) -> bool {
        let rubs = |obstacle: &Obstacle| matches!(obstacle.friction, Friction::Coulomb(_));
        matches!(self.motion, Motion::Newton(_)) && self.obstacles.iter().any(rubs)
    }

    /// Whether a stress depends on what was before.
    pub fn has_memory(&self) -> bool {
        self.regions.iter().any(|region| region.viscosity.is_some())
    }

    /// Whether Newton's method is what is tried at first.
    pub fn by_newton(&self) -> bool {
        match self.motion {
            Motion::Static(_) => !depends_on_way(&self.obstacles),
            Motion::Newton(_) => true,
            Motion::Relaxed(_) | Motion::Dynamic { .. } => false,
        }
    }
}

/// A part of the body made of one material.
#[derive(Debug, Clone)]
pub struct Region {
    /// Name in reports and messages.
    pub name: String,
    /// Which part of the body.
    pub part: Selector,
    /// Its law and density.
    pub material: Material,
    /// Where its law or its active stress needs them, and only there.
    pub fibres: Option<Fibres>,
    /// How its isochoric stress relaxes, where it does.
    pub viscosity: Option<PronySeries>,
    /// What it pulls with along its fibres, where it does.
    pub active: Option<ActiveStress>,
}

impl Region {
    /// Of a material without fibres and viscosity.
    pub fn new(name: &str, part: Selector, material: Material) -> Region {
        let name = name.to_string();
        Region { name, part, material, fibres: None, viscosity: None, active: None }
    }

    /// Every number that cannot be used.
    fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        let (law, fibres) = (self.material.law, self.fibres.as_ref());
        let has_sheets = fibres.is_some_and(|fibres| fibres.sheet.is_some());
        let needs_fibres = law.has_fibres() || self.active.is_some();
        let wrong = match () {
            () if needs_fibres && fibres.is_none() => Some(Wrong::NoFibres),
            () if law.has_sheets() && !has_sheets => Some(Wrong::NoSheets),
            () if !needs_fibres && fibres.is_some() => Some(Wrong::UnusedFibres),
            () => None,
        };
        found.add("fibres", wrong);
        let unsplit = self.viscosity.is_some() && !law.is_split();
        found.add("viscosity", unsplit.then_some(Wrong::NotSplit));
        if let Some(ActiveStress { tension, amplitude }) = &self.active {
            found.finite("active.tension", *tension);
            found.part("active.amplitude", amplitude.check());
        }
        found.0
    }

    /// The fibre frame at a reference position; of a law without fibres any does, and none is
    /// computed.
    ///
    /// # Errors
    /// [`NoDirection`] where there is none.
    pub fn frame(&self, X: &Vector3) -> Result<Option<Matrix3>, NoDirection> {
        self.fibres.as_ref().map(|fibres| fibres.frame(X)).transpose()
    }
}
