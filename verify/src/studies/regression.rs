//! Bounds of regression checks, which are stored in `reports/` and nowhere else.

use anyhow::{Context, Result};
use mtled_checks::gate::Baseline;
use mtled_checks::study::{Bound, Kind};
use serde::Deserialize;
use std::collections::BTreeMap;

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
/// component and 4 per index times 1.2. A check without a stored bound accepts every finite
/// value, so that `--update-baseline` stores it with that bound, to be narrowed in the file.
#[derive(Debug)]
pub struct StoredBounds {
    /// Bounds and where they come from.
    bounds: BTreeMap<String, (Bound, String)>,
}

impl StoredBounds {
    /// Those of the quick suite, or of the full one.
    pub fn read(full_suite: bool) -> Result<StoredBounds> {
        let baseline: Baseline =
            serde_json::from_str(mtled_reports::BASELINE).context("reports/baseline.json")?;
        let full: Vec<FullBound> =
            serde_json::from_str(mtled_reports::FULL_BOUNDS).context("reports/full_bounds.json")?;
        let date = baseline.history.last().map_or("unknown date", |entry| &entry.date);
        let source = format!("our own figure of {date}, reports/baseline.json");
        let regressions = baseline.checks.iter().filter(|check| check.kind == Kind::Regression);
        let mut bounds: BTreeMap<_, _> =
            regressions.map(|check| (check.id.clone(), (check.bound, source.clone()))).collect();
        if full_suite {
            bounds.extend(full.into_iter().map(|FullBound { id, bound, reason }| {
                (id, (bound, format!("our own figure, reports/full_bounds.json: {reason}")))
            }));
        }
        Ok(StoredBounds { bounds })
    }

    /// Whether a bound is stored for a check.
    pub fn contains(&self, id: &str) -> bool {
        self.bounds.contains_key(id)
    }

    /// The bound of a check and where it comes from.
    pub fn bound(&self, id: &str) -> (Bound, String) {
        self.bounds.get(id).cloned().unwrap_or_else(|| {
            let any = Bound::Between(f64::MIN, f64::MAX);
            (any, "no figure is stored yet: any finite value passes".into())
        })
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
    fn a_check_without_a_stored_bound_accepts_every_finite_value() {
        let (bound, source) = StoredBounds::read(false).unwrap().bound("no/such/check");
        assert!(bound.holds(-1e300) && bound.holds(1e300) && !bound.holds(f64::NAN), "{source}");
        assert!(!bound.holds(f64::INFINITY));
    }
}
