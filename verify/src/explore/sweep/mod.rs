//! Studies of a user's own cases: a recipe is changed over ranges, every combination
//! is run once and kept in the store, and the records become tables and figures.

mod axis;
mod convergence;
mod plan;
mod tables;
mod truth;

pub use axis::{Axis, AxisError, combinations};
pub use plan::{Plan, PlanError};
pub use tables::percent;
pub use truth::{TruthWanted, find_truth};

use crate::accuracy::{Group, Truth};
use crate::explore::store::{Job, Progress, Record, Source, Store, Task, perform_all};
use crate::scene::{Knob, Level, Setting};
use anyhow::{Result, bail};
use mtled_checks::study::Study;
use std::sync::Arc;

/// What is studied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    Consistency,
    Patch,
    TimeStep,
    Convergence,
    Stability,
}

/// A study of some cases.
#[derive(Debug)]
pub struct Sweep {
    pub subject: Subject,
    pub sources: Vec<Arc<Source>>,
    pub axes: Vec<Axis>,
    /// Every combination is run on this many clouds.
    pub clouds: usize,
    pub truth: TruthWanted,
    /// What is judged; the first group that a case has, where none is named.
    pub group: Option<Group>,
    /// The command that reproduces it.
    pub command: String,
}

/// A case with its tasks and their records, and what they are measured against.
#[derive(Debug)]
pub struct Measured {
    pub source: Arc<Source>,
    pub records: Vec<Record>,
    pub truth: Option<(Truth, Group)>,
}

impl Subject {
    pub fn name(self) -> &'static str {
        match self {
            Subject::Consistency => "consistency",
            Subject::Patch => "patch",
            Subject::TimeStep => "timestep",
            Subject::Convergence => "convergence",
            Subject::Stability => "stability",
        }
    }

    fn title(self) -> &'static str {
        match self {
            Subject::Consistency => "Consistency and quadrature",
            Subject::Patch => "Affine patch test",
            Subject::TimeStep => "Critical time step",
            Subject::Convergence => "Convergence",
            Subject::Stability => "Stability",
        }
    }

    fn claim(self) -> &'static str {
        match self {
            Subject::Consistency => {
                "How far Σ w Grad φ is from ∮ φ N, how well the supports are conditioned and what \
                 is under-integrated, over recipes."
            }
            Subject::Patch => {
                "An affine field on the whole boundary of the body is found inside: errors over \
                 recipes."
            }
            Subject::TimeStep => {
                "The step that the literature's bound and Lanczos promise, against the largest \
                 step of real runs, over recipes, at rest and compressed."
            }
            Subject::Convergence => "Errors against the truth and their orders, over spacings.",
            Subject::Stability => {
                "Which recipes and loads end with a sound body, which with a warning, which \
                 with an error that says why."
            }
        }
    }

    fn job(self) -> Job {
        match self {
            Subject::Consistency => Job::Consistency,
            Subject::Patch => Job::Patch,
            Subject::TimeStep => Job::TimeStep,
            Subject::Convergence | Subject::Stability => Job::Solve,
        }
    }

    /// What is changed where the user names nothing.
    pub fn preset(self) -> &'static [(Knob, &'static str)] {
        match self {
            Subject::Consistency => {
                &[(Knob::Dilation, "1.4..2.6:0.4"), (Knob::CellsPerSpacing, "1,1.26,2")]
            }
            Subject::Patch => {
                &[(Knob::CellsPerSpacing, "1,1.26,2"), (Knob::Gradients, "plain,consistent")]
            }
            Subject::TimeStep => {
                &[(Knob::Dilation, "1.6,1.8,2.2,2.6"), (Knob::CellsPerSpacing, "1.26,2")]
            }
            Subject::Convergence => &[(Knob::Spacing, "x1.6,x1.4,x1.2,x1")],
            Subject::Stability => &[(Knob::Load, "0.5,1,1.5,2")],
        }
    }
}

impl Sweep {
    /// Every run of a case; cloud 0 is the case's own.
    fn tasks(&self, source: &Arc<Source>, times: &[f64]) -> Vec<Task> {
        let mut tasks = Vec::new();
        for settings in combinations(&self.axes) {
            for cloud in 0..self.clouds {
                let mut settings = settings.clone();
                if cloud > 0 {
                    settings.push(Setting::number(Knob::Cloud, cloud as f64));
                    settings.sort_by_key(|setting| setting.knob);
                }
                tasks.push(Task {
                    job: self.subject.job(),
                    source: source.clone(),
                    settings,
                    times: times.to_vec(),
                });
            }
        }
        tasks
    }

    /// Runs what belongs to part `part` (from 1) of `parts`, and nothing is reported.
    pub fn run_part(
        &self,
        store: &Store,
        (part, parts): (usize, usize),
        say: &(dyn Fn(Progress) + Sync),
    ) -> Result<usize> {
        let mut wanted = Vec::new();
        for source in &self.sources {
            wanted.extend(self.truth.tasks(source, &self.axes));
            let times = self.truth.times(source)?;
            wanted.extend(self.tasks(source, &times));
        }
        let own: Vec<Task> = wanted
            .into_iter()
            .enumerate()
            .filter(|(n, _)| n % parts + 1 == part)
            .map(|t| t.1)
            .collect();
        perform_all(store, &own, say)?;
        Ok(own.len())
    }

    /// Runs what is not on record yet, and makes the study.
    pub fn run(&self, store: &Store, say: &(dyn Fn(Progress) + Sync)) -> Result<Study> {
        let mut measured = Vec::new();
        for source in &self.sources {
            let truth = match self.subject.job() {
                Job::Solve => Some(find_truth(&self.truth, source, &self.axes, store, say)?),
                _ => None,
            };
            let times = truth.as_ref().map_or(Vec::new(), |truth| truth.times.clone());
            let records = perform_all(store, &self.tasks(source, &times), say)?;
            let judged = truth.and_then(|truth| {
                let group = self.group.or_else(|| truth.group(&source.case))?;
                Some((truth, group))
            });
            if self.subject == Subject::Convergence && judged.is_none() {
                bail!("{}: has no probe and no support whose error could fall", source.name);
            }
            measured.push(Measured { source: source.clone(), records, truth: judged });
        }
        Ok(self.study(&measured))
    }

    fn study(&self, measured: &[Measured]) -> Study {
        let mut study = Study {
            id: self.subject.name().to_string(),
            title: self.subject.title().to_string(),
            claim: self.subject.claim().to_string(),
            command: self.command.clone(),
            ..Study::default()
        };
        for case in measured {
            match self.subject {
                Subject::Convergence => convergence::add(&mut study, self, case),
                _ => tables::add(&mut study, self, case),
            }
            study.tables.push(tables::timings(self, case));
        }
        study.notes.push(format!(
            "{} per combination; cloud 0 is the case's own. A lattice becomes another cloud \
             by a jitter of a tenth of the spacing, a jittered cloud by another seed, a graded \
             one by moving the lattices that its nodes are picked from.",
            if self.clouds == 1 { "One cloud".into() } else { format!("{} clouds", self.clouds) }
        ));
        study
    }

    /// What tells the runs of a curve over `along` from those of others: the levels of
    /// all other knobs, or the case's name where there are none.
    fn curve_name(&self, case: &Measured, record: &Record, along: Knob) -> String {
        let level = |knob: Knob| record.level(knob).unwrap_or_else(|| "as in the case".into());
        let others: Vec<String> = (self.axes.iter().filter(|axis| axis.knob != along))
            .map(|axis| format!("{} {}", axis.knob.name().replace('_', " "), level(axis.knob)))
            .collect();
        if others.is_empty() { case.source.name.clone() } else { others.join(", ") }
    }
}

/// Instants at which a dynamic case is looked at where nobody says \[s\].
fn instants(source: &Source) -> Vec<f64> {
    const INSTANTS: usize = 20;
    match source.case.problem.motion {
        mtled::problem::Motion::Dynamic { end, .. } => {
            (1..=INSTANTS).map(|n| end * n as f64 / INSTANTS as f64).collect()
        }
        _ => vec![0.0],
    }
}

/// The number of a level, where it is one or a factor such as `x0.8`.
fn number_of(level: &Level) -> Option<f64> {
    match level {
        Level::Number(number) => Some(*number),
        Level::Word(word) => word.strip_prefix('x')?.parse().ok(),
    }
}
