//! Expected cost of a recipe at the goal, from trials at other spacings, and the Pareto
//! front.

use super::trial::{Goal, Trial};
use mtled_checks::measure::log_log_fit;

/// Order of the error in the spacing where it cannot be fitted \[–\] (study
/// "manufactured": 1.5 to 2; bonded edges: 1).
const ORDER: f64 = 1.5;
/// Fitted orders are limited to this range \[–\].
const PLAUSIBLE: (f64, f64) = (0.7, 3.0);

/// The cost grows with the number of points and of steps, as h⁻ᵈ⁻¹.
fn cost_power(components: usize) -> f64 {
    components as f64 + 1.0
}

/// Order of the error of one candidate in the spacing.
pub(crate) fn order(trials: &[&Trial]) -> f64 {
    let samples: Vec<(f64, f64)> = trials
        .iter()
        .filter(|trial| trial.worst().is_finite())
        .map(|trial| (trial.factor, trial.worst()))
        .collect();
    match log_log_fit(&samples) {
        Some(fit) => fit.slope.clamp(PLAUSIBLE.0, PLAUSIBLE.1),
        None => ORDER,
    }
}

/// Score of a trial, smaller is better: for a target error the expected CPU time at it
/// \[s\], for a CPU budget the expected error \[–\]. Errors below `bar`, that of the reference
/// solution, count as `bar`.
pub(crate) fn expected(trial: &Trial, goal: Goal, order: f64, components: usize, bar: f64) -> f64 {
    let error = trial.worst().max(bar);
    let power = cost_power(components) / order;
    match goal {
        Goal::Error(target) => trial.cpu_s * (error / target).powf(power),
        Goal::Budget(cpu_s) => error * (trial.cpu_s / cpu_s).powf(1.0 / power),
    }
}

/// The spacing factor at which a trial's recipe is expected to meet the goal \[–\].
pub(crate) fn expected_factor(trial: &Trial, goal: Goal, order: f64, components: usize) -> f64 {
    match goal {
        Goal::Error(target) => trial.factor * (target / trial.worst()).powf(1.0 / order),
        Goal::Budget(cpu_s) => {
            trial.factor * (trial.cpu_s / cpu_s).powf(1.0 / cost_power(components))
        }
    }
}

/// The Pareto front, from cheap to expensive: no other trial is both cheaper and more
/// accurate.
pub(crate) fn front(trials: &[Trial]) -> Vec<&Trial> {
    let mut sorted: Vec<&Trial> = trials.iter().filter(|trial| trial.worst().is_finite()).collect();
    sorted.sort_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s).then(a.worst().total_cmp(&b.worst())));
    let mut best = f64::INFINITY;
    sorted.retain(|trial| {
        let better = trial.worst() < best;
        best = best.min(trial.worst());
        better
    });
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn trial(factor: f64, error: f64, cpu_s: f64) -> Trial {
        Trial { candidate: 0, factor, errors: vec![0.5 * error, error], cpu_s, failure: None }
    }

    #[test]
    fn the_cost_of_a_recipe_of_known_order_is_predicted() {
        // Error 0.04 h², cost h⁻⁴ s: 1 % at h = 0.5 for 16 s.
        let coarse = trial(1.0, 0.04, 1.0);
        let goal = Goal::Error(0.01);
        assert_relative_eq!(expected_factor(&coarse, goal, 2.0, 3), 0.5, epsilon = 1e-12);
        assert_relative_eq!(expected(&coarse, goal, 2.0, 3, 0.0), 16.0, epsilon = 1e-9);
        let budget = Goal::Budget(16.0);
        assert_relative_eq!(expected_factor(&coarse, budget, 2.0, 3), 0.5, epsilon = 1e-12);
        assert_relative_eq!(expected(&coarse, budget, 2.0, 3, 0.0), 0.01, epsilon = 1e-12);
        let both = [coarse, trial(0.5, 0.01, 16.0)];
        assert_relative_eq!(order(&both.iter().collect::<Vec<_>>()), 2.0, epsilon = 1e-9);
    }

    #[test]
    fn a_failed_trial_meets_no_goal_and_is_not_on_the_front() {
        let mut failed = trial(1.0, 0.01, 1.0);
        failed.failure = Some("inverted".into());
        assert_eq!(expected(&failed, Goal::Error(0.1), 2.0, 3, 0.0), f64::INFINITY);
        let all = [trial(1.0, 0.1, 1.0), failed, trial(1.0, 0.2, 2.0), trial(1.0, 0.05, 3.0)];
        let found: Vec<f64> = front(&all).iter().map(|trial| trial.cpu_s).collect();
        assert_eq!(found, [1.0, 3.0]);
    }
}
