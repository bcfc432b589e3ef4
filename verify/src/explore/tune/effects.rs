//! What the answer is sensitive to.

use super::design::{Candidate, level_of};
use super::{Bench, Trial};
use crate::scene::{Knob, Level, Setting};
use anyhow::Result;
use mtled::problem::Motion;

/// Changes of a winner, one at a time: what may be said in words.
const CHANGES: &[(Knob, &str)] = &[
    (Knob::Basis, "quadratic"),
    (Knob::WeightFunction, "cubic_spline"),
    (Knob::WeightFunction, "exponential"),
    (Knob::Mass, "even_split"),
    (Knob::Gradients, "plain"),
    (Knob::VolumetricProjection, "none"),
    (Knob::Enforcement, "direct"),
];

/// The winner with one change each, on the same clouds; the candidates grow by them.
pub fn one_at_a_time(bench: &mut Bench, winner: &Trial) -> Result<Vec<Trial>> {
    let own = bench.candidates[winner.candidate].settings.clone();
    let recipe = &bench.wanted.source.case.problem.recipe;
    let candidate = &bench.candidates[winner.candidate];
    let dilation = level_of(candidate, Knob::Dilation).unwrap_or(recipe.dilation);
    let spacing = crate::studies::workbench::spacing_of(&bench.wanted.source.case.problem)?;
    let cells = level_of(candidate, Knob::CellsPerSpacing).unwrap_or(spacing / recipe.grid.cell);
    let round = |number: f64| (number * 1e3).round() / 1e3;
    let mut changes: Vec<Vec<Setting>> = Vec::new();
    for by in [-0.2, 0.2] {
        changes.push(vec![Setting::number(Knob::Dilation, round(dilation + by))]);
    }
    for by in [1.0 / 1.26, 1.26] {
        changes.push(vec![Setting::number(Knob::CellsPerSpacing, round(cells * by))]);
    }
    let moves = matches!(bench.wanted.source.case.problem.motion, Motion::Dynamic { .. });
    // Static solutions do not depend on how mass is spread.
    for (knob, level) in CHANGES.iter().filter(|(knob, _)| moves || *knob != Knob::Mass) {
        let mut change = vec![Setting::word(*knob, level)];
        if (*knob, *level) == (Knob::Basis, "quadratic") {
            change.push(Setting::number(Knob::Dilation, 2.6));
        }
        if !change.iter().all(|setting| own.contains(setting)) {
            changes.push(change);
        }
    }
    let mut points = Vec::new();
    for change in changes {
        let kept = own.iter().filter(|old| change.iter().all(|new| new.knob != old.knob));
        let settings = kept.cloned().chain(change.iter().cloned()).collect();
        points.push((bench.candidates.len(), winner.factor));
        bench.candidates.push(Candidate { settings, factorial: false });
    }
    for by in [1.0 / 1.1, 1.1] {
        points.push((winner.candidate, round(winner.factor * by)));
    }
    let clouds: Vec<u64> = (0..bench.wanted.clouds as u64).collect();
    bench.trials(&points, &clouds)
}

/// What a change of the winner is called: the settings in which it differs.
pub fn change_words(candidates: &[Candidate], winner: &Trial, change: &Trial) -> String {
    if change.candidate == winner.candidate {
        return format!("spacing x{:.3}", change.factor / winner.factor);
    }
    let own = &candidates[winner.candidate].settings;
    let changed = &candidates[change.candidate].settings;
    let added = changed.iter().filter(|setting| !own.contains(setting));
    let words: Vec<String> =
        added.map(|s| format!("{} {}", s.knob.name().replace('_', " "), s.level)).collect();
    words.join(", ")
}

/// The main effect of one level of the factorial: the mean over all that have it, over
/// the mean of all.
#[derive(Debug, Clone, PartialEq)]
pub struct MainEffect {
    pub knob: Knob,
    pub level: Level,
    /// Of the error, geometric \[–\].
    pub error: f64,
    /// Of the CPU time, geometric \[–\].
    pub cpu: f64,
    /// How many trials it is the mean of.
    pub trials: usize,
}

/// Main effects of the factorial in its first round; trials that failed are left out.
pub fn main_effects(candidates: &[Candidate], trials: &[Trial]) -> Vec<MainEffect> {
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
    // A knob with one level has no effect to tell.
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
