//! Bounds of regression checks, which are stored in `reports/` and nowhere else.

mod missed_targets;

pub(crate) use missed_targets::is_missed;
#[cfg(test)]
pub(crate) use missed_targets::{MISSED, MISSED_IN_FULL};

use anyhow::{Context, Result};
use mtled_checks::gate::Baseline;
use mtled_checks::gate::baseline::Stored;
use mtled_checks::study::{Better, Bound, Kind};
use serde::Deserialize;
use std::collections::BTreeMap;

/// A figure that is stored without a bound has to lie between the stored one over this and times
/// this \[–\]: on the other families of clouds no figure of the suite moves by as much.
const FACTOR: f64 = 2.0;

/// A bound that only the full suite has, or has instead of that of the quick suite.
#[derive(Debug, Deserialize)]
struct FullBound {
    id: String,
    bound: Bound,
    reason: String,
}

/// Bounds of regression checks by their id: those of `reports/baseline.json`, in the full suite
/// also those of `reports/full_bounds.json`.
///
/// A bound is set by hand in the file, from the worst of 21 families of clouds (`--seed` 0 to 20)
/// and a margin: errors of fields times 1.05, imbalances and fluctuations of energy times 1.1,
/// drifts the mean and four standard deviations, orders less 0.05, ratios of errors times 0.95,
/// evaluations of the internal force times 1.02, iterations and 1, bytes per neighbour 8 per
/// component and 4 per index times 1.2. A figure that is stored without a bound has to stay
/// within [`FACTOR`], which is to be narrowed in the file. A check that is not stored is new:
/// nothing judges it, it does not pass, and `--update-baseline` takes it up.
#[derive(Debug)]
pub(crate) struct StoredBounds {
    /// Bounds and where they come from.
    bounds: BTreeMap<String, (Bound, String)>,
}

impl StoredBounds {
    /// Those of the quick suite, or of the full one.
    pub(crate) fn read(full_suite: bool) -> Result<StoredBounds> {
        let baseline: Baseline =
            serde_json::from_str(mtled_reports::BASELINE).context("reports/baseline.json")?;
        let full: Vec<FullBound> =
            serde_json::from_str(mtled_reports::FULL_BOUNDS).context("reports/full_bounds.json")?;
        let date = baseline.history.last().map_or("unknown date", |entry| &entry.date);
        let source = format!("our own figure of {date}, reports/baseline.json");
        let regressions = baseline.checks.iter().filter(|check| check.kind == Kind::Regression);
        let mut bounds: BTreeMap<_, _> =
            regressions.map(|check| (check.id.clone(), stored_bound(check, &source))).collect();
        if full_suite {
            bounds.extend(full.into_iter().map(|FullBound { id, bound, reason }| {
                (id, (bound, format!("our own figure, reports/full_bounds.json: {reason}")))
            }));
        }
        Ok(StoredBounds { bounds })
    }

    /// The bound of a check and where it comes from.
    pub(crate) fn bound(&self, id: &str) -> (Bound, String) {
        self.bounds
            .get(id)
            .cloned()
            .unwrap_or_else(|| (Bound::Baseline(Better::Neither), "no figure is stored yet".into()))
    }
}

/// The bound of a stored figure, and where it comes from.
fn stored_bound(check: &Stored, source: &str) -> (Bound, String) {
    match check.bound {
        Bound::Baseline(_) => {
            let ends = [check.value / FACTOR, check.value * FACTOR];
            let bound = Bound::Between(ends[0].min(ends[1]), ends[0].max(ends[1]));
            (bound, format!("{source}, within a factor of {FACTOR}: it has no bound of its own"))
        }
        bound => (bound, source.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_full_suite_has_bounds_of_its_own() {
        let [quick, full] = [false, true].map(|full| StoredBounds::read(full).unwrap());
        assert_eq!(quick.bound("hard_cases/far").0, Bound::AtMost(3.0));
        assert_eq!(full.bound("hard_cases/far").0, Bound::AtMost(4.0));
        assert!(full.bounds.len() > quick.bounds.len());
    }

    #[test]
    fn a_check_without_a_stored_figure_is_not_judged() {
        let (bound, source) = StoredBounds::read(false).unwrap().bound("no/such/check");
        let check = mtled_checks::study::Check::new;
        for value in [-1e300, 0.0, 1e300] {
            let check = check("no/such/check", "", Kind::Regression, value, bound, "1", &source);
            assert!(!check.passed() && !check.is_judged());
        }
    }

    #[test]
    fn every_stored_figure_has_a_bound_that_can_be_broken() {
        for full in [false, true] {
            for (id, (bound, _)) in StoredBounds::read(full).unwrap().bounds {
                let broken = [-1e300, 1e300].iter().any(|value| !bound.holds(*value));
                assert!(broken, "{id}: {bound:?}");
            }
        }
    }

    #[test]
    fn a_figure_stored_without_a_bound_stays_within_a_factor_of_two() {
        let stored: Stored = serde_json::from_str(
            r#"{"id":"a/b","value":-0.5,"unit":"1","kind":"regression",
            "bound":{"between":[-1.7976931348623157e308,1.7976931348623157e308]},
            "band":{"low":-0.5,"high":-0.5,"source":"theory"}}"#,
        )
        .unwrap();
        assert_eq!(stored.bound, Bound::Baseline(Better::Neither));
        assert_eq!(stored_bound(&stored, "").0, Bound::Between(-1.0, -0.25));
    }
}
