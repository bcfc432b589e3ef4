//! The studies: each poses cases, runs the solver and returns plain data.

mod benchmarks;
mod brain;
mod closed_forms;
mod closed_forms_motion;
mod clouds;
mod comparison;
mod comparison_limits;
mod comparison_tables;
mod consistency;
mod convergence;
mod energy;
mod faults;
mod hard;
mod hard_bodies;
mod hard_cases;
mod hard_moving;
mod hard_run;
mod hard_thin;
mod hard_twins;
mod manufactured;
mod manufactured_plain;
mod manufactured_pose;
mod manufactured_report;
mod parts;
mod parts_march;
mod parts_model;
mod patch;
mod patch_exact;
pub(crate) mod plain;
pub(crate) mod problems;
mod references;
mod set_up;
mod smallest;
mod specimens;
mod statics;
mod time_step;
mod time_step_clouds;
mod time_step_runs;
mod vibration;
mod work;

pub use manufactured::Place;
pub use manufactured_pose::{Placed, impose};
pub use time_step::{largest_stable_step, trial_velocity};

use crate::reference::{ReferenceError, ReferenceFile, read_reference};
use crate::run::{Record, Solved, solve_case};
use crate::scene::{Case, one_error, read_case};
use crate::study::Study;
use anyhow::{Result, bail};
use mtled::problem::{Cloud, Problem};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How thorough the studies are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Suite {
    Quick,
    Full,
}

/// Seeds of one run do not meet those of the next.
const SEEDS_APART: u64 = 1000;
/// Jitter of the lattices of carried cases with another seed \[spacing\].
const VARIATION: f64 = 0.02;

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
    /// Which family of clouds: 0 is the one that all stated figures belong to.
    seed: u64,
    cases: PathBuf,
}

/// Every study, the longest first so that they share the processors well.
pub const STUDIES: &[Definition] = &[
    Definition {
        id: "energy",
        title: "Energy and repeatability",
        claim: "Undamped motion keeps its energy over tens of thousands of steps up to O(Δt²), the \
                balance of all works closes, and any number of threads gives the same bits.",
        body: energy::energy,
    },
    Definition {
        id: "hard_cases",
        title: "Hard cases",
        claim: "Large strains, poor clouds, thin parts, hard contrasts, long undamped runs and \
                extreme units end with a sound body, every J above zero, or with an error that \
                says why; none ends in silence.",
        body: hard::hard,
    },
    Definition {
        id: "brain",
        title: "Brain slice with a craniotomy",
        claim: "The seed's experiment runs from a label map to displaced centres of mass: the brain \
                stays in the skull, no point turns inside out, and the answers hold on a finer cloud.",
        body: brain::brain,
    },
    Definition {
        id: "comparison",
        title: "Comparison with finite elements",
        claim: "At the recipes of the cases the solver is within the stated limits of references from \
                two finite-element codes, each limit widened by the reference's own error bar.",
        body: comparison::comparison,
    },
    Definition {
        id: "benchmarks",
        title: "Published benchmarks",
        claim: "Cook's membrane and the flag of Turek and Hron bend and swing as published.",
        body: benchmarks::benchmarks,
    },
    Definition {
        id: "manufactured",
        title: "Manufactured solutions",
        claim: "Fields of finite strain are found back from their body forces and boundary values; \
                errors of displacement, gradient and pressure fall with the spacing on jittered \
                clouds, with orders and their scatter as printed.",
        body: manufactured::manufactured,
    },
    Definition {
        id: "convergence",
        title: "Convergence in node spacing and grid density",
        claim: "Errors fall as nodes and cells get closer; orders are fitted where the truth is \
                known well enough.",
        body: convergence::convergence,
    },
    Definition {
        id: "closed_forms",
        title: "Closed forms",
        claim: "Stretched, sheared, turned, twisted, standing and swinging bars meet their closed \
                forms within 1 %.",
        body: closed_forms::closed_forms,
    },
    Definition {
        id: "statics",
        title: "Static solutions",
        claim: "Dynamic relaxation keeps the tolerance that it is asked for, measured against \
                Newton's method on the same discretisation, and needs fewer steps with masses like \
                the stiffness than with lumped ones.",
        body: statics::statics,
    },
    Definition {
        id: "time_step",
        title: "Critical time step",
        claim: "The critical step by Lanczos is the largest stable step of real runs, on the safe \
                side and within a few per cent; the per-point bound of the literature is safe but \
                two to six times too small.",
        body: time_step::time_step,
    },
    Definition {
        id: "patch",
        title: "Affine patch test",
        claim: "An affine field is in equilibrium on any body, with jittered nodes and a grid that \
                fits nothing, to round-off; a rigid motion makes no force, and internal forces and \
                moments sum to zero.",
        body: patch::patch,
    },
    Definition {
        id: "consistency",
        title: "Consistency of the approximation",
        claim: "The shape functions sum to one and reproduce their basis, values and gradients, to \
                round-off, on any cloud and anywhere in space; Grad φ is the derivative of φ.",
        body: consistency::consistency,
    },
    Definition {
        id: "parts",
        title: "Parts by themselves",
        claim: "Stress is the derivative of the energy, vanishes at rest and turns with the body; \
                lumped masses keep the body's mass and, by row sum, its centre; reactions balance \
                loads in a slab; and what is no number ends a run.",
        body: parts::parts,
    },
    Definition {
        id: "set_up",
        title: "Set-up",
        claim: "Making the gradients consistent takes the same few iterations at any number of nodes \
                and on any shape, and all that comes before the first step costs as much as some \
                hundred steps.",
        body: set_up::set_up,
    },
    Definition {
        id: "work",
        title: "Work",
        claim: "Carried cases take no more evaluations of the internal force, points, neighbours and \
                bytes than they did: counts that do not depend on the machine.",
        body: work::work,
    },
    Definition {
        id: "faults",
        title: "Deliberate faults",
        claim: "Every fault that is put into the solver on purpose makes a check of the quick suite \
                fail.",
        body: faults::faults,
    },
    Definition {
        id: "references",
        title: "Finite-element references",
        claim: "FEniCSx and scikit-fem, on different meshes or elements, agree in every quantity of \
                every case within the sum of their error bars.",
        body: references::references,
    },
];

impl Workbench {
    /// Unpacks the carried cases into the output folder.
    pub fn new(suite: Suite, seed: u64, out: &Path) -> Result<Workbench> {
        Ok(Workbench { suite, seed, cases: crate::cases::unpack(out)? })
    }

    /// The seed of a random cloud in this run, for one that is stated.
    pub fn seed(&self, stated: u64) -> u64 {
        stated + SEEDS_APART * self.seed
    }

    /// Gives a jittered or graded cloud the seed of this run.
    pub fn reseed(&self, problem: &mut Problem) {
        if let Cloud::Jittered { seed, .. } | Cloud::Graded { seed, .. } = &mut problem.recipe.cloud
        {
            *seed = self.seed(*seed);
        }
    }

    /// A carried case; with another seed on a cloud that differs a little.
    pub fn case(&self, name: &str) -> Result<Case> {
        let mut case = self.stated_case(name)?;
        if self.seed > 0 {
            self.vary(&mut case.problem);
        }
        Ok(case)
    }

    /// A lattice jittered by [`VARIATION`] of its spacing, a graded cloud moved in
    /// its tree of lattices.
    fn vary(&self, problem: &mut Problem) {
        if let Cloud::Regular { spacing } = problem.recipe.cloud {
            let (jitter, seed) = (VARIATION, 0);
            problem.recipe.cloud = Cloud::Jittered { spacing, jitter, seed };
        }
        self.reseed(problem);
    }

    /// A carried case on the very cloud of its file.
    pub fn stated_case(&self, name: &str) -> Result<Case> {
        read_case(&self.cases.join(format!("{name}.toml"))).map_err(one_error)
    }

    /// The carried reference of a case.
    pub fn reference(&self, case: &Case) -> Result<ReferenceFile, ReferenceError> {
        let absent = || ReferenceError::Absent { case: case.name.clone() };
        let text = crate::cases::carried_reference(&case.name).ok_or_else(absent)?;
        read_reference(case, text)
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
        // What these say is not about a body.
        if !["faults", "references"].contains(&self.id) {
            smallest::attach(&mut study);
        }
        study.wall_seconds = start.elapsed().as_secs_f64();
        study
    }
}

/// |computed − truth|/|truth| \[–\].
fn relative_error(computed: f64, truth: f64) -> f64 {
    (computed - truth).abs() / truth.abs()
}

/// Node spacing \[m\] of a recipe; for a graded cloud the largest.
pub fn spacing_of(problem: &Problem) -> Result<f64> {
    match problem.recipe.cloud {
        Cloud::Regular { spacing }
        | Cloud::Jittered { spacing, .. }
        | Cloud::Graded { spacing, .. } => Ok(spacing),
        Cloud::Given { .. } => bail!("nodes that are given have no spacing to change"),
    }
}

/// The same case with every length of its recipe scaled to another spacing \[m\].
fn respaced(case: &Case, spacing: f64) -> Result<Case> {
    let factor = spacing / spacing_of(&case.problem)?;
    let mut case = case.clone();
    let recipe = &mut case.problem.recipe;
    match &mut recipe.cloud {
        Cloud::Regular { spacing } | Cloud::Jittered { spacing, .. } => *spacing *= factor,
        Cloud::Graded { spacing, refinements, .. } => {
            *spacing *= factor;
            refinements.iter_mut().for_each(|refinement| refinement.size *= factor);
        }
        Cloud::Given { .. } => {}
    }
    let grid = &mut recipe.grid;
    grid.cell *= factor;
    grid.boundary_cell = grid.boundary_cell.map(|cell| cell * factor);
    grid.refinements.iter_mut().for_each(|refinement| refinement.size *= factor);
    Ok(case)
}

/// A case solved at several spacings \[m\], side by side.
fn solve_ladder(case: &Case, spacings: &[f64]) -> Result<Vec<(f64, Solved, Record)>> {
    let run = |&spacing: &f64| {
        let (solved, record) = solve_case(&respaced(case, spacing)?)?;
        Ok((spacing, solved, record))
    };
    spacings.par_iter().map(run).collect()
}
