//! Figures of the same code on other clouds.

use super::band::{around_mean, mean_and_scatter, tail};
use super::baseline::GateError;
use super::judge::verdict;
use crate::study::{Band, Check, Report, Scatter, Verdict};
use std::collections::BTreeMap;

/// The figures of every check over other clouds; may be empty.
#[derive(Debug, Clone, Default)]
pub struct Clouds<'a> {
    samples: BTreeMap<&'a str, Vec<f64>>,
    runs: &'a [Report],
}

/// Checks of one run that need attention.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Suspect {
    /// Place of the run in the list.
    pub run: usize,
    /// Ids.
    pub checks: Vec<String>,
}

impl<'a> Clouds<'a> {
    /// From runs of the same code over other clouds: none, or at least two.
    pub fn new(runs: &'a [Report]) -> Result<Clouds<'a>, GateError> {
        if runs.len() == 1 {
            return Err(GateError::TooFewClouds(1));
        }
        let mut samples: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for check in runs.iter().flat_map(Report::checks) {
            samples.entry(&check.id).or_default().push(check.value);
        }
        Ok(Clouds { samples, runs })
    }

    /// Whether there are no other clouds.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Number of other clouds.
    pub fn runs(&self) -> usize {
        self.runs.len()
    }

    /// Mean and scatter of a check over the other clouds and its own; None
    /// where it is the same on every cloud.
    pub(crate) fn mean_and_scatter(&self, check: &Check) -> Option<(f64, Scatter)> {
        let mut samples = self.samples.get(check.id.as_str())?.clone();
        samples.push(check.value);
        mean_and_scatter(&samples, &check.unit)
    }

    /// Runs that break bounds: the code fails on other clouds, or its bounds are too
    /// tight for them.
    pub fn failing(&self) -> Vec<Suspect> {
        suspects(self.runs.iter().map(|run| {
            let failed = run.checks().filter(|check| !check.pass);
            failed.map(|check| check.id.clone()).collect()
        }))
    }

    /// Cross-validation: judges each run by bands from all the others; the bands are
    /// sound if nearly nothing is worse.
    pub fn left_out(&self, report: &Report) -> Vec<Suspect> {
        let moved = report.checks().filter(|check| self.mean_and_scatter(check).is_some()).count();
        suspects(self.runs.iter().enumerate().map(|(run, left)| {
            let worse = left.checks().filter(|check| {
                let rest = self.without(check, run, tail(moved));
                check.pass && rest.is_some_and(|band| verdict(check, &band) == Verdict::Worse)
            });
            worse.map(|check| check.id.clone()).collect()
        }))
    }

    /// The band of a check from all runs but one.
    fn without(&self, check: &Check, run: usize, tail: f64) -> Option<Band> {
        let rest = self.runs.iter().enumerate().filter(|(index, _)| *index != run);
        let values = rest.filter_map(|(_, report)| {
            report.checks().find(|other| other.id == check.id).map(|other| other.value)
        });
        let values: Vec<f64> = values.collect();
        let (mean, scatter) = mean_and_scatter(&values, &check.unit)?;
        // The value of the left-out run must not widen the band that judges it.
        let other = Check { value: values[0], ..check.clone() };
        Some(around_mean(&other, mean, scatter, tail))
    }
}

fn suspects(runs: impl Iterator<Item = Vec<String>>) -> Vec<Suspect> {
    let all = runs.enumerate().map(|(run, checks)| Suspect { run, checks });
    all.filter(|suspect| !suspect.checks.is_empty()).collect()
}
