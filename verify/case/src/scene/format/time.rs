//! Time integration, probes and output.

use crate::scene::format::choice::choice;
use crate::scene::format::geometry::{Triple, UnitFormat};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// How the body moves. `end`, `damping` and `mass_scaling` belong to method "dynamic";
/// `solver`, `load_end`, `load_steps`, `tolerance`, `max_steps` and `parts` to "static".
/// Solver "newton" takes `load_end`, `tolerance` and `parts` only.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeFormat {
    /// Whether the body moves in time or the state at rest is the target.
    pub method: MethodFormat,
    /// How a static solution is found; "auto" if left out.
    pub solver: Option<SolverFormat>,
    /// Simulated time of a dynamic run [s]; left out for method "static" only.
    pub end: Option<f64>,
    /// Mass-proportional damping [1/s]; 0 if left out.
    pub damping: Option<f64>,
    /// Step over the critical step [–], in (0, 1]; 0.94 if left out, 0.8 for
    /// motion without damping.
    pub safety_factor: Option<f64>,
    /// The critical step is found again after this many steps at the latest; 1000 if left out.
    pub reevaluate_every: Option<usize>,
    /// Factor by which heavier nodes lengthen the critical step of a slow
    /// dynamic run [–]; 1 if left out; refused if it takes more than 10 % of the body's mass.
    pub mass_scaling: Option<f64>,
    /// A step to be used instead [s]; refused if it is not stable. If left out, the step follows
    /// the critical one.
    pub fixed_step: Option<f64>,
    /// Amplitudes run up to this time [s] in a static run; 1 if left out.
    pub load_end: Option<f64>,
    /// Steps over which relaxation applies the load; 500 if left out.
    pub load_steps: Option<usize>,
    /// Requested relative error of the largest displacement [–], 1e-4 if left out, which Newton's
    /// method takes for a hundredth of it in nodal forces; of solver "newton" the largest unbalanced
    /// nodal force over the largest nodal force, 1e-10 if left out.
    pub tolerance: Option<f64>,
    /// A relaxation that needs more steps has failed; 200000 if left out.
    pub max_steps: Option<usize>,
    /// Equal parts of the time between two corners of amplitudes in which a static run follows
    /// materials with viscosity [–]; 20 if left out.
    pub parts: Option<usize>,
}

choice! {
    /// Central differences in time, or a static solution.
    MethodFormat {
        /// The motion of the body in time.
        "dynamic" Dynamic,
        /// The state at rest that the loads and conditions lead to.
        "static" Static,
    }
}

choice! {
    /// The way to a static solution.
    SolverFormat {
        /// Newton's method, and relaxation where that fails, or where the body sticks to an
        /// obstacle, since the way to the solution matters then.
        "auto" Auto,
        /// Damped explicit motion until it rests.
        "relaxation" Relaxation,
        /// Newton's method with conjugate gradients.
        "newton" Newton,
    }
}

/// Where displacements are recorded: one of `point`, `points`, `lattice`,
/// `centre_of_mass`.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProbeFormat {
    /// Its name in results.
    pub name: String,
    /// A reference position [m]; left out where another kind is given.
    pub point: Option<Triple>,
    /// Positions from a file; left out where another kind is given.
    pub points: Option<PointsFormat>,
    /// Positions on a lattice; left out where another kind is given.
    pub lattice: Option<LatticeFormat>,
    /// Name of a region; left out where another kind is given.
    pub centre_of_mass: Option<String>,
}

/// Reference positions from a file, each a probe with the name of this one, a point and its own
/// name, as in `landmarks.tip`.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointsFormat {
    /// CSV with a header that names name, x, y and z, or x_mm, y_mm and z_mm. Path relative to
    /// the case file.
    pub file: PathBuf,
    /// Unit of the positions; may be left out where the header states it.
    pub unit: Option<UnitFormat>,
}

/// Equally spaced reference positions, ends included; those outside the body are left out.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LatticeFormat {
    /// First corner [m].
    pub min: Triple,
    /// Opposite corner [m].
    pub max: Triple,
    /// Positions along x, y and z [–]; 1 along z in plane strain.
    pub counts: [usize; 3],
}

/// What is written.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputFormat {
    /// Number of VTU frames after the first, at equal parts of the progress, the end among
    /// them; 20 if left out. A static run that ends early has fewer, and solver "newton" at
    /// most one for each part of the load; their frames are numbered, since they have no time without viscosity.
    pub frames: Option<usize>,
    /// Times of the frames [s]; equal parts of the progress, `frames` of them, if left out. A
    /// step ends at each, and a sample of histories is taken too; the first state and the last
    /// are frames as well. For method "dynamic": increasing, above 0 and at most `time.end`.
    pub times: Option<Vec<f64>>,
    /// Times at which the state of a motion is written [s], as state_1.json and so on, from which
    /// `mtled solve --from` goes on with it; none if left out. As `times` for the rest.
    pub states: Option<Vec<f64>>,
    /// Number of samples of histories; 200 if left out.
    pub history: Option<usize>,
    /// Moments of reactions are taken about this point [m]; the origin if left out.
    pub moment_about: Option<Triple>,
    /// Whether histories have the volume of each region too.
    #[serde(default)]
    pub volumes: bool,
}
