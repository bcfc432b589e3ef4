//! The studies: each poses cases, runs the solver and returns plain data.

mod approximation;
mod brain;
mod closed_forms;
mod comparison;
mod hard;
mod manufactured;
mod meta;
mod motion;
mod patch;
pub(crate) mod workbench;

use mtled_checks::study::Study;
use std::time::Instant;
use workbench::Workbench;

/// A study by name.
pub struct Definition {
    pub id: &'static str,
    pub title: &'static str,
    claim: &'static str,
    body: fn(&Workbench, &mut Study) -> anyhow::Result<()>,
}

/// Every study, the longest first so that they share the processors well.
pub const STUDIES: &[Definition] = &[
    Definition {
        id: "energy",
        title: "Energy and repeatability",
        claim: "Undamped motion keeps its energy over tens of thousands of steps up to O(Δt²), the \
                balance of all works closes, and any number of threads gives the same bits.",
        body: motion::energy::energy,
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
        body: comparison::benchmarks::benchmarks,
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
        body: comparison::convergence::convergence,
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
                fits nothing, to round-off; a rigid motion makes no force, and internal forces and \
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
        title: "Parts by themselves",
        claim: "Stress is the derivative of the energy, vanishes at rest and turns with the body; \
                lumped masses keep the body's mass and, by row sum, its centre; reactions balance \
                loads in a slab; and what is no number ends a run.",
        body: meta::parts::parts,
    },
    Definition {
        id: "set_up",
        title: "Set-up",
        claim: "Making the gradients consistent takes the same few iterations at any number of nodes \
                and on any shape, and all that comes before the first step costs as much as some \
                hundred steps.",
        body: meta::set_up::set_up,
    },
    Definition {
        id: "work",
        title: "Work",
        claim: "Carried cases take no more evaluations of the internal force, points, neighbours and \
                bytes than they did: counts that do not depend on the machine.",
        body: meta::work::work,
    },
    Definition {
        id: "faults",
        title: "Deliberate faults",
        claim: "Every fault that is put into the solver on purpose makes a check of the quick suite \
                fail.",
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
            meta::smallest::attach(&mut study);
        }
        study.wall_seconds = start.elapsed().as_secs_f64();
        study
    }
}
