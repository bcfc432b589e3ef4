//! One recipe for many cases: which candidate is cheapest at equal error, over all.

use super::design::{Candidate, candidates};
use super::score::{expected, order};
use super::{Bench, Goal, Trial, Wanted};
use crate::store::{Progress, Store};
use crate::sweep::find_truth;
use anyhow::{Result, bail};

/// Spacings of the two rounds over those of the cases \[–\].
const FACTORS: [f64; 2] = [1.6, 1.25];

/// How a candidate does on every case.
#[derive(Debug, Clone)]
pub struct Row {
    pub candidate: usize,
    /// Per case: expected CPU time at the error of the case's own recipe, over that of
    /// the case's own recipe \[–\]; infinite where it fails.
    pub ratios: Vec<f64>,
    /// Geometric mean over the cases where it ends.
    pub mean: f64,
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
    /// The best first: fewest failures, then cheapest.
    pub rows: Vec<Row>,
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
            Err(error) if error.downcast_ref::<crate::store::Stopped>().is_some() => {
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
    rows.sort_by(|a, b| a.failures.cmp(&b.failures).then(a.mean.total_cmp(&b.mean)));
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
    if ended.is_empty() {
        return None;
    }
    let mean = (ended.iter().map(|ratio| ratio.ln()).sum::<f64>() / ended.len() as f64).exp();
    Some(Row { candidate, ratios, mean, failures })
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
    let (dimensions, bar) = (case.problem.dimension.components(), bench.bar());
    let Some(own) = fine.first().filter(|trial| trial.worst().is_finite()) else {
        bail!("its own recipe fails at {} times its spacing", FACTORS[1]);
    };
    let goal = Goal::Error(own.worst().max(bar));
    let score = |(coarse, fine): (&Trial, &Trial)| {
        expected(fine, goal, order(&[coarse, fine]), dimensions, bar)
    };
    let scores: Vec<f64> = coarse.iter().zip(&fine).map(score).collect();
    let ratios = scores.iter().map(|score| score / scores[0]).collect();
    Ok((bench.candidates, ratios))
}
