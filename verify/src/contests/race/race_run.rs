//! One run of any code that takes part in the race.

use crate::reference::title_of;
use mtled_checks::measure::median;
use serde::{Deserialize, Serialize};

/// A code that takes part in the race.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Code {
    /// This solver.
    Mtled,
    /// FEniCSx.
    Fenicsx,
    /// scikit-fem.
    ScikitFem,
}

/// Every code.
pub const CODES: [Code; 3] = [Code::Mtled, Code::Fenicsx, Code::ScikitFem];

/// The finite-element codes.
pub const FINITE_ELEMENT_CODES: [Code; 2] = [Code::Fenicsx, Code::ScikitFem];

impl Code {
    /// Name in the Python package.
    pub fn name(self) -> &'static str {
        match self {
            Code::Mtled => "mtled",
            Code::Fenicsx => "fenicsx",
            Code::ScikitFem => "scikit-fem",
        }
    }

    /// Name in tables.
    pub fn title(self) -> &'static str {
        title_of(self.name())
    }
}

/// One run of one code.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RaceRun {
    /// Name of the problem.
    pub challenge: String,
    /// Code that ran.
    pub code: Code,
    /// Recipe of `mtled`, element of the others.
    pub family: String,
    /// Spacings or cells along an edge of the body.
    pub per_edge: usize,
    /// Displacement components, with p and θ where they are unknowns.
    pub unknowns: usize,
    /// rms error in the unit of the challenge.
    pub error: f64,
    /// Set-up and solution \[s\].
    pub cpu_s: f64,
    /// The set-up alone \[s\], of `mtled`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_up_cpu_s: Option<f64>,
    /// Start of the interpreter and imports \[s\], not included in `cpu_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_cpu_s: Option<f64>,
    /// Generation and compilation of kernels \[s\], not included in `cpu_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compile_cpu_s: Option<f64>,
    /// Set-up and solution \[s\].
    pub wall_s: f64,
    /// Largest resident memory of the process.
    pub peak_memory_bytes: u64,
    /// Steps of dynamic relaxation, or iterations of Newton's method.
    pub steps: usize,
    /// Evaluations of the internal force, products with the tangent included, of `mtled`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub internal_forces: Option<usize>,
    /// Support entries that they visited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub neighbour_visits: Option<usize>,
    /// Whether it was read from a file, of another day and perhaps another machine.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stored: bool,
}

impl RaceRun {
    /// CPU time with the start of the code, its kernels compiled before \[s\].
    pub fn with_start(&self) -> f64 {
        self.cpu_s + self.start_cpu_s.unwrap_or(0.0)
    }
}

/// The runs of the first round with the median times of all rounds, which have the same runs
/// in the same order.
pub fn medians(rounds: &[Vec<RaceRun>]) -> Vec<RaceRun> {
    let Some(first) = rounds.first() else { return Vec::new() };
    let middle = |index: usize, of: fn(&RaceRun) -> Option<f64>| {
        let times: Option<Vec<f64>> = rounds.iter().map(|round| of(&round[index])).collect();
        times.and_then(|times| median(&times))
    };
    let merged = |(index, run): (usize, &RaceRun)| RaceRun {
        cpu_s: middle(index, |run| Some(run.cpu_s)).unwrap_or(run.cpu_s),
        wall_s: middle(index, |run| Some(run.wall_s)).unwrap_or(run.wall_s),
        set_up_cpu_s: middle(index, |run| run.set_up_cpu_s),
        start_cpu_s: middle(index, |run| run.start_cpu_s),
        compile_cpu_s: middle(index, |run| run.compile_cpu_s),
        ..run.clone()
    };
    first.iter().enumerate().map(merged).collect()
}
