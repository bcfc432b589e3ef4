//! Successive halving: all recipes on one coarse cloud, fewer on finer and more
//! clouds, the last few along a ladder of spacings.

use super::design::{Candidate, candidates, solvers};
use super::effects::one_at_a_time;
use super::score::{expected, expected_factor, order};
use super::{Bench, Goal, Trial, Wanted};
use crate::explore::store::{Progress, Store};
use crate::explore::sweep::find_truth;
use anyhow::{Result, bail};

/// Spacings of the rounds over that of the case \[–\].
const ROUNDS: [f64; 2] = [1.6, 1.25];
/// Of a round, this share goes on.
const KEPT: usize = 3;
/// At least this many go on to the ladder.
const LAST: usize = 3;
/// Neighbouring rungs of the ladder of spacings differ by this factor: errors of order
/// 1.5 by 15 %.
const RUNG: f64 = 1.1;
/// Rungs that are tried beyond what was expected.
const MOST_RUNGS: usize = 12;
/// No spacing is made smaller than this share of the case's own.
const FINEST: f64 = 0.3;
/// How much the way of solving may add to the error, over the goal \[–\].
const SOLVER_SHARE: f64 = 0.1;
/// Seeds of clouds on which the winner is confirmed begin here.
const FRESH: u64 = 1000;

/// What a search has found.
#[derive(Debug)]
pub struct Tuned {
    pub candidates: Vec<Candidate>,
    /// Every trial.
    pub trials: Vec<Trial>,
    /// The trial that meets the goal, if one does.
    pub winner: Option<Trial>,
    /// The winner on clouds that nobody had looked at.
    pub confirmed: Option<Trial>,
    /// The winner with one change each.
    pub changes: Vec<Trial>,
    pub bar: f64,
    pub truth: String,
    pub group: crate::accuracy::Group,
    /// Recipes that were refused before the first step or failed on the way.
    pub dropped: usize,
}

/// Searches; runs that are on record are not run again.
pub fn tune(wanted: &Wanted, store: &Store, say: &(dyn Fn(Progress) + Sync)) -> Result<Tuned> {
    let truth = find_truth(&wanted.truth, &wanted.source, &[], store, say)?;
    let case = &wanted.source.case;
    let Some(group) = wanted.group.or_else(|| truth.group(case)) else {
        bail!("{}: has no probe and no support whose error could be told", wanted.source.name);
    };
    let mut bench = Bench { wanted, candidates: Vec::new(), truth, group, store, say };
    let mut trials = Vec::new();
    let solver = best_solver(&mut bench, &mut trials)?;
    let offset = bench.candidates.len();
    bench.candidates.extend(candidates(case, &wanted.axes).into_iter().map(|mut candidate| {
        candidate.settings.extend(solver.settings.iter().cloned());
        candidate
    }));
    let last = halve(&bench, offset, &mut trials)?;
    let (winner, confirmed) = ladder(&bench, &last, &mut trials)?;
    let changes = match &winner {
        Some(winner) => one_at_a_time(&mut bench, winner)?,
        None => Vec::new(),
    };
    let dropped = trials.iter().filter(|trial| trial.failure.is_some()).count();
    Ok(Tuned {
        bar: bench.bar(),
        truth: bench.truth.source.clone(),
        group,
        candidates: bench.candidates,
        trials,
        winner,
        confirmed,
        changes,
        dropped,
    })
}

/// The cheapest way of solving the case's own discretisation on a coarse cloud that
/// adds little to the error of the most exact one.
fn best_solver(bench: &mut Bench, trials: &mut Vec<Trial>) -> Result<Candidate> {
    bench.candidates = solvers(&bench.wanted.source.case);
    let points: Vec<(usize, f64)> = (0..bench.candidates.len()).map(|n| (n, ROUNDS[0])).collect();
    let tried = bench.trials(&points, &[0])?;
    let exact = tried.iter().map(Trial::worst).find(|error| error.is_finite());
    let Some(exact) = exact else {
        let reason = tried.iter().find_map(|trial| trial.failure.clone()).unwrap_or_default();
        bail!("{}: no way of solving ends soundly: {reason}", bench.wanted.source.name);
    };
    let room = SOLVER_SHARE
        * match bench.wanted.goal {
            Goal::Error(target) => target,
            Goal::Budget(_) => exact,
        };
    let good = tried.iter().filter(|trial| (trial.worst() - exact).abs() <= room);
    let cheapest = good.min_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s)).map_or(0, |t| t.candidate);
    trials.extend(tried);
    Ok(bench.candidates[cheapest].clone())
}

/// The candidates from `offset` on through the rounds; those that go on to the ladder.
fn halve(bench: &Bench, offset: usize, trials: &mut Vec<Trial>) -> Result<Vec<usize>> {
    let mut alive: Vec<usize> = (offset..bench.candidates.len()).collect();
    for (round, factor) in ROUNDS.into_iter().enumerate() {
        let clouds: Vec<u64> = (0..=round as u64).collect();
        let points: Vec<(usize, f64)> =
            alive.iter().map(|&candidate| (candidate, factor)).collect();
        let tried = bench.trials(&points, &clouds)?;
        trials.extend(tried.iter().cloned());
        let mut scored: Vec<(f64, usize)> =
            tried.iter().map(|trial| (score(bench, trials, trial), trial.candidate)).collect();
        scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        scored.retain(|(score, _)| score.is_finite());
        scored.truncate((scored.len() / KEPT).max(LAST));
        alive = scored.into_iter().map(|(_, candidate)| candidate).collect();
    }
    alive.truncate(LAST);
    Ok(alive)
}

fn components(bench: &Bench) -> usize {
    bench.wanted.source.case.problem.dimension.components()
}

fn own(trials: &[Trial], candidate: usize) -> Vec<&Trial> {
    trials.iter().filter(|trial| trial.candidate == candidate).collect()
}

fn score(bench: &Bench, trials: &[Trial], trial: &Trial) -> f64 {
    let order = order(&own(trials, trial.candidate));
    expected(trial, bench.wanted.goal, order, components(bench), bench.bar())
}

/// The winner of the ladder and its confirmation on fresh clouds; where that fails the
/// goal is asked for with more room.
fn ladder(
    bench: &Bench,
    last: &[usize],
    trials: &mut Vec<Trial>,
) -> Result<(Option<Trial>, Option<Trial>)> {
    let clouds: Vec<u64> = (0..bench.wanted.clouds as u64).collect();
    let fresh: Vec<u64> = (0..bench.wanted.fresh as u64).map(|n| FRESH + n).collect();
    let mut standing = Vec::new();
    for &candidate in last {
        standing.extend(climb(bench, candidate, &clouds, trials)?);
    }
    // Errors below the truth's own are alike: of those the cheapest.
    let known = |trial: &Trial| trial.worst().max(bench.bar());
    standing.sort_by(|a, b| match bench.wanted.goal {
        Goal::Error(_) => a.cpu_s.total_cmp(&b.cpu_s),
        Goal::Budget(_) => known(a).total_cmp(&known(b)).then(a.cpu_s.total_cmp(&b.cpu_s)),
    });
    for winner in standing {
        let confirmed = bench.trials(&[(winner.candidate, winner.factor)], &fresh)?.remove(0);
        let holds = match bench.wanted.goal {
            Goal::Error(target) => confirmed.worst() <= target,
            Goal::Budget(_) => confirmed.failure.is_none(),
        };
        if holds {
            return Ok((Some(winner), Some(confirmed)));
        }
    }
    Ok((None, None))
}

/// Rungs of one candidate around the spacing at which it is expected to meet the goal:
/// for a wanted error the coarsest that meets it and a finer one to fall back on, for a
/// wanted cost the finest within it.
fn climb(
    bench: &Bench,
    candidate: usize,
    clouds: &[u64],
    trials: &mut Vec<Trial>,
) -> Result<Vec<Trial>> {
    let known = own(trials, candidate);
    let Some(latest) = known.last() else { return Ok(Vec::new()) };
    let start = expected_factor(latest, bench.wanted.goal, order(&known), components(bench));
    let start = start.clamp(FINEST, 3.0);
    let rung = |n: i32| (RUNG.powi(n) * 1e4).round() / 1e4;
    let first = (start.ln() / RUNG.ln()).round() as i32;
    let mut standing: Vec<Trial> = Vec::new();
    let (mut n, mut down) = (first, None);
    for _ in 0..MOST_RUNGS {
        let factor = rung(n);
        if factor < FINEST {
            break;
        }
        let trial = bench.trials(&[(candidate, factor)], clouds)?.remove(0);
        trials.push(trial.clone());
        let good = meets(bench, &trial);
        if good {
            standing.push(trial);
        }
        // For an error: from a good rung up to coarser ones until one is bad, from a
        // bad one down to finer ones until one is good. For a cost the other way.
        let coarser_next = matches!(bench.wanted.goal, Goal::Error(_)) == good;
        match down {
            Some(before) if before != coarser_next => break,
            _ => down = Some(coarser_next),
        }
        n += if coarser_next { 1 } else { -1 };
        if rung(n) > 3.0 {
            break;
        }
    }
    Ok(standing)
}

/// Whether a trial meets the goal with a margin: for an error, the largest over the
/// clouds with half their range and the truth's own error on top of it.
fn meets(bench: &Bench, trial: &Trial) -> bool {
    match bench.wanted.goal {
        Goal::Error(target) => trial.worst() + 0.5 * trial.range() + bench.bar() <= target,
        Goal::Budget(cpu_s) => trial.failure.is_none() && trial.cpu_s <= cpu_s,
    }
}
