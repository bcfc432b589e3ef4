//! How a problem is solved over time: method and settings.

/// How the body moves from its reference configuration.
#[derive(Debug, Clone)]
pub enum Motion {
    /// Central differences from t = 0 to `end`.
    Dynamic {
        /// \[s\]
        end: f64,
        /// Size of the time step.
        step: StepControl,
        /// Mass-proportional damping: f_damp = −`damping` M v \[1/s\].
        damping: f64,
    },
    /// To a static solution by what suits the scene: Newton's method, unless a body sticks to
    /// obstacles, where the way to the solution matters; relaxation with these settings there
    /// and where Newton's method fails.
    Static(Relaxation),
    /// Dynamic relaxation to a static solution.
    Relaxed(Relaxation),
    /// Newton's method to a static solution.
    Newton(Newton),
}

impl Motion {
    /// The time at which the run ends, or the load is complete \[s\].
    pub fn end(&self) -> f64 {
        match self {
            Motion::Dynamic { end, .. } => *end,
            Motion::Static(Relaxation { load_end, .. })
            | Motion::Relaxed(Relaxation { load_end, .. })
            | Motion::Newton(Newton { load_end, .. }) => *load_end,
        }
    }

    /// Settings of relaxation, where it may be what solves a static problem.
    pub fn relaxation(&self) -> Option<&Relaxation> {
        match self {
            Motion::Static(relaxation) | Motion::Relaxed(relaxation) => Some(relaxation),
            Motion::Dynamic { .. } | Motion::Newton(_) => None,
        }
    }

    /// As [`Motion::relaxation`], to be changed.
    pub fn relaxation_mut(&mut self) -> Option<&mut Relaxation> {
        match self {
            Motion::Static(relaxation) | Motion::Relaxed(relaxation) => Some(relaxation),
            Motion::Dynamic { .. } | Motion::Newton(_) => None,
        }
    }

    /// Central differences from t = 0 to `end` \[s\] with mass-proportional `damping` \[1/s\]
    /// and the recommended step control, which is more careful without damping.
    pub fn dynamic(end: f64, damping: f64) -> Motion {
        let step = if damping > 0.0 { StepControl::default() } else { StepControl::UNDAMPED };
        Motion::Dynamic { end, step, damping }
    }
}

/// How the time step follows the critical one.
#[derive(Debug, Clone, Copy)]
pub struct StepControl {
    /// Step over the critical step of the tangent operator \[–\].
    pub safety_factor: f64,
    /// The critical step is computed again after this many steps at the latest,
    /// and earlier where the tangent changes.
    pub reevaluate_every: usize,
    /// A step \[s\] to be used instead; the run is refused if it is not stable
    /// in the reference configuration.
    pub fixed: Option<f64>,
    /// Factor by which heavier nodes lengthen the critical step at rest of a
    /// quasi-static motion \[–\]; 1 adds no mass.
    pub mass_scaling: f64,
}

impl StepControl {
    /// For motions without damping: large vibrations near the limit of
    /// stability resonate with the step and blow up (Skeel, Srinivas 2000).
    pub const UNDAMPED: StepControl =
        StepControl { safety_factor: 0.8, ..StepControl::RECOMMENDED };

    const RECOMMENDED: StepControl =
        StepControl { safety_factor: 0.94, reevaluate_every: 1000, fixed: None, mass_scaling: 1.0 };
}

impl Default for StepControl {
    fn default() -> Self {
        StepControl::RECOMMENDED
    }
}

/// Settings of dynamic relaxation.
#[derive(Debug, Clone, Copy)]
pub struct Relaxation {
    /// Amplitudes run from t = 0 to this time \[s\] and stay constant after it;
    /// it is a time of the load curves, not of the body.
    pub load_end: f64,
    /// Number of steps over which the load is applied.
    pub load_steps: usize,
    /// Requested error of the largest displacement over its size \[–\].
    pub tolerance: f64,
    /// Steps after which the solution is given up.
    pub max_steps: usize,
    /// Size of the pseudo-time step.
    pub step: StepControl,
    /// The mass that is moved.
    pub mass: RelaxationMass,
    /// As [`Newton::parts`].
    pub parts: usize,
}

impl Default for Relaxation {
    fn default() -> Self {
        Relaxation {
            load_end: 1.0,
            load_steps: 500,
            tolerance: 1e-4,
            max_steps: 200_000,
            step: StepControl::default(),
            mass: RelaxationMass::default(),
            parts: PARTS,
        }
    }
}

/// Unbalanced nodal force over the largest one with which Newton's method meets a tolerance of
/// displacements, over that tolerance \[–\].
const RESIDUAL_OF_TOLERANCE: f64 = 0.01;

impl Relaxation {
    /// Newton's method to the same load, with displacements at least as close to the solution.
    pub fn newton(&self) -> Newton {
        Newton {
            load_end: self.load_end,
            tolerance: RESIDUAL_OF_TOLERANCE * self.tolerance,
            parts: self.parts,
        }
    }
}

/// The mass of dynamic relaxation, on which static solutions do not depend.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RelaxationMass {
    /// In proportion to the diagonal of the stiffness at rest, so that stiff
    /// and soft parts converge at the same rate.
    #[default]
    Stiffness,
    /// The lumped mass of the body.
    Lumped,
}

/// Default of [`Newton::parts`].
const PARTS: usize = 20;

/// Settings of Newton's method.
#[derive(Debug, Clone, Copy)]
pub struct Newton {
    /// Amplitudes run from t = 0 to this time \[s\].
    pub load_end: f64,
    /// Requested largest unbalanced nodal force over the largest nodal force \[–\].
    pub tolerance: f64,
    /// Equal parts of the time between two corners of amplitudes in which a material with
    /// viscosity is followed; other materials need none.
    pub parts: usize,
}

impl Default for Newton {
    fn default() -> Self {
        Newton { load_end: 1.0, tolerance: 1e-10, parts: PARTS }
    }
}
