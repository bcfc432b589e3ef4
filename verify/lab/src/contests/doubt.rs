//! What makes answers that keep to the protocol doubtful.

use super::outcome::SolverRun;
use mtled_case::protocol::Answered;
use mtled_case::reference::{Family, ReferenceValues};
use mtled_checks::report::four_digits;

/// Powers of ten that wrong units make.
const WRONG_UNITS: [i32; 4] = [-6, -3, 3, 6];
/// Largest deviation of a factor from such a power, relative \[–\].
const FACTOR: f64 = 0.1;
/// Smallest cosine between an answer and the reference for which a factor means something \[–\].
const COSINE: f64 = 0.98;
/// Answers are the same that differ by less than this over the largest value \[–\].
const SAME: f64 = 1e-7;
/// Processor time over that on the clock beyond which more than one thread ran \[–\]. Compilers of
/// kernels take a second one for a while, whose time is counted.
const THREADS: f64 = 2.0;
/// A claim is named where it differs by more than this from what was measured, relative \[–\] …
const CLAIM: f64 = 0.5;
/// … and by more than this \[s\].
const CLAIM_S: f64 = 0.2;

/// Why answers are doubtful.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Doubt {
    #[error(
        "wrong units? {family} is {factor} times the reference everywhere, close to 10^{power}"
    )]
    Units { family: &'static str, factor: String, power: i32 },
    #[error("the answer does not depend on the resolution")]
    SameAnswers,
    #[error("the displacement is 0 everywhere")]
    Nothing,
    #[error("the error is beyond all numbers")]
    Infinite,
    #[error("{threads} threads at once, where one was asked for")]
    Threads { threads: String },
    #[error("{apart} s of processor time are told apart, where {measured} s were measured")]
    Apart { apart: String, measured: String },
    #[error(
        "the unknowns do not grow with the resolution: {first} on level {coarse}, {last} on level {fine}"
    )]
    Unknowns { coarse: usize, first: u64, fine: usize, last: u64 },
}

/// Whether the values of a family are those of the reference times a power of ten. The factor is
/// that of the least squares.
pub(crate) fn wrong_units(answered: &Answered, reference: &[ReferenceValues]) -> Option<Doubt> {
    let families = [Family::Displacement, Family::Force, Family::Moment, Family::StrainEnergy];
    let names = ["the displacement", "the reaction", "the moment", "the strain energy"];
    families.into_iter().zip(names).find_map(|(family, name)| {
        let (computed, known) = both(answered, reference, |of| of == family);
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let size = product(&known, &known);
        let factor = product(&computed, &known) / size;
        let cosine = product(&computed, &known) / (size * product(&computed, &computed)).sqrt();
        let power = WRONG_UNITS
            .into_iter()
            .find(|power| (factor / 10f64.powi(*power) - 1.0).abs() < FACTOR && cosine > COSINE)?;
        Some(Doubt::Units { family: name, factor: four_digits(factor), power })
    })
}

/// Whether a series of runs from coarse to fine looks as if no system had been solved. Answers
/// that are the same are right where none `differs` from the reference.
pub(crate) fn about_series(
    runs: &[SolverRun],
    reference: &[ReferenceValues],
    differs: bool,
) -> Vec<Doubt> {
    let answered: Vec<(usize, &Answered)> =
        runs.iter().filter_map(|run| Some((run.level, run.outcome.answered()?))).collect();
    let [(coarse, first), .., (fine, last)] = answered[..] else { return Vec::new() };
    let mut doubts = Vec::new();
    let same = |pair: &[(usize, &Answered)]| {
        let [one, other] = [pair[0].1, pair[1].1].map(|answered| telling(answered, reference));
        let largest =
            |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
        let apart = largest(&mut one.iter().zip(&other).map(|(a, b)| a - b));
        apart <= SAME * largest(&mut one.iter().copied())
    };
    if differs && answered.windows(2).all(same) {
        doubts.push(Doubt::SameAnswers);
    }
    if last.unknowns <= first.unknowns {
        let (first, last) = (first.unknowns, last.unknowns);
        doubts.push(Doubt::Unknowns { coarse, first, fine, last });
    }
    doubts
}

/// Values of an answer in some families, and those of the reference.
fn both(
    answered: &Answered,
    reference: &[ReferenceValues],
    wanted: impl Fn(Family) -> bool,
) -> (Vec<f64>, Vec<f64>) {
    let (mut computed, mut known) = (Vec::new(), Vec::new());
    for (values, reference) in answered.values.iter().zip(reference) {
        if let Some(values) = values.as_ref().filter(|_| wanted(reference.quantity.family)) {
            computed.extend_from_slice(values);
            known.extend_from_slice(&reference.values);
        }
    }
    (computed, known)
}

/// The displacements of an answer; all its values where the case has no probes.
fn telling(answered: &Answered, reference: &[ReferenceValues]) -> Vec<f64> {
    let (moved, _) = both(answered, reference, |family| family == Family::Displacement);
    if moved.is_empty() { both(answered, reference, |_| true).0 } else { moved }
}

/// Whether a run answers that nothing moves; of a case without probes, that nothing happens.
pub(crate) fn is_nothing(run: &SolverRun, reference: &[ReferenceValues]) -> bool {
    let Some(answered) = run.outcome.answered() else { return false };
    telling(answered, reference).iter().all(|part| *part == 0.0)
}

/// Whether a run took more processor time than one thread can.
pub(crate) fn about_threads(run: &SolverRun) -> Option<Doubt> {
    let usage = run.usage?;
    let more = usage.cpu_s > THREADS * usage.wall_s + CLAIM_S;
    more.then(|| Doubt::Threads { threads: four_digits(usage.cpu_s / usage.wall_s) })
}

/// Whether a run tells more processor time apart than it has taken.
pub(crate) fn about_time_apart(run: &SolverRun) -> Option<Doubt> {
    let (apart, measured) = (run.apart_cpu_s()?, run.cpu_s()?);
    let possible = (0.0..=measured).contains(&apart);
    (!possible).then(|| Doubt::Apart { apart: four_digits(apart), measured: four_digits(measured) })
}

/// What a run claims and what was measured, where they differ strongly.
pub(crate) fn false_claim(run: &SolverRun) -> Option<String> {
    let (claimed, measured) = (run.outcome.answered()?.claimed_cpu_s?, run.cpu_s()?);
    let difference = (claimed - measured).abs();
    (difference > CLAIM * measured && difference > CLAIM_S).then(|| {
        format!(
            "claims {} s of CPU time where {} s were measured",
            four_digits(claimed),
            four_digits(measured)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contests::outcome::Outcome;
    use crate::contests::process::Usage;
    use mtled_case::protocol::SolverName;
    use mtled_case::reference::Quantity;

    fn answered(values: &[f64]) -> Answered {
        Answered {
            solver: SolverName { name: "s".into(), version: "1".into() },
            values: vec![Some(values.to_vec())],
            unknowns: 3,
            claimed_cpu_s: None,
            apart_cpu_s: None,
            claimed_memory_bytes: None,
            method: None,
        }
    }

    fn reference() -> Vec<ReferenceValues> {
        let quantity = Quantity {
            name: "displacement/p".into(),
            family: Family::Displacement,
            width: 3,
            changes: true,
        };
        let values = vec![0.01, -0.002, 0.0];
        vec![ReferenceValues { quantity, errors: vec![0.0; 3], error: 0.0, scale: 0.01, values }]
    }

    #[test]
    fn millimetres_are_noticed_also_where_the_answer_is_five_per_cent_off() {
        let doubt = wrong_units(&answered(&[10.5, -1.9, 0.1]), &reference()).unwrap();
        assert!(matches!(doubt, Doubt::Units { power: 3, .. }), "{doubt:?}");
        let doubt = wrong_units(&answered(&[1e-5, -2e-6, 0.0]), &reference()).unwrap();
        assert!(matches!(doubt, Doubt::Units { power: -3, .. }), "{doubt:?}");
    }

    #[test]
    fn answers_of_a_case_without_probes_are_judged_by_what_they_have() {
        let run = |level: usize, force: f64| SolverRun {
            level,
            spacing_m: 0.1,
            outcome: Outcome::Answered(Answered {
                unknowns: level as u64 + 1,
                ..answered(&[force, 0.0, 0.0])
            }),
            usage: None,
        };
        let mut reference = reference();
        reference[0].quantity.family = Family::Force;
        assert_eq!(about_series(&[run(0, 1.0), run(1, 1.1)], &reference, true), []);
        assert!(!is_nothing(&run(0, 1.0), &reference) && is_nothing(&run(0, 0.0), &reference));
        let same = about_series(&[run(0, 1.0), run(1, 1.0)], &reference, true);
        assert_eq!(same, [Doubt::SameAnswers]);
    }

    #[test]
    fn no_program_tells_more_time_apart_than_it_has_taken() {
        let run = |apart: f64| SolverRun {
            level: 0,
            spacing_m: 0.1,
            outcome: Outcome::Answered(Answered {
                apart_cpu_s: Some(apart),
                ..answered(&[1.0, 0.0, 0.0])
            }),
            usage: Some(Usage {
                cpu_s: 2.0,
                wall_s: 2.0,
                peak_memory_bytes: 2,
                least_memory_bytes: 1,
            }),
        };
        assert_eq!(about_time_apart(&run(1.9)), None);
        for apart in [2.1, -0.1] {
            assert!(matches!(about_time_apart(&run(apart)), Some(Doubt::Apart { .. })));
        }
    }

    #[test]
    fn an_answer_that_is_only_wrong_has_no_wrong_units() {
        for values in [[0.01, -0.002, 0.0], [0.0, 0.0, 0.0], [1.0, 10.0, -3.0], [0.1, -0.02, 0.0]] {
            assert_eq!(wrong_units(&answered(&values), &reference()), None, "{values:?}");
        }
    }
}
