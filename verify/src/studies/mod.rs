//! The studies: each poses cases, runs the solver and returns plain data.

mod consistency;
mod energy;
mod patch;
mod plain;
mod problems;
mod specimens;
mod time_step;
mod vibration;

use crate::scene::{Case, read_case};
use crate::study::Study;
use anyhow::{Result, anyhow};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How thorough the studies are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Suite {
    Quick,
    Full,
}

/// A study by name.
pub struct Definition {
    pub id: &'static str,
    pub title: &'static str,
    claim: &'static str,
    body: fn(&Workbench, &mut Study) -> Result<()>,
}

/// What the studies work with.
#[derive(Debug)]
pub struct Workbench {
    pub suite: Suite,
    cases: PathBuf,
}

/// Every study, the longest first so that they share the processors well.
pub const STUDIES: &[Definition] = &[
    Definition {
        id: "time_step",
        title: "Critical time step",
        claim: "The critical step by Lanczos is the largest stable step of real runs, on the safe \
                side and within a few per cent; the per-point bound of the literature is safe but \
                two to six times too small.",
        body: time_step::time_step,
    },
    Definition {
        id: "energy",
        title: "Energy and repeatability",
        claim: "Undamped motion keeps its energy over tens of thousands of steps up to O(Δt²), the \
                balance of all works closes, and any number of threads gives the same bits.",
        body: energy::energy,
    },
    Definition {
        id: "patch",
        title: "Affine patch test",
        claim: "An affine field has the same gradient at every point, a rigid motion makes no \
                force, and internal forces and moments sum to zero. The plain scheme fails the static \
                patch test, by 1 to 11 % in the displacement, as is known of it.",
        body: patch::patch,
    },
    Definition {
        id: "consistency",
        title: "Consistency of the approximation",
        claim: "The shape functions sum to one and reproduce their basis, values and gradients, to \
                round-off, on any cloud and anywhere in space; Grad φ is the derivative of φ.",
        body: consistency::consistency,
    },
];

impl Workbench {
    /// Unpacks the carried cases into the output folder.
    pub fn new(suite: Suite, out: &Path) -> Result<Workbench> {
        Ok(Workbench { suite, cases: crate::cases::unpack(out)? })
    }

    /// A carried case.
    pub fn case(&self, name: &str) -> Result<Case> {
        read_case(&self.cases.join(format!("{name}.toml"))).map_err(|mistakes| {
            let lines: Vec<String> = mistakes.iter().map(|mistake| mistake.to_string()).collect();
            anyhow!("{}", lines.join("\n"))
        })
    }

    /// One of two values, by suite.
    pub fn pick<T>(&self, quick: T, full: T) -> T {
        match self.suite {
            Suite::Quick => quick,
            Suite::Full => full,
        }
    }
}

impl Definition {
    /// Runs the study; what fails is reported, not lost.
    pub fn run(&self, bench: &Workbench) -> Study {
        let start = Instant::now();
        let mut study = Study {
            id: self.id.to_string(),
            title: self.title.to_string(),
            claim: self.claim.to_string(),
            command: format!("mtled verify --only {}", self.id),
            ..Study::default()
        };
        if let Err(error) = (self.body)(bench, &mut study) {
            study.failure = Some(format!("{error:#}"));
        }
        study.wall_seconds = start.elapsed().as_secs_f64();
        study
    }
}
