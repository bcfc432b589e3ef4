//! Which records of a store are meant.

use crate::lab::store::{Job, RunRecord};
use crate::lab::sweep::{Axis, AxisError, equal};
use mtled_case::scene::{Knob, Level, Levels, Override, Setting, nearest};
use std::path::Path;

/// What records must be; of each list one entry is enough, and an empty list asks for nothing.
#[derive(Debug, Clone, Default)]
pub struct RunFilter {
    /// Names of cases.
    pub cases: Vec<String>,
    /// Kinds of runs.
    pub jobs: Vec<Job>,
    /// The first day, YYYY-MM-DD.
    pub since: Option<String>,
    /// All of them.
    pub settings: Vec<Wanted>,
}

/// A setting that runs must have.
#[derive(Debug, Clone)]
pub enum Wanted {
    /// One of the levels of a knob.
    Level(Axis),
    /// A value that was set in place of that of the case file.
    Override(Override),
}

/// What is wrong with a filter.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The text has no `=`.
    #[error(
        "`{0}` is not a setting with its value, such as dilation=1.8 or basis=linear,quadratic"
    )]
    NoValue(String),
    /// There is no such setting, or its values cannot be read.
    #[error(transparent)]
    Axis(#[from] AxisError),
    /// The setting does not take this word.
    #[error("{knob} has no value `{word}`; {meant}")]
    Word {
        /// Name of the setting.
        knob: &'static str,
        /// What was asked for.
        word: String,
        /// What could have been meant.
        meant: String,
    },
    /// The text is no day.
    #[error("`{0}` is not a day such as 2026-01-31")]
    Day(String),
}

impl RunFilter {
    /// Whether a record is meant.
    pub fn accepts(&self, record: &RunRecord) -> bool {
        let name = |case: &String| record.case == *case;
        (self.cases.is_empty() || self.cases.iter().any(name))
            && (self.jobs.is_empty() || self.jobs.contains(&record.job))
            && self.since.as_ref().is_none_or(|day| record.timings.date >= *day)
            && self.settings.iter().all(|wanted| match wanted {
                Wanted::Level(axis) => has_level(record, axis),
                Wanted::Override(given) => record.overrides.iter().any(|own| own.means(given)),
            })
    }

    /// The name under which runs of a case file, or of a bundled case, are stored.
    pub fn case_name(case: &str) -> String {
        let stem = Path::new(case).file_stem().filter(|_| case.ends_with(".toml"));
        stem.map_or(case.to_string(), |stem| stem.to_string_lossy().into())
    }

    /// `dilation=1.8`, with lists and ranges as studies take them, or a key of a case file with
    /// its value, such as `material.tissue.young_modulus=3000`.
    pub fn setting(text: &str) -> Result<Wanted, FilterError> {
        let (name, levels) =
            text.split_once('=').ok_or_else(|| FilterError::NoValue(text.into()))?;
        if name.contains(['.', '[']) {
            let given = text.parse().map_err(|_| FilterError::NoValue(text.into()))?;
            return Ok(Wanted::Override(given));
        }
        let axis = Axis::named(name.trim(), levels)?;
        axis.levels.iter().try_for_each(|level| refuse_other_kind(axis.knob, level))?;
        Ok(Wanted::Level(axis))
    }

    /// YYYY-MM-DD; such texts are ordered as their days are.
    pub fn day(text: &str) -> Result<String, FilterError> {
        let parts: Vec<&str> = text.split('-').collect();
        let within = |part: &str, digits: usize, last: u32| {
            let number = part.parse::<u32>().ok().filter(|_| part.len() == digits);
            number.is_some_and(|number| (1..=last).contains(&number))
        };
        match parts.as_slice() {
            [y, m, d] if within(y, 4, 9999) && within(m, 2, 12) && within(d, 2, 31) => {
                Ok(text.into())
            }
            _ => Err(FilterError::Day(text.into())),
        }
    }
}

/// Refuses a level that no run can have.
fn refuse_other_kind(knob: Knob, level: &Level) -> Result<(), FilterError> {
    let refused = |word: &str, meant: String| {
        Err(FilterError::Word { knob: knob.name(), word: word.into(), meant })
    };
    match (knob.levels(), level) {
        (Levels::Word(words), level) => {
            let word = level.to_string();
            match nearest(&word, words.iter().copied()) {
                _ if words.contains(&word.as_str()) => Ok(()),
                Some(near) => refused(&word, format!("did you mean `{near}`?")),
                None => refused(&word, format!("its values are {}", words.join(", "))),
            }
        }
        (_, Level::Word(word)) if knob == Knob::Spacing && word.starts_with('x') => Ok(()),
        (_, Level::Word(word)) => refused(word, "its values are numbers".into()),
        (_, Level::Number(_)) => Ok(()),
    }
}

/// Whether a run has one of some levels. A spacing in metres may be that of the case.
fn has_level(record: &RunRecord, axis: &Axis) -> bool {
    let setting = record.setting(axis.knob).map(|Setting { level, .. }| level);
    let spacing = record.figure("spacing_m").filter(|_| axis.knob == Knob::Spacing);
    axis.levels.iter().any(|level| {
        let same_spacing = matches!((level, spacing), (Level::Number(a), Some(b))
            if (a - b).abs() <= 1e-9 * b.abs());
        same_spacing || setting.is_some_and(|set| equal(set, level))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::store::record::Timings;
    use crate::lab::store::{RunOutcome, Stage};

    fn record(case: &str, settings: Vec<Setting>, date: &str) -> RunRecord {
        let (processor, date) = (String::new(), date.to_string());
        RunRecord {
            schema_version: 1,
            key: String::new(),
            job: Job::Solve,
            case: case.into(),
            solver: String::new(),
            overrides: vec!["material.tissue.density=1e3".parse().unwrap()],
            settings,
            times_s: Vec::new(),
            outcome: RunOutcome::Failed { stage: Stage::Refused, reason: "none".into() },
            timings: Timings { set_up_cpu_s: 0.0, solve_cpu_s: 0.0, processor, date },
        }
    }

    #[test]
    fn a_record_is_accepted_where_all_filters_fit() {
        let settings =
            vec![Setting::number(Knob::Dilation, 1.8), Setting::word(Knob::Spacing, "x2")];
        let known = record("bar", settings, "2026-03-01");
        let with = |texts: &[&str]| RunFilter {
            cases: vec!["cube".into(), RunFilter::case_name("cases/bar.toml")],
            settings: texts.iter().map(|text| RunFilter::setting(text).unwrap()).collect(),
            since: Some(RunFilter::day("2026-03-01").unwrap()),
            jobs: vec![Job::Solve],
        };
        for texts in [
            &[][..],
            &["dilation=1.80", "spacing=x2.0"],
            &["dilation=1.4..2.2:0.2", "material.tissue.density=1000"],
        ] {
            assert!(with(texts).accepts(&known), "{texts:?}");
        }
        for texts in
            [["dilation=1.6"], ["spacing=x1"], ["basis=linear"], ["material.tissue.density=1"]]
        {
            assert!(!with(&texts).accepts(&known), "{texts:?}");
        }
        assert!(!RunFilter { jobs: vec![Job::Patch], ..with(&[]) }.accepts(&known));
        let later = RunFilter { since: Some("2026-03-02".into()), ..with(&[]) };
        assert!(!later.accepts(&known));
        assert!(RunFilter::default().accepts(&known));
    }

    #[test]
    fn what_no_record_can_have_is_refused_with_what_could_be_meant() {
        let refused = |text: &str| RunFilter::setting(text).unwrap_err().to_string();
        for (text, part) in [
            ("dilation", "is not a setting with its value"),
            ("dilatoin=1", "did you mean `dilation`?"),
            ("basis=quadratc", "did you mean `quadratic`?"),
            ("mass=7", "mass has no value `7`; its values are "),
            ("dilation=large", "dilation has no value `large`; its values are numbers"),
            ("dilation=", "neither a list"),
        ] {
            assert!(refused(text).contains(part), "{text}: {}", refused(text));
        }
        for day in ["yesterday", "2026-13-01", "2026-1-1", "01-01-2026", "2026-01-32", "2026-01"] {
            assert_eq!(RunFilter::day(day), Err(FilterError::Day(day.into())));
        }
    }
}
