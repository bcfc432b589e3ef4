//! How a study or a run of many ended.

use super::check::Check;
use super::report::{Report, Study};

/// How a study or a run of many ended, the worst last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// Every study ran, every bound is kept and nothing got worse.
    Passed,
    /// Nothing failed, but a question could not be decided.
    Inconclusive,
    /// A bound is broken, or a figure got worse or is missing.
    Failed,
    /// A study could not run; a skip is not a pass.
    CouldNotRun,
}

impl Outcome {
    /// As it is written in reports.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Outcome::Passed => "pass",
            Outcome::Inconclusive => "inconclusive",
            Outcome::Failed => "FAIL",
            Outcome::CouldNotRun => "COULD NOT RUN",
        }
    }

    /// Exit code of a program that ends so.
    pub fn exit_code(self) -> u8 {
        match self {
            Outcome::Passed => 0,
            Outcome::Failed => 1,
            Outcome::CouldNotRun => 2,
            Outcome::Inconclusive => 3,
        }
    }
}

impl Check {
    /// Whether it passed or failed; a figure that nothing judges has done neither.
    pub(crate) fn outcome(&self) -> Outcome {
        match (self.pass, self.is_judged()) {
            (false, _) => Outcome::Failed,
            (true, true) => Outcome::Passed,
            (true, false) => Outcome::Inconclusive,
        }
    }
}

impl Study {
    /// How it ended.
    pub(crate) fn outcome(&self) -> Outcome {
        if self.failure.is_some() {
            return Outcome::CouldNotRun;
        }
        let checks = self.checks.iter().map(Check::outcome).max().unwrap_or(Outcome::Passed);
        if self.undecided.is_empty() { checks } else { checks.max(Outcome::Inconclusive) }
    }

    /// Its open questions, and the number of figures that nothing judges.
    pub(crate) fn questions(&self) -> Vec<String> {
        let mut questions = self.undecided.clone();
        let new: Vec<&Check> = self.checks.iter().filter(|check| !check.is_judged()).collect();
        if let Some(first) = new.first() {
            let (count, first) = (new.len(), &first.id);
            questions.push(match count {
                1 => format!("{first} is new: {NEW}"),
                _ => format!("{count} figures are new, such as {first}: {NEW}"),
            });
        }
        questions
    }
}

/// Why a new figure is not judged, and what to do.
const NEW: &str = "nothing judges what has no bound and no stored figure; compare with a baseline \
                   (--baseline) that --update-baseline has taken it up into";

impl Report {
    /// How it ended, beside the baseline too.
    pub fn outcome(&self) -> Outcome {
        let studies = self.studies.iter().map(Study::outcome).max().unwrap_or(Outcome::Passed);
        if self.comparison.as_ref().is_none_or(|comparison| comparison.holds()) {
            studies
        } else {
            studies.max(Outcome::Failed)
        }
    }

    /// Whether every study ran, every question was decided, every bound is kept and nothing got
    /// worse.
    pub fn passed(&self) -> bool {
        self.outcome() == Outcome::Passed
    }

    /// Whether every study ran and every bound is kept.
    pub(crate) fn bounds_hold(&self) -> bool {
        self.studies.iter().all(|study| study.outcome() < Outcome::Failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Better, Bound, Kind};

    fn study(value: f64, undecided: &[&str], failure: Option<&str>) -> Study {
        let bound = Bound::AtMost(1.0);
        Study {
            checks: vec![Check::new("a/b", "", Kind::Exact, value, bound, "1", "")],
            undecided: undecided.iter().map(|text| text.to_string()).collect(),
            failure: failure.map(String::from),
            ..Study::default()
        }
    }

    #[test]
    fn an_open_question_is_no_pass_and_hides_no_failure() {
        assert_eq!(study(0.5, &[], None).outcome(), Outcome::Passed);
        assert_eq!(study(0.5, &["which is better"], None).outcome(), Outcome::Inconclusive);
        assert_eq!(study(1.5, &["which is better"], None).outcome(), Outcome::Failed);
        assert_eq!(
            study(0.5, &["which is better"], Some("no file")).outcome(),
            Outcome::CouldNotRun
        );
    }

    #[test]
    fn a_figure_without_a_stored_band_is_no_pass_and_with_one_it_is_judged() {
        let check = |value| {
            Check::new(
                "a/b",
                "",
                Kind::Regression,
                value,
                Bound::Baseline(Better::Neither),
                "1",
                "",
            )
        };
        let of = |check: Check| Study { checks: vec![check], ..Study::default() };
        let new = of(check(0.5));
        assert_eq!(new.outcome(), Outcome::Inconclusive);
        assert!(!new.checks[0].passed() && new.questions()[0].contains("a/b is new"));
        assert_eq!(of(check(f64::NAN)).outcome(), Outcome::Failed);
        let source = crate::study::BandSource::Theory;
        let band = crate::study::Band { low: 0.4, high: 0.6, source, scatter: None };
        let known = of(Check { band: Some(band), ..check(0.5) });
        assert_eq!(known.outcome(), Outcome::Passed);
        assert!(known.questions().is_empty());
    }

    #[test]
    fn each_outcome_has_an_exit_code_of_its_own() {
        let all = [Outcome::Passed, Outcome::Failed, Outcome::CouldNotRun, Outcome::Inconclusive];
        assert_eq!(all.map(Outcome::exit_code), [0, 1, 2, 3]);
    }
}
