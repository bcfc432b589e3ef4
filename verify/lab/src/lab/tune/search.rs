//! Successive halving: all recipes on one coarse cloud, fewer on finer and more clouds, the
//! last few over a series of spacings.

use super::design::{Candidate, candidates, solvers};
use super::effects::one_at_a_time;
use super::score::{expected, expected_factor, order};
use super::trial::{Goal, Trial, TrialRunner, TuneRequest};
use super::truth::{Truth, truth};
use crate::lab::label::percent;
use crate::lab::store::TaskRunner;
use crate::lab::sweep::refuse_too_many_runs;
use anyhow::{Result, bail};
use mtled_run::accuracy::Group;

/// Spacings of the rounds over that of the case \[–\].
const ROUNDS: [f64; 2] = [1.6, 1.25];
/// One recipe in so many goes on to the next round.
const REDUCTION: usize = 3;
/// At least this many go on, and at most this many are tried over spacings.
const LAST: usize = 3;
/// Ratio of neighbouring spacings: 15 % in an error of order 1.5.
const SPACING_RATIO: f64 = 1.1;
/// Largest number of spacings that are tried.
const MOST_SPACINGS: usize = 12;
/// Smallest and largest spacing over the case's own \[–\].
const FINEST: f64 = 0.3;
const COARSEST: f64 = 3.0;
/// Largest error of the solver over the goal \[–\].
const SOLVER_FRACTION: f64 = 0.1;
/// First seed of the clouds on which the winner is confirmed.
const FRESH: u64 = 1000;

/// Result of a search.
#[derive(Debug)]
pub struct Tuned {
    /// All recipes that were tried.
    pub candidates: Vec<Candidate>,
    /// All trials.
    pub trials: Vec<Trial>,
    /// The trial that meets the goal, if one does.
    pub winner: Option<Trial>,
    /// The winner on clouds that the search has not used.
    pub confirmed: Option<Trial>,
    /// The winner with one change each.
    pub changes: Vec<Trial>,
    /// Error of the reference solution itself \[–\].
    pub bar: f64,
    /// Where the reference solution comes from.
    pub reference: String,
    /// Quantities whose error is measured.
    pub group: Group,
    /// Why the reference solution cannot decide whether a recipe meets the goal; then nothing was
    /// tried.
    pub undecided: Option<String>,
    /// Trials that were refused before the first step or failed.
    pub failed: usize,
}

/// Searches; runs that are stored are not repeated.
pub fn tune(request: &TuneRequest, tasks: TaskRunner) -> Result<Tuned> {
    refuse_too_many_runs(&request.axes, ROUNDS.len())?;
    let Truth { reference, group, undecided } = truth(request, &tasks)?;
    let mut runner = TrialRunner::new(request, reference, group, tasks);
    let mut trials = Vec::new();
    if undecided.is_some() {
        return Ok(Tuned { undecided, ..found(runner, trials) });
    }
    let solver = best_solver(&mut runner, &mut trials)?;
    let offset = runner.candidates.len();
    runner.candidates.extend(candidates(&request.source.case, &request.axes).into_iter().map(
        |mut candidate| {
            candidate.settings.extend(solver.settings.iter().cloned());
            candidate
        },
    ));
    let last = halve(&runner, offset, &mut trials)?;
    let (winner, confirmed) = confirmed_winner(&runner, &last, &mut trials)?;
    let changes = match &winner {
        Some(winner) => one_at_a_time(&mut runner, winner)?,
        None => Vec::new(),
    };
    let undecided = match (&winner, request.goal) {
        (None, Goal::Error(target)) => hidden_by_the_reference(&runner, &trials, target),
        _ => None,
    };
    Ok(Tuned { winner, confirmed, changes, undecided, ..found(runner, trials) })
}

/// What was tried, without a winner.
fn found(runner: TrialRunner, trials: Vec<Trial>) -> Tuned {
    Tuned {
        bar: runner.bar(),
        reference: runner.reference.source.clone(),
        group: runner.group,
        candidates: runner.candidates,
        failed: trials.iter().filter(|trial| trial.failure.is_some()).count(),
        trials,
        winner: None,
        confirmed: None,
        changes: Vec::new(),
        undecided: None,
    }
}

/// Where recipes would meet the goal but for the error of the reference.
fn hidden_by_the_reference(runner: &TrialRunner, trials: &[Trial], target: f64) -> Option<String> {
    let bar = runner.bar();
    let close = trials.iter().filter(|trial| trial.worst() <= target).count();
    (close > 0 && bar > 0.0).then(|| {
        format!(
            "{close} trials differ from the reference by no more than the goal of {}, but not with \
             its own error of {} added: a better reference is needed (--reference FILE, or \
             --truth-budget for finer runs)",
            percent(target),
            percent(bar)
        )
    })
}

/// The cheapest solver that, with the case's own discretisation on a coarse cloud, adds
/// little to the error of the most accurate one.
fn best_solver(runner: &mut TrialRunner, trials: &mut Vec<Trial>) -> Result<Candidate> {
    runner.candidates = solvers(&runner.request.source.case);
    let points: Vec<(usize, f64)> = (0..runner.candidates.len()).map(|n| (n, ROUNDS[0])).collect();
    let tried = runner.trials(&points, &[0])?;
    let exact = tried.iter().map(Trial::worst).find(|error| error.is_finite());
    let Some(exact) = exact else {
        let reason = tried.iter().find_map(|trial| trial.failure.clone()).unwrap_or_default();
        bail!("{}: every solver fails: {reason}", runner.request.source.name);
    };
    let margin = SOLVER_FRACTION
        * match runner.request.goal {
            Goal::Error(target) => target,
            Goal::Budget(_) => exact,
        };
    let good = tried.iter().filter(|trial| (trial.worst() - exact).abs() <= margin);
    let cheapest = good.min_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s)).map_or(0, |t| t.candidate);
    trials.extend(tried);
    Ok(runner.candidates[cheapest].clone())
}

/// The best of the candidates from `offset` on after all rounds.
fn halve(runner: &TrialRunner, offset: usize, trials: &mut Vec<Trial>) -> Result<Vec<usize>> {
    let mut remaining: Vec<usize> = (offset..runner.candidates.len()).collect();
    for (round, factor) in ROUNDS.into_iter().enumerate() {
        let clouds: Vec<u64> = (0..=round as u64).collect();
        let points: Vec<(usize, f64)> =
            remaining.iter().map(|&candidate| (candidate, factor)).collect();
        let tried = runner.trials(&points, &clouds)?;
        trials.extend(tried.iter().cloned());
        let mut scored: Vec<(f64, usize)> =
            tried.iter().map(|trial| (score(runner, trials, trial), trial.candidate)).collect();
        scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        scored.retain(|(score, _)| score.is_finite());
        scored.truncate((scored.len() / REDUCTION).max(LAST));
        remaining = scored.into_iter().map(|(_, candidate)| candidate).collect();
    }
    remaining.truncate(LAST);
    Ok(remaining)
}

fn components(runner: &TrialRunner) -> usize {
    runner.request.source.case.problem.dimension.components()
}

fn own(trials: &[Trial], candidate: usize) -> Vec<&Trial> {
    trials.iter().filter(|trial| trial.candidate == candidate).collect()
}

fn score(runner: &TrialRunner, trials: &[Trial], trial: &Trial) -> f64 {
    let order = order(&own(trials, trial.candidate));
    expected(trial, runner.request.goal, order, components(runner), runner.bar())
}

/// The best trial that also meets the goal on clouds that the search has not used, and its
/// trial there.
fn confirmed_winner(
    runner: &TrialRunner,
    last: &[usize],
    trials: &mut Vec<Trial>,
) -> Result<(Option<Trial>, Option<Trial>)> {
    let clouds: Vec<u64> = (0..runner.request.clouds as u64).collect();
    let fresh: Vec<u64> = (0..runner.request.fresh as u64).map(|n| FRESH + n).collect();
    let mut passed = Vec::new();
    for &candidate in last {
        passed.extend(refine(runner, candidate, &clouds, trials)?);
    }
    // Errors below that of the reference solution count as equal: of those the cheapest.
    let known = |trial: &Trial| trial.worst().max(runner.bar());
    passed.sort_by(|a, b| match runner.request.goal {
        Goal::Error(_) => a.cpu_s.total_cmp(&b.cpu_s),
        Goal::Budget(_) => known(a).total_cmp(&known(b)).then(a.cpu_s.total_cmp(&b.cpu_s)),
    });
    for winner in passed {
        let confirmed = runner.trials(&[(winner.candidate, winner.factor)], &fresh)?.remove(0);
        let meets = match runner.request.goal {
            Goal::Error(target) => confirmed.worst() <= target,
            Goal::Budget(_) => confirmed.failure.is_none(),
        };
        if meets {
            return Ok((Some(winner), Some(confirmed)));
        }
    }
    Ok((None, None))
}

/// Trials of one candidate that meet the goal, around the spacing at which it is expected to:
/// for a target error the coarsest one and a finer one to fall back on, for a CPU budget the
/// finest one.
fn refine(
    runner: &TrialRunner,
    candidate: usize,
    clouds: &[u64],
    trials: &mut Vec<Trial>,
) -> Result<Vec<Trial>> {
    let known = own(trials, candidate);
    let Some(latest) = known.last() else { return Ok(Vec::new()) };
    let start = expected_factor(latest, runner.request.goal, order(&known), components(runner));
    let start = start.clamp(FINEST, COARSEST);
    let factor = |n: i32| (SPACING_RATIO.powi(n) * 1e4).round() / 1e4;
    let first = (start.ln() / SPACING_RATIO.ln()).round() as i32;
    let mut passed: Vec<Trial> = Vec::new();
    let (mut n, mut direction) = (first, None);
    for _ in 0..MOST_SPACINGS {
        if factor(n) < FINEST {
            break;
        }
        let trial = runner.trials(&[(candidate, factor(n))], clouds)?.remove(0);
        trials.push(trial.clone());
        let good = meets(runner, &trial);
        if good {
            passed.push(trial);
        }
        // For an error: coarser from a spacing that meets the goal until one does not, finer
        // from one that does not until one does. For a budget the other way round.
        let coarser_next = matches!(runner.request.goal, Goal::Error(_)) == good;
        match direction {
            Some(before) if before != coarser_next => break,
            _ => direction = Some(coarser_next),
        }
        n += if coarser_next { 1 } else { -1 };
        if factor(n) > COARSEST {
            break;
        }
    }
    Ok(passed)
}

/// Whether a trial meets the goal with a margin: the error is the largest over the clouds plus
/// half their range plus that of the reference solution.
fn meets(runner: &TrialRunner, trial: &Trial) -> bool {
    match runner.request.goal {
        Goal::Error(target) => {
            trial.worst() + 0.5 * (trial.worst() - trial.least()) + runner.bar() <= target
        }
        Goal::Budget(cpu_s) => trial.failure.is_none() && trial.cpu_s <= cpu_s,
    }
}
