//! A study of some cases, its runs and their labels.

use super::axis::{Axis, combinations};
use super::reference::ReferenceSource;
use super::subject::Subject;
use crate::lab::label::{AS_IN_CASE, knob_label};
use crate::lab::store::{RunRecord, Source, Task};
use mtled_case::scene::{Knob, Level, Setting};
use mtled_checks::study::{Cell, Column, text};
use mtled_run::accuracy::{Group, ReferenceSolution};
use std::sync::Arc;

/// A study of some cases over ranges of their recipes.
#[derive(Debug)]
pub struct Sweep {
    /// What it shows.
    pub subject: Subject,
    /// The cases.
    pub sources: Vec<Arc<Source>>,
    /// Ranges of settings; every combination is run.
    pub axes: Vec<Axis>,
    /// Node clouds per combination.
    pub clouds: usize,
    /// Where the reference solution comes from.
    pub reference: ReferenceSource,
    /// Quantities whose error is measured; by default the first group that a case has.
    pub group: Option<Group>,
    /// The command that reproduces it.
    pub command: String,
}

/// A case with its records and what they are compared with.
#[derive(Debug)]
pub(crate) struct MeasuredCase {
    pub source: Arc<Source>,
    pub records: Vec<RunRecord>,
    pub reference: Option<(ReferenceSolution, Group)>,
}

impl Sweep {
    /// Every run of a case with values at `times` \[s\]; cloud 0 is the case's own.
    pub(crate) fn tasks(&self, source: &Arc<Source>, times: &[f64]) -> Vec<Task> {
        let mut tasks = Vec::new();
        for settings in combinations(&self.axes) {
            for cloud in 0..self.clouds {
                let mut settings = settings.clone();
                if cloud > 0 {
                    settings.push(Setting::number(Knob::Cloud, cloud as f64));
                    settings.sort_by_key(|setting| setting.knob);
                }
                let (job, times) = (self.subject.job(), times.to_vec());
                tasks.push(Task { job, source: source.clone(), settings, times });
            }
        }
        tasks
    }

    /// Knobs that differ between its runs.
    fn knobs(&self) -> impl Iterator<Item = Knob> {
        let cloud = (self.clouds > 1).then_some(Knob::Cloud);
        self.axes.iter().map(|axis| axis.knob).chain(cloud)
    }

    /// A column for every knob that differs between its runs.
    pub(crate) fn setting_columns(&self) -> Vec<Column> {
        self.knobs().map(|knob| text(&knob_label(knob))).collect()
    }

    /// The cells of a record in these columns.
    pub(crate) fn setting_cells(&self, record: &RunRecord) -> Vec<Cell> {
        let cell = |knob: Knob| match record.setting(knob).map(|setting| &setting.level) {
            Some(Level::Number(number)) => Cell::Number(*number),
            Some(Level::Word(word)) => Cell::Text(word.clone()),
            None if knob == Knob::Cloud => Cell::Number(0.0),
            None => Cell::Text(AS_IN_CASE.into()),
        };
        self.knobs().map(cell).collect()
    }

    /// What distinguishes the runs of a curve over the knob `along`: the levels of all other
    /// knobs, or the name of the case where there are none.
    pub(crate) fn curve_name(
        &self,
        case: &MeasuredCase,
        record: &RunRecord,
        along: Knob,
    ) -> String {
        let level = |knob: Knob| {
            record.setting(knob).map_or(AS_IN_CASE.into(), |setting| setting.level.to_string())
        };
        let others: Vec<String> = (self.axes.iter().filter(|axis| axis.knob != along))
            .map(|axis| format!("{} {}", knob_label(axis.knob), level(axis.knob)))
            .collect();
        if others.is_empty() { case.source.name.clone() } else { others.join(", ") }
    }
}
