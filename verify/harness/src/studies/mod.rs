//! The studies: each solves cases and returns its checks, tables and figures as plain data.

mod approximation;
mod brain;
mod closed_forms;
mod comparison;
mod error_bars;
mod frequencies;
mod hard;
mod manufactured;
mod meta;
mod metamorphic;
mod motion;
mod patch;
mod regression;
mod single_parts;
pub mod workbench;

use mtled_checks::study::Study;
use std::time::Instant;
use workbench::Workbench;

/// A study and how to run it.
pub struct Definition {
    /// First part of the ids of its checks.
    pub id: &'static str,
    /// Heading of its page.
    pub title: &'static str,
    claim: &'static str,
    body: fn(&Workbench, &mut Study) -> anyhow::Result<()>,
}

/// Every study in the order of the report; the longest are near the start, so that all processors
/// stay busy.
pub const STUDIES: &[Definition] = &[
    Definition {
        id: "comparison",
        title: "Comparison with finite elements",
        claim: "With the recipes of the cases the solver is within the stated limits of references from \
                two finite-element codes, each limit widened by the reference's own error bar.",
        body: comparison::comparison,
    },
    Definition {
        id: "energy",
        title: "Energy and repeatability",
        claim: "Undamped motion conserves its energy over tens of thousands of steps up to O(Δt²), the \
                balance of all works closes, and any number of threads gives the same bits.",
        body: motion::energy::energy,
    },
    Definition {
        id: "hard_cases",
        title: "Hard cases",
        claim: "Large strains, poor clouds, thin parts, strong contrasts, long undamped runs and \
                extreme units end with a valid solution, every J above zero, or with an error that \
                gives the reason; none fails silently.",
        body: hard::hard,
    },
    Definition {
        id: "brain",
        title: "Brain slice with a craniotomy",
        claim: "The experiment of Horton 2007 runs from a label map to displaced centres of mass: the \
                brain stays in the skull, no point inverts, and a finer cloud changes little.",
        body: brain::brain,
    },
    Definition {
        id: "held_patches",
        title: "Held patches",
        claim: "Where a held part ends within a face, energies hardly depend on the cloud and come \
                nearer to those of finer clouds, whatever the shape of the part.",
        body: comparison::held_patches::held_patches,
    },
    Definition {
        id: "error_bars",
        title: "Error bars",
        claim: "The error bars of `mtled solve` hold nine of ten errors and are mostly within a factor of \
                3 of them, on cases that they were set on and on others, or words say why there is \
                none; they cost less than a third of the run.",
        body: error_bars::error_bars,
    },
    Definition {
        id: "benchmarks",
        title: "Published benchmarks",
        claim: "Cook's membrane and the flag of Turek and Hron bend and swing as published.",
        body: comparison::benchmarks::benchmarks,
    },
    Definition {
        id: "fibres",
        title: "Bodies with fibres",
        claim: "Muscle bends, twists and shears as two codes and eleven groups say, its fibres straight, \
                turning or curved.",
        body: comparison::fibres::fibres,
    },
    Definition {
        id: "published",
        title: "Problems of others",
        claim: "What others have computed or derived is met within their spread and a stated tolerance, or \
                the table says by how much it is missed.",
        body: comparison::published::published,
    },
    Definition {
        id: "manufactured",
        title: "Manufactured solutions",
        claim: "Fields of finite strain are recovered from their body forces and boundary values; \
                errors of displacement, gradient and pressure fall with the spacing on jittered \
                clouds, with orders and their scatter as printed.",
        body: manufactured::manufactured,
    },
    Definition {
        id: "convergence",
        title: "Convergence in node spacing and grid density",
        claim: "Errors fall as nodes and cells get closer; orders are fitted where the \
                reference solution is known well enough.",
        body: comparison::convergence::convergence,
    },
    Definition {
        id: "closed_forms",
        title: "Closed forms",
        claim: "Stretched, sheared, rotated, twisted, standing and swinging bars agree with their \
                closed forms within 1 %.",
        body: closed_forms::closed_forms,
    },
    Definition {
        id: "frequencies",
        title: "Natural frequencies",
        claim: "A free cube, a guided bar and a clamped beam vibrate as fast as known, errors fall with the \
                square of the spacing or faster, and of equal frequencies none is missed.",
        body: frequencies::frequencies,
    },
    Definition {
        id: "statics",
        title: "Static solutions",
        claim: "Dynamic relaxation meets the requested tolerance, measured against Newton's method on \
                the same discretisation, and needs fewer steps with masses proportional to the \
                stiffness than with lumped ones.",
        body: motion::statics::statics,
    },
    Definition {
        id: "time_step",
        title: "Critical time step",
        claim: "The critical step by Lanczos is the largest stable step of real runs, on the safe \
                side and within a few per cent; the per-point bound of the literature is safe but \
                two to six times too small.",
        body: motion::time_step::time_step,
    },
    Definition {
        id: "patch",
        title: "Affine patch test",
        claim: "An affine field is in equilibrium on any body, with jittered nodes and a grid that \
                fits no face, to round-off; a rigid motion makes no force, and internal forces and \
                moments sum to zero.",
        body: patch::patch,
    },
    Definition {
        id: "consistency",
        title: "Consistency of the approximation",
        claim: "The shape functions sum to one and reproduce their basis, values and gradients, to \
                round-off, on any cloud and anywhere in space; Grad φ is the derivative of φ.",
        body: approximation::consistency::consistency,
    },
    Definition {
        id: "parts",
        title: "Single parts",
        claim: "Stress is the derivative of the energy, vanishes at rest and rotates with the \
                body; lumped masses sum to the body's mass and, by row sum, have its centre; reactions \
                balance loads in a slab; and NaN ends a run.",
        body: single_parts::parts,
    },
    Definition {
        id: "set_up",
        title: "Set-up",
        claim: "Making the gradients consistent takes the same few iterations at any number of nodes \
                and on any shape, and the whole set-up costs as much as some hundred steps.",
        body: meta::set_up::set_up,
    },
    Definition {
        id: "metamorphic",
        title: "Random scenes",
        claim: "Of random scenes, who asks for the same in other words gets the same answer: other \
                orders, places, directions, units and ways; and what is asked for is what is done.",
        body: metamorphic::metamorphic,
    },
    Definition {
        id: "work",
        title: "Work",
        claim: "Bundled cases take no more evaluations of the internal force, points, neighbours and \
                bytes than before: counts that do not depend on the machine.",
        body: meta::work::work,
    },
    Definition {
        id: "faults",
        title: "Deliberate faults",
        claim: "Every deliberate fault in the solver makes a check of the quick suite fail.",
        body: meta::faults::faults,
    },
    Definition {
        id: "references",
        title: "Finite-element references",
        claim: "FEniCSx and scikit-fem, on different meshes or elements, agree in every quantity of \
                every case within the sum of their error bars.",
        body: meta::references::references,
    },
];

impl Definition {
    /// Runs the study; an error becomes its `failure`.
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
        // The checks of these two are not about a solution.
        if !["faults", "references"].contains(&self.id) {
            meta::smallest::attach(&mut study);
        }
        study.wall_seconds = start.elapsed().as_secs_f64();
        study
    }
}
