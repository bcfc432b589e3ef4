//! One recipe for many cases: which candidate is cheapest at equal error, over all.

use super::design::{Candidate, candidates};
use super::score::{expected, order};
use super::{Bench, Goal, Trial, Wanted};
use crate::explore::store::{Progress, Store};
use crate::explore::sweep::find_truth;
use anyhow::{Context, Result, bail};
use mtled_checks::measure::median;

/// Spacings of the two rounds over those of the cases \[–\].
const FACTORS: [f64; 2] = [1.6, 1.25];

/// How a candidate does on every case.
#[derive(Debug, Clone)]
pub struct Row {
    pub candidate: usize,
    /// Per case: expected CPU time at the error of the case's own recipe, over that of
    /// the case's own recipe \[–\]; the geometric mean over the spacings, infinite
    /// where it fails.
    pub ratios: Vec<f64>,
    /// Geometric mean over the cases where it ends.
    pub mean: f64,
    /// Over the same cases.
    pub median: f64,
    /// The largest of them.
    pub worst: f64,
    /// Cases where it is refused or fails.
    pub failures: usize,
}

/// What is recommended over many cases.
#[derive(Debug)]
pub struct Recommendation {
    pub cases: Vec<String>,
    /// Cases that were left out, and why.
    pub skipped: Vec<String>,
    pub candidates: Vec<Candidate>,
    /// The best first: fewest failures, then the smallest median.
    pub rows: Vec<Row>,
}

/// Medians so much above the smallest are not told apart: processor times of the same
/// recipe on the same case differ by up to a quarter, their median over 16 cases by less
/// than this \[–\].
const TOLD_APART: f64 = 1.1;

impl Recommendation {
    /// Of the recipes with the fewest failures and the smallest medians the one with the
    /// smallest worst case. The median is not moved by a case where an error is small by
    /// luck, as a mean is; the worst case is what a user of a default meets unwarned.
    pub fn chosen(&self) -> &Row {
        let first = &self.rows[0];
        let near =
            |row: &&Row| row.failures == first.failures && row.median <= TOLD_APART * first.median;
        self.rows.iter().filter(near).min_by(|a, b| a.worst.total_cmp(&b.worst)).unwrap_or(first)
    }
}

/// Runs the design on every case, one coarse cloud and two on a finer one; the recipe
/// of each case as it is comes first and sets its goal.
pub fn recommend(
    wanted: &[Wanted],
    store: &Store,
    say: &(dyn Fn(Progress) + Sync),
) -> Result<Recommendation> {
    let (mut cases, mut skipped, mut columns) = (Vec::new(), Vec::new(), Vec::new());
    let mut all: Vec<Candidate> = Vec::new();
    for one in wanted {
        match column(one, store, say) {
            Ok((candidates, ratios)) => {
                // Candidates of all cases by what they are: mass is tried in motion only.
                for candidate in &candidates {
                    if !all.contains(candidate) {
                        all.push(candidate.clone());
                    }
                }
                cases.push(one.source.name.clone());
                columns.push((candidates, ratios));
            }
            Err(error) if error.downcast_ref::<crate::explore::store::Stopped>().is_some() => {
                return Err(error);
            }
            Err(error) => skipped.push(format!("{}: {error:#}", one.source.name)),
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

/// Every candidate on one case, over the case's own recipe.
fn column(
    wanted: &Wanted,
    store: &Store,
    say: &(dyn Fn(Progress) + Sync),
) -> Result<(Vec<Candidate>, Vec<f64>)> {
    let truth = find_truth(&wanted.truth, &wanted.source, &[], store, say)?;
    let case = &wanted.source.case;
    let Some(group) = wanted.group.or_else(|| truth.group(case)) else {
        bail!("has no probe and no support whose error could be told");
    };
    let candidates = candidates(case, &wanted.axes);
    let bench = Bench { wanted, candidates, truth, group, store, say };
    let count = bench.candidates.len();
    let at = |factor: f64| (0..count).map(|n| (n, factor)).collect::<Vec<_>>();
    let coarse = bench.trials(&at(FACTORS[0]), &[0])?;
    let fine = bench.trials(&at(FACTORS[1]), &[0, 1])?;
    let bar = bench.bar();
    let own = (&coarse[0], &fine[0]);
    if !own.0.worst().max(own.1.worst()).is_finite() {
        bail!("its own recipe fails at {} or {} times its spacing", FACTORS[0], FACTORS[1]);
    }
    // One order for all recipes: two spacings tell too little of each.
    let ended = coarse.iter().zip(&fine).filter(|(c, f)| c.worst().max(f.worst()).is_finite());
    let orders: Vec<f64> = ended.map(|(coarse, fine)| order(&[coarse, fine])).collect();
    let order = median(&orders).context("no recipe has an order")?;
    let dimensions = case.problem.dimension.components();
    // At the same spacing, the geometric mean of both.
    let over = |trial: &Trial, own: &Trial| {
        expected(trial, Goal::Error(own.worst().max(bar)), order, dimensions, bar) / own.cpu_s
    };
    let ratio = |(coarse, fine): (&Trial, &Trial)| (over(coarse, own.0) * over(fine, own.1)).sqrt();
    let ratios = coarse.iter().zip(&fine).map(ratio).collect();
    Ok((bench.candidates, ratios))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn among_like_medians_the_mildest_worst_case_is_recommended_and_never_one_that_fails() {
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
        let found = Recommendation { cases, skipped, candidates, rows };
        assert_eq!(found.chosen().candidate, 1);
    }
}
