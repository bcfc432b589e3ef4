//! The answers of a case beside their error bars and what is known of them.

use super::subjects::{Set, Subject};
use anyhow::Result;
use cpu_time::ThreadTime;
use mtled_case::reference::agreement::rms_of_points;
use mtled_case::reference::{Family, quantities};
use mtled_run::machine::on_threads;
use mtled_run::run::{Estimated, NoErrorBar, Recording, Work, error_bars, numbers, solve_case};

/// A known value with a larger error than this fraction of what it is to judge does not
/// judge \[–\].
const KNOWN_WELL_ENOUGH: f64 = 0.5;
/// Errors and bars below this fraction of the largest value of their family are nobody's
/// concern, such as those of forces that vanish by symmetry \[–\].
const NEGLIGIBLE: f64 = 1e-4;
/// A bar of use is within this factor of the error \[–\].
pub(crate) const USEFUL: f64 = 3.0;

/// What is to be said of an error bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// The error is known.
    Judged {
        /// It is not larger than the bar.
        within: bool,
        /// The two are within a factor of 3.
        useful: bool,
    },
    /// There is no bar, and words say why.
    InWords,
    /// The value is not known well enough.
    Unknown,
    /// Both are next to nothing.
    Negligible,
}

/// One answer.
pub(crate) struct Answer {
    pub quantity: String,
    pub family: Family,
    /// \[unit of the family\]
    pub error: f64,
    /// Error of the known value.
    pub known: f64,
    pub bar: Result<f64, NoErrorBar>,
    /// The largest known value of the family.
    pub largest: f64,
}

/// The answers of a subject and what their bars cost.
pub(crate) struct Answered {
    pub set: Set,
    pub name: String,
    pub answers: Vec<Answer>,
    /// CPU time of the error bars over that of the run, set-up included \[–\].
    pub cpu: f64,
    /// Neighbours visited for the error bars over those of the run \[–\].
    pub work: f64,
    /// CPU time of the run \[s\].
    pub run_seconds: f64,
}

impl Answer {
    pub(crate) fn verdict(&self) -> Verdict {
        let Ok(bar) = self.bar else { return Verdict::InWords };
        let largest = self.error.max(bar);
        if largest < NEGLIGIBLE * self.largest {
            return Verdict::Negligible;
        }
        if self.known > KNOWN_WELL_ENOUGH * largest {
            return Verdict::Unknown;
        }
        Verdict::Judged {
            within: self.error <= bar,
            useful: bar <= USEFUL * self.error && self.error <= USEFUL * bar,
        }
    }
}

/// Solves a subject and estimates its errors on one thread, whose time is measured.
pub(crate) fn answered(subject: &Subject) -> Result<Answered> {
    on_threads(1, || {
        let start = ThreadTime::now();
        let (solved, record) = solve_case(&subject.case)?;
        let run_seconds = start.elapsed().as_secs_f64();
        let bars = error_bars(&subject.case, &solved, &record, true);
        let bar_seconds = start.elapsed().as_secs_f64() - run_seconds;
        let visits = Work::of(&solved).neighbour_visits as f64;
        let coarser = bars.iter().flat_map(|bars| &bars.clouds);
        let work: usize = coarser.map(|cloud| cloud.work.neighbour_visits).sum();
        Ok(Answered {
            set: subject.set,
            name: subject.name.clone(),
            answers: answers(subject, &record, &bars),
            cpu: bar_seconds / run_seconds,
            work: work as f64 / visits,
            run_seconds,
        })
    })?
}

fn answers(subject: &Subject, record: &Recording, bars: &Estimated) -> Vec<Answer> {
    let case = &subject.case;
    let largest = |family: Family| {
        let of_family = quantities(case).into_iter().filter(|q| q.family == family);
        let known = of_family.filter_map(|q| subject.known.get(&q.name));
        known.map(|known| rms_of_points(&known.values, family.components())).fold(0.0, f64::max)
    };
    let answer = |quantity: mtled_case::reference::Quantity| {
        let known = subject.known.get(&quantity.name)?;
        let computed = numbers(case, record, &quantity, record.samples.last()?)?;
        let errors: Vec<f64> = computed.iter().zip(&known.values).map(|(a, b)| a - b).collect();
        let bar = match bars {
            Ok(bars) => bars.of(&quantity.name)?.clone(),
            Err(reason) => Err(reason.clone()),
        };
        Some(Answer {
            error: rms_of_points(&errors, quantity.family.components()),
            known: known.error,
            bar,
            largest: largest(quantity.family),
            family: quantity.family,
            quantity: quantity.name,
        })
    };
    let asked = quantities(case).into_iter().filter(|q| q.family != Family::Centre);
    asked.filter_map(answer).collect()
}
