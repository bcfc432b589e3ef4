//! What a study of a case shows.

use crate::lab::store::Job;
use mtled_case::scene::Knob;

/// The subject of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// Gradients and quadrature of the discretisation.
    Consistency,
    /// The affine patch test.
    Patch,
    /// The critical time step.
    TimeStep,
    /// Errors over node spacings.
    Convergence,
    /// How runs end.
    Stability,
}

/// The texts and the default ranges of a subject.
struct Description {
    name: &'static str,
    title: &'static str,
    claim: &'static str,
    ranges: &'static [(Knob, &'static str)],
}

const CONSISTENCY: Description = Description {
    name: "consistency",
    title: "Consistency and quadrature",
    claim: "The difference between Σ w Grad φ and ∮ φ N, the conditioning of the supports and the \
            under-integration, over recipes.",
    ranges: &[(Knob::Dilation, "1.4..2.6:0.4"), (Knob::CellsPerSpacing, "1,1.26,2")],
};

const PATCH: Description = Description {
    name: "patch",
    title: "Affine patch test",
    claim: "An affine field prescribed on the whole boundary is reproduced inside the body: errors \
            over recipes.",
    ranges: &[(Knob::CellsPerSpacing, "1,1.26,2"), (Knob::Gradients, "plain,consistent")],
};

const TIME_STEP: Description = Description {
    name: "timestep",
    title: "Critical time step",
    claim: "The per-point bound of the literature and the critical step by Lanczos against the \
            largest stable step of trial runs, over recipes, at rest and compressed.",
    ranges: &[(Knob::Dilation, "1.6,1.8,2.2,2.6"), (Knob::CellsPerSpacing, "1.26,2")],
};

const CONVERGENCE: Description = Description {
    name: "convergence",
    title: "Convergence",
    claim: "Errors against a reference solution and their orders, over spacings.",
    ranges: &[(Knob::Spacing, "x1.6,x1.4,x1.2,x1")],
};

const STABILITY: Description = Description {
    name: "stability",
    title: "Stability",
    claim: "Which recipes and loads end without a warning, which with a warning and which with an \
            error message.",
    ranges: &[(Knob::Load, "0.5,1,1.5,2")],
};

impl Subject {
    fn description(self) -> &'static Description {
        match self {
            Subject::Consistency => &CONSISTENCY,
            Subject::Patch => &PATCH,
            Subject::TimeStep => &TIME_STEP,
            Subject::Convergence => &CONVERGENCE,
            Subject::Stability => &STABILITY,
        }
    }

    /// As it is written on the command line and in files.
    pub fn name(self) -> &'static str {
        self.description().name
    }

    /// Heading of its report.
    pub(crate) fn title(self) -> &'static str {
        self.description().title
    }

    /// What its report shows, in one sentence.
    pub(crate) fn claim(self) -> &'static str {
        self.description().claim
    }

    /// Ranges where the user gives none.
    pub fn default_ranges(self) -> &'static [(Knob, &'static str)] {
        self.description().ranges
    }

    /// Kind of its runs.
    pub(crate) fn job(self) -> Job {
        match self {
            Subject::Consistency => Job::Consistency,
            Subject::Patch => Job::Patch,
            Subject::TimeStep => Job::TimeStep,
            Subject::Convergence | Subject::Stability => Job::Solve,
        }
    }
}
