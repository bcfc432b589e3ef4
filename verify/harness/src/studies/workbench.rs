//! What every study is given: the suite, the family of clouds, the bundled cases and the stored
//! bounds of regression checks.

use crate::studies::regression::{StoredBounds, is_missed};
use anyhow::Result;
use mtled::problem::{Cloud, Problem};
use mtled_case::reference::{ReferenceError, ReferenceFile, read_reference};
use mtled_case::scene::{Case, one_error, read_case};
use mtled_checks::study::{Bound, Check, Kind};
use std::path::{Path, PathBuf};

/// How thorough the studies are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Suite {
    /// A few minutes.
    Quick,
    /// More clouds, finer ones, longer runs.
    Full,
}

impl Suite {
    /// As it is written on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Suite::Quick => "quick",
            Suite::Full => "full",
        }
    }
}

/// Distance between the random seeds of two families of clouds.
const SEEDS_PER_FAMILY: u64 = 1000;
/// Jitter of the lattices of bundled cases in other families \[spacing\].
const VARIATION: f64 = 0.02;

/// What every study is given.
#[derive(Debug)]
pub struct Workbench {
    /// How thorough the run is.
    pub suite: Suite,
    /// Family of clouds; 0 is the one that all stated figures belong to.
    family: u64,
    cases: PathBuf,
    bounds: StoredBounds,
}

impl Workbench {
    /// Unpacks the bundled cases into the output folder and reads the stored bounds.
    pub fn new(suite: Suite, family: u64, out: &Path) -> Result<Workbench> {
        let (cases, bounds) =
            (mtled_case::bundled::unpack(out)?, StoredBounds::read(suite == Suite::Full)?);
        Ok(Workbench { suite, family, cases, bounds })
    }

    /// Random seed of a cloud in this family, from its seed in family 0.
    pub(crate) fn seed(&self, seed: u64) -> u64 {
        seed + SEEDS_PER_FAMILY * self.family
    }

    /// Replaces the random seed of a jittered or graded cloud by that of this family.
    pub(crate) fn reseed(&self, problem: &mut Problem) {
        if let Cloud::Jittered { seed, .. } | Cloud::Graded { seed, .. } = &mut problem.recipe.cloud
        {
            *seed = self.seed(*seed);
        }
    }

    /// A bundled case; in another family than 0 its lattice is jittered by `VARIATION` of the
    /// spacing, or its graded cloud reseeded.
    pub(crate) fn case(&self, name: &str) -> Result<Case> {
        let mut case = self.unvaried_case(name)?;
        if self.family > 0 {
            if let Cloud::Regular { spacing } = case.problem.recipe.cloud {
                let (jitter, seed) = (VARIATION, 0);
                case.problem.recipe.cloud = Cloud::Jittered { spacing, jitter, seed };
            }
            self.reseed(&mut case.problem);
        }
        Ok(case)
    }

    /// A bundled case on the cloud of its file, in every family.
    pub(crate) fn unvaried_case(&self, name: &str) -> Result<Case> {
        read_case(&self.cases.join(format!("{name}.toml"))).map_err(one_error)
    }

    /// The bundled reference of a case.
    pub(crate) fn reference(&self, case: &Case) -> Result<ReferenceFile, ReferenceError> {
        let absent = || ReferenceError::Absent { case: case.name.clone() };
        let text = mtled_case::bundled::bundled_reference(&case.name).ok_or_else(absent)?;
        read_reference(case, text)
    }

    /// One of two values, by suite.
    pub(crate) fn pick<T>(&self, quick: T, full: T) -> T {
        match self.suite {
            Suite::Quick => quick,
            Suite::Full => full,
        }
    }

    /// A check of our own figure against its stored bound; `remark` is what else is known of it.
    /// See `StoredBounds` for a check that has none yet.
    pub(crate) fn regression(
        &self,
        id: &str,
        label: &str,
        value: f64,
        unit: &str,
        remark: &str,
    ) -> Check {
        let (bound, mut source) = self.bounds.bound(id);
        if !remark.is_empty() {
            source = format!("{source}; {remark}");
        }
        Check::new(id, label, Kind::Regression, value, bound, unit, &source)
    }

    /// A check of a target of theory or of our own, in units of 1. Where `is_missed` says that
    /// the target is known to be missed, and nowhere else, the check is a regression.
    pub(crate) fn target(
        &self,
        id: &str,
        label: &str,
        value: f64,
        target: Bound,
        source: &str,
    ) -> Check {
        if !is_missed(self.suite == Suite::Full, id) {
            return Check::new(id, label, Kind::Exact, value, target, "1", source);
        }
        let target = match target {
            Bound::AtMost(limit) => format!("at most {limit}"),
            Bound::AtLeast(limit) => format!("at least {limit}"),
            Bound::Between(low, high) => format!("{low} to {high}"),
            Bound::Baseline(_) => "that of the baseline".into(),
        };
        self.regression(
            id,
            label,
            value,
            "1",
            &format!("the target, {target}, is missed; {source}"),
        )
    }
}

/// A check of an exact claim: `value` \[–\] is at most `bound`.
pub(crate) fn exact(id: &str, label: &str, value: f64, bound: f64, source: &str) -> Check {
    Check::new(id, label, Kind::Exact, value, Bound::AtMost(bound), "1", source)
}

/// |computed − exact|/|exact| \[–\].
pub(crate) fn relative_error(computed: f64, exact: f64) -> f64 {
    (computed - exact).abs() / exact.abs()
}

/// Smallest and largest of positive values; NaN is skipped.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, 0.0), |(low, high), x| (low.min(x), high.max(x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::regression::{MISSED, MISSED_IN_FULL};

    #[test]
    fn a_missed_target_has_a_stored_bound_and_no_stored_bound_makes_another_target_a_regression() {
        let folder = tempfile::tempdir().unwrap();
        for suite in [Suite::Quick, Suite::Full] {
            let bench = Workbench::new(suite, 0, folder.path()).unwrap();
            let target = |id| bench.target(id, "", 1.0, Bound::AtMost(0.5), "theory");
            for id in MISSED {
                assert!(target(id).kind == Kind::Regression && target(id).is_judged(), "{id}");
            }
            // Its figure is stored as a regression, with a bound that 1 keeps.
            let other = target("hard_cases/far");
            assert!(other.kind == Kind::Exact && !other.pass, "{other:?}");
        }
        let full = Workbench::new(Suite::Full, 0, folder.path()).unwrap();
        for id in MISSED_IN_FULL {
            let check = full.target(id, "", 1.0, Bound::AtMost(0.5), "theory");
            assert!(check.kind == Kind::Regression && check.is_judged(), "{id}");
        }
    }
}
