//! What error and cost are sensitive to.

use super::design::{Candidate, matters};
use super::trial::{Trial, TrialRunner};
use crate::lab::label::settings_label;
use anyhow::{Context, Result};
use mtled_case::scene::{Knob, Level, Setting};

/// Changes of the winner, one at a time.
const CHANGES: &[(Knob, &str)] = &[
    (Knob::Basis, "quadratic"),
    (Knob::WeightFunction, "cubic_spline"),
    (Knob::WeightFunction, "exponential"),
    (Knob::Mass, "even_split"),
    (Knob::Gradients, "plain"),
    (Knob::VolumetricProjection, "none"),
    (Knob::Enforcement, "direct"),
];

/// The winner with one change each, on the same clouds; the changed recipes are added to
/// the candidates.
pub(crate) fn one_at_a_time(runner: &mut TrialRunner, winner: &Trial) -> Result<Vec<Trial>> {
    let request = runner.request;
    let own = runner.candidates[winner.candidate].settings.clone();
    let mut points = Vec::new();
    for change in changes(runner, winner)? {
        let kept = own.iter().filter(|old| change.iter().all(|new| new.knob != old.knob));
        let settings = kept.cloned().chain(change.iter().cloned()).collect();
        points.push((runner.candidates.len(), winner.factor));
        runner.candidates.push(Candidate::single(settings));
    }
    for factor in [1.0 / 1.1, 1.1] {
        points.push((winner.candidate, rounded(winner.factor * factor)));
    }
    let clouds: Vec<u64> = (0..request.clouds as u64).collect();
    runner.trials(&points, &clouds)
}

fn rounded(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}

/// Changes of the recipe of the winner that are not part of it already.
fn changes(runner: &TrialRunner, winner: &Trial) -> Result<Vec<Vec<Setting>>> {
    let case = &runner.request.source.case;
    let recipe = &case.problem.recipe;
    let candidate = &runner.candidates[winner.candidate];
    let dilation = candidate.number(Knob::Dilation).unwrap_or(recipe.dilation);
    let spacing = recipe.spacing().context("nodes that are given have no spacing to change")?;
    let cells = candidate.number(Knob::CellsPerSpacing).unwrap_or(spacing / recipe.grid.cell);
    let mut changes: Vec<Vec<Setting>> = Vec::new();
    for step in [-0.2, 0.2] {
        changes.push(vec![Setting::number(Knob::Dilation, rounded(dilation + step))]);
    }
    for factor in [1.0 / 1.26, 1.26] {
        changes.push(vec![Setting::number(Knob::CellsPerSpacing, rounded(cells * factor))]);
    }
    for (knob, level) in CHANGES.iter().filter(|(knob, _)| matters(*knob, case)) {
        let mut change = vec![Setting::word(*knob, level)];
        if (*knob, *level) == (Knob::Basis, "quadratic") {
            change.push(Setting::number(Knob::Dilation, 2.6));
        }
        if !change.iter().all(|setting| candidate.settings.contains(setting)) {
            changes.push(change);
        }
    }
    Ok(changes)
}

/// The settings in which a change differs from the winner.
pub(crate) fn change_label(candidates: &[Candidate], winner: &Trial, change: &Trial) -> String {
    if change.candidate == winner.candidate {
        return format!("spacing x{:.3}", change.factor / winner.factor);
    }
    let own = &candidates[winner.candidate].settings;
    let changed = &candidates[change.candidate].settings;
    settings_label(changed.iter().filter(|setting| !own.contains(setting)))
}

/// The main effect of one level of the factorial: the mean over all recipes with it, over
/// the mean of all recipes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MainEffect {
    pub knob: Knob,
    pub level: Level,
    /// On the error, geometric mean \[–\].
    pub error: f64,
    /// On the CPU time, geometric mean \[–\].
    pub cpu: f64,
    /// Number of trials with this level.
    pub trials: usize,
}

/// Main effects of the factorial in its first round, without the trials that failed.
pub(crate) fn main_effects(candidates: &[Candidate], trials: &[Trial]) -> Vec<MainEffect> {
    let mut rows: Vec<(&Candidate, f64, f64)> = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for trial in trials {
        let candidate = &candidates[trial.candidate];
        let usable = candidate.factorial && trial.worst().is_finite() && trial.worst() > 0.0;
        if usable && seen.insert(trial.candidate) {
            rows.push((candidate, trial.worst().ln(), trial.cpu_s.ln()));
        }
    }
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0usize), |(s, n), v| (s + v, n + 1));
        (sum / count.max(1) as f64, count)
    };
    let all_errors = mean(&mut rows.iter().map(|row| row.1)).0;
    let all_costs = mean(&mut rows.iter().map(|row| row.2)).0;
    let mut levels: Vec<&Setting> = Vec::new();
    for setting in rows.iter().flat_map(|row| &row.0.settings) {
        if !levels.contains(&setting) {
            levels.push(setting);
        }
    }
    levels.sort_by(|a, b| {
        a.knob.cmp(&b.knob).then(a.level.partial_cmp(&b.level).unwrap_or(std::cmp::Ordering::Equal))
    });
    // A knob with a single level has no effect.
    let varied = |knob: Knob| levels.iter().filter(|s| s.knob == knob).count() > 1;
    let effect = |setting: &&Setting| {
        let with = || rows.iter().filter(|row| row.0.settings.contains(setting));
        let (error, trials) = mean(&mut with().map(|row| row.1));
        let (cpu, _) = mean(&mut with().map(|row| row.2));
        MainEffect {
            knob: setting.knob,
            level: setting.level.clone(),
            error: (error - all_errors).exp(),
            cpu: (cpu - all_costs).exp(),
            trials,
        }
    };
    levels.iter().filter(|setting| varied(setting.knob)).map(effect).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn main_effects_of_a_product_are_its_factors() {
        let (dilations, cells) = ([1.5, 2.0], [1.0, 2.0]);
        let (mut candidates, mut trials) = (Vec::new(), Vec::new());
        for dilation in dilations {
            for cell in cells {
                trials.push(Trial {
                    candidate: candidates.len(),
                    factor: 1.0,
                    errors: vec![0.01 * dilation * cell],
                    cpu_s: dilation / cell,
                    failure: None,
                });
                let settings = vec![
                    Setting::number(Knob::Dilation, dilation),
                    Setting::number(Knob::CellsPerSpacing, cell),
                ];
                candidates.push(Candidate { settings, factorial: true });
            }
        }
        let effects = main_effects(&candidates, &trials);
        assert_eq!(effects.len(), 4);
        let ratio = |knob: Knob, of: fn(&MainEffect) -> f64| {
            let found: Vec<f64> = effects.iter().filter(|e| e.knob == knob).map(of).collect();
            found[1] / found[0]
        };
        approx::assert_relative_eq!(ratio(Knob::Dilation, |e| e.error), 4.0 / 3.0, epsilon = 1e-12);
        approx::assert_relative_eq!(
            ratio(Knob::CellsPerSpacing, |e| e.error),
            2.0,
            epsilon = 1e-12
        );
        approx::assert_relative_eq!(ratio(Knob::CellsPerSpacing, |e| e.cpu), 0.5, epsilon = 1e-12);
    }
}
