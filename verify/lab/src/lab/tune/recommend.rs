//! One recipe for many cases: the candidate that is cheapest at equal error.

use super::design::{Candidate, candidates};
use super::score::{expected, order};
use super::trial::{Goal, Trial, TrialRunner, TuneRequest};
use super::truth::reference;
use crate::lab::store::{Stopped, TaskRunner};
use crate::lab::sweep::refuse_too_many_runs;
use anyhow::{Context, Result, bail};
use mtled_checks::measure::median;

/// Spacings of the two rounds over those of the cases \[–\].
const FACTORS: [f64; 2] = [1.6, 1.25];

/// A candidate on every case.
#[derive(Debug, Clone)]
pub struct Row {
    /// Index of the candidate.
    pub candidate: usize,
    /// Per case: expected CPU time at the error of the case's own recipe, over that of the
    /// case's own recipe \[–\]; geometric mean over the spacings, infinite where it fails.
    pub ratios: Vec<f64>,
    /// Geometric mean over the cases where it does not fail.
    pub mean: f64,
    /// Median over the same cases.
    pub median: f64,
    /// Maximum over the same cases.
    pub worst: f64,
    /// Cases where it is refused or fails.
    pub failures: usize,
}

/// A recipe recommended for many cases.
#[derive(Debug)]
pub struct Recommendation {
    /// Names of the cases.
    pub cases: Vec<String>,
    /// Cases that could not be used, with the reason.
    pub skipped: Vec<String>,
    /// All recipes that were tried.
    pub candidates: Vec<Candidate>,
    /// Ordered by the number of failures, then by the median.
    pub rows: Vec<Row>,
}

/// Medians within this factor of the smallest count as equal: CPU times of the same recipe
/// on the same case differ by up to a quarter, their median over 16 cases by less than
/// this \[–\].
const EQUAL_WITHIN: f64 = 1.1;

impl Recommendation {
    /// Of the recipes with the fewest failures and a median that counts as equal to the
    /// smallest, the one with the smallest worst case. A median is not moved by a case where
    /// the error is small by chance, as a mean is; the worst case is what a user of the
    /// default meets without warning.
    pub(crate) fn chosen(&self) -> &Row {
        let first = &self.rows[0];
        let near = |row: &&Row| {
            row.failures == first.failures && row.median <= EQUAL_WITHIN * first.median
        };
        self.rows.iter().filter(near).min_by(|a, b| a.worst.total_cmp(&b.worst)).unwrap_or(first)
    }
}

/// Runs the design on every case, on one coarse cloud and on two finer ones. The recipe of
/// each case is the first candidate and sets the error that the others must reach.
pub fn recommend(requests: &[TuneRequest], tasks: TaskRunner) -> Result<Recommendation> {
    let (mut cases, mut skipped, mut columns) = (Vec::new(), Vec::new(), Vec::new());
    let mut all: Vec<Candidate> = Vec::new();
    for request in requests {
        refuse_too_many_runs(&request.axes, FACTORS.len())?;
        match column(request, tasks) {
            Ok((candidates, ratios)) => {
                // The cases do not have the same candidates: masses are tried in dynamics only.
                for candidate in &candidates {
                    if !all.contains(candidate) {
                        all.push(candidate.clone());
                    }
                }
                cases.push(request.source.name.clone());
                columns.push((candidates, ratios));
            }
            Err(error) if error.is::<Stopped>() => return Err(error),
            Err(error) => skipped.push(format!("{}: {error:#}", request.source.name)),
        }
    }
    if cases.is_empty() {
        bail!("no case could be used: {}", skipped.join("; "));
    }
    let mut rows: Vec<Row> =
        (0..all.len()).filter_map(|candidate| row(candidate, &all, &columns)).collect();
    rows.sort_by(|a, b| a.failures.cmp(&b.failures).then(a.median.total_cmp(&b.median)));
    Ok(Recommendation { cases, skipped, candidates: all, rows })
}

type Columns = [(Vec<Candidate>, Vec<f64>)];

fn row(candidate: usize, all: &[Candidate], columns: &Columns) -> Option<Row> {
    let ratio = |(candidates, ratios): &(Vec<Candidate>, Vec<f64>)| {
        let at = candidates.iter().position(|other| *other == all[candidate]);
        at.map_or(f64::NAN, |at| ratios[at])
    };
    let ratios: Vec<f64> = columns.iter().map(ratio).collect();
    let failures = ratios.iter().filter(|ratio| ratio.is_infinite()).count();
    let ended: Vec<f64> = ratios.iter().copied().filter(|ratio| ratio.is_finite()).collect();
    let median = median(&ended)?;
    let mean = (ended.iter().map(|ratio| ratio.ln()).sum::<f64>() / ended.len() as f64).exp();
    let worst = ended.iter().copied().fold(0.0, f64::max);
    Some(Row { candidate, ratios, mean, median, worst, failures })
}

/// Every candidate on one case: its cost over that of the case's own recipe.
fn column(request: &TuneRequest, tasks: TaskRunner) -> Result<(Vec<Candidate>, Vec<f64>)> {
    let case = &request.source.case;
    let (solution, group) = reference(request, &request.reference, &tasks)?;
    let mut runner = TrialRunner::new(request, solution, group, tasks);
    runner.candidates = candidates(case, &request.axes);
    let count = runner.candidates.len();
    let at = |factor: f64| (0..count).map(|n| (n, factor)).collect::<Vec<_>>();
    let coarse = runner.trials(&at(FACTORS[0]), &[0])?;
    let fine = runner.trials(&at(FACTORS[1]), &[0, 1])?;
    let bar = runner.bar();
    let own = (&coarse[0], &fine[0]);
    if !own.0.worst().max(own.1.worst()).is_finite() {
        bail!("its own recipe fails at {} or {} times its spacing", FACTORS[0], FACTORS[1]);
    }
    // One order for all recipes: two spacings are too few for an order of each.
    let ended = coarse.iter().zip(&fine).filter(|(c, f)| c.worst().max(f.worst()).is_finite());
    let orders: Vec<f64> = ended.map(|(coarse, fine)| order(&[coarse, fine])).collect();
    let order = median(&orders).context("no recipe has an order")?;
    let dimensions = case.problem.dimension.components();
    // At the same spacing, the geometric mean of both.
    let relative_cost = |trial: &Trial, own: &Trial| {
        expected(trial, Goal::Error(own.worst().max(bar)), order, dimensions, bar) / own.cpu_s
    };
    let ratio = |(coarse, fine): (&Trial, &Trial)| {
        (relative_cost(coarse, own.0) * relative_cost(fine, own.1)).sqrt()
    };
    let ratios = coarse.iter().zip(&fine).map(ratio).collect();
    Ok((runner.candidates, ratios))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn among_equal_medians_the_recipe_with_the_smallest_worst_case_is_recommended() {
        let row = |candidate, median, worst, failures| Row {
            candidate,
            ratios: Vec::new(),
            mean: 1.0,
            median,
            worst,
            failures,
        };
        let rows = vec![
            row(0, 0.95, 6.0, 0),
            row(1, 1.0, 1.2, 0),
            row(2, 1.3, 1.1, 0),
            row(3, 0.5, 0.6, 1),
        ];
        let (cases, skipped, candidates) = (Vec::new(), Vec::new(), Vec::new());
        let recommendation = Recommendation { cases, skipped, candidates, rows };
        assert_eq!(recommendation.chosen().candidate, 1);
    }
}
