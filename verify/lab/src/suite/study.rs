//! What the runs of a case show: errors, answers, warnings and work.

use super::read::{Suite, SuiteCase};
use crate::lab::label::percent;
use crate::lab::store::{RunOutcome, RunRecord};
use mtled_case::reference::{Family, Quantity, is_dynamic, quantities};
use mtled_checks::report::four_digits;
use mtled_checks::study::{Better, Bound, Cell, Check, Kind, Study, Table, number, text};
use mtled_run::accuracy::{Difference, Group};
use std::collections::BTreeMap;

/// Changes of an answer below this part of the largest of its kind are no change: static
/// solutions are found to a tolerance \[–\].
const NO_CHANGE: f64 = 1e-6;
/// The axes of vectors.
const AXES: [&str; 3] = ["x", "y", "z"];
/// Where bounds of answers, warnings and work come from.
const BASELINE: &str = "our own earlier figure, by the band of the baseline";

/// The runs of a case on one cloud.
pub(crate) struct CaseRuns {
    pub solve: RunRecord,
    pub patch: Option<RunRecord>,
}

/// The study of a case on one cloud.
pub(crate) fn case_study(suite: &Suite, case: &SuiteCase, runs: &CaseRuns) -> Study {
    let (name, file) = (&case.source.name, suite.file.display());
    let mut study = Study {
        id: name.clone(),
        title: case.source.case.title.clone(),
        claim: claim(case),
        command: format!("mtled verify --suite {file} --only {name}"),
        failure: runs.solve.failure().map(String::from),
        wall_seconds: runs.solve.cpu_s() + runs.patch.as_ref().map_or(0.0, RunRecord::cpu_s),
        ..Study::default()
    };
    if let Some(reason) = runs.patch.as_ref().and_then(RunRecord::failure) {
        study.failure.get_or_insert_with(|| format!("the affine patch test: {reason}"));
    }
    if study.failure.is_some() {
        return study;
    }
    let values = runs.solve.values().unwrap_or_default();
    errors(&mut study, suite, case, values);
    answers(&mut study, case, values);
    soundness(&mut study, suite, case, runs);
    study
}

fn claim(case: &SuiteCase) -> String {
    let errors = match case.reference {
        Some(_) if !case.errors.is_empty() => "its errors keep their bounds",
        _ => "there is no error to judge",
    };
    format!("The case runs to its end, {errors}, and its answers, warnings and work are as before.")
}

fn id(case: &SuiteCase, rest: &str) -> String {
    format!("{}/{rest}", case.source.name)
}

/// Differences from the reference: a check where a bound is stated, else a row of the table.
fn errors(study: &mut Study, suite: &Suite, case: &SuiteCase, values: &[Vec<f64>]) {
    let Some(reference) = &case.reference else { return };
    let mut rows = Vec::new();
    for group in Group::ALL {
        let Some(error) = reference.difference(&case.source.case, group, values) else { continue };
        let bound = case.errors.get(&group);
        rows.push(vec![
            Cell::Text(group.label().into()),
            Cell::Number(error.rms),
            Cell::Number(error.max),
            Cell::Number(error.bar),
            Cell::Number(bound.copied().unwrap_or(f64::NAN)),
        ]);
        let Some(bound) = bound else { continue };
        study.checks.push(Check {
            reference_error: Some(error.bar),
            ..Check::new(
                &id(case, &format!("error/{}", group.name())),
                &format!(
                    "{}, rms difference from the reference over the largest value",
                    group.label()
                ),
                Kind::Reference,
                error.rms,
                Bound::AtMost(bound + error.bar),
                "1",
                &format!(
                    "{} of {}, and the reference's own error of {}: {}",
                    percent(*bound),
                    suite.file.display(),
                    percent(error.bar),
                    reference.source
                ),
            )
        });
        study.undecided.extend(undecided(group, error, *bound));
        study.undecided.extend(
            reference
                .disagreements(&case.source.case, group)
                .iter()
                .map(|disagreement| format!("{disagreement}: errors against it decide nothing")),
        );
    }
    study.tables.push(Table {
        title: format!("Errors against {}", reference.source),
        columns: vec![
            text("of"),
            number("error, rms over the largest value", "1"),
            number("error, largest", "1"),
            number("error of the reference", "1"),
            number("bound", "1"),
        ],
        rows,
    });
}

/// Where the error of the reference reaches over the bound on either side.
fn undecided(group: Group, error: Difference, bound: f64) -> Option<String> {
    let Difference { rms, bar, .. } = error;
    (rms - bar <= bound && rms + bar > bound).then(|| {
        format!(
            "the error of the {} is {} ± {}, and whether that keeps the bound of {} cannot be told: \
             a better reference is needed (mtled init --references --refine 3), or a wider bound",
            group.label(),
            percent(rms),
            percent(bar),
            percent(bound)
        )
    })
}

/// Every answer beside its earlier figure.
fn answers(study: &mut Study, case: &SuiteCase, values: &[Vec<f64>]) {
    let quantities = quantities(&case.source.case);
    let mut largest: BTreeMap<Family, f64> = BTreeMap::new();
    for (quantity, values) in quantities.iter().zip(values) {
        let entry = largest.entry(quantity.family).or_default();
        *entry = values.iter().fold(*entry, |largest, value| largest.max(value.abs()));
    }
    for (quantity, values) in quantities.iter().zip(values) {
        let least = NO_CHANGE * largest.get(&quantity.family).copied().unwrap_or(0.0);
        for (part, label, value) in parts(case, quantity, values) {
            study.checks.push(Check {
                reference_error: Some(least),
                ..Check::new(
                    &id(case, &part),
                    &label,
                    Kind::Regression,
                    value,
                    Bound::Baseline(Better::Neither),
                    quantity.family.unit(),
                    BASELINE,
                )
            });
        }
    }
}

/// Id, label and value of what is judged of a quantity: the components of a vector or a number,
/// of many positions the root mean square of the lengths, of a history that over its instants.
fn parts(case: &SuiteCase, quantity: &Quantity, values: &[f64]) -> Vec<(String, String, f64)> {
    let (name, components) = (&quantity.name, quantity.family.components());
    let rms = |squares: &mut dyn Iterator<Item = f64>, count: usize| {
        (squares.sum::<f64>() / count.max(1) as f64).sqrt()
    };
    if quantity.width > components {
        let square = |vector: &[f64]| vector.iter().map(|value| value * value).sum::<f64>();
        let lengths = &mut values.chunks(components).map(square);
        let value = rms(lengths, values.len() / components);
        return vec![(name.clone(), format!("{name}, rms length over its points"), value)];
    }
    let history = is_dynamic(&case.source.case) && quantity.changes;
    let shown = if components == 1 { 1 } else { case.source.case.problem.dimension.components() };
    let part = |component: usize| {
        let own = || values.iter().skip(component).step_by(components);
        let value = if history {
            rms(&mut own().map(|value| value * value), own().count())
        } else {
            own().next_back().copied().unwrap_or(f64::NAN)
        };
        let over = if history { ", rms over the instants" } else { "" };
        match components {
            1 => (name.clone(), format!("{name}{over}"), value),
            _ => {
                let axis = AXES[component];
                (format!("{name}/{axis}"), format!("{name}, {axis}{over}"), value)
            }
        }
    };
    // In a plane a moment has only its last component.
    match quantity.family {
        Family::Moment if shown == 2 => vec![part(2)],
        _ => (0..shown).map(part).collect(),
    }
}

/// A figure without unit that may not become larger than it was.
fn beside_baseline(id: &str, label: &str, value: f64) -> Check {
    let any = Bound::Baseline(Better::Lower);
    Check::new(id, label, Kind::Regression, value, any, "1", BASELINE)
}

/// Inverted points, the patch test, warnings and work.
fn soundness(study: &mut Study, suite: &Suite, case: &SuiteCase, runs: &CaseRuns) {
    if let Some(jacobian) = runs.solve.figure("smallest_jacobian") {
        study.checks.push(Check::new(
            &id(case, "smallest_jacobian"),
            "smallest J = det F of the quadrature points",
            Kind::Exact,
            jacobian,
            Bound::AtLeast(0.0),
            "1",
            "matter does not turn inside out",
        ));
    }
    let patch = |name: &str| runs.patch.as_ref().and_then(|patch| patch.figure(name));
    for (figure, part, what) in [
        ("patch_displacement_error", "patch/displacement", "displacement"),
        ("patch_gradient_error", "patch/gradient", "displacement gradient"),
    ] {
        let Some(error) = patch(figure) else { continue };
        let label = format!("affine patch test on this body: largest relative error of the {what}");
        study.checks.push(beside_baseline(&id(case, part), &label, error));
    }
    if let RunOutcome::Done { warnings, .. } = &runs.solve.outcome {
        let accepted = format!("accepted by {}", suite.file.display());
        let (count, most) = (warnings.len() as f64, Bound::AtMost(case.warnings as f64));
        study.checks.push(Check::new(
            &id(case, "warnings"),
            "warnings",
            Kind::Regression,
            count,
            most,
            "1",
            &accepted,
        ));
        study.notes.extend(warnings.iter().map(|warning| format!("Warning: {warning}")));
    }
    if let Some(work) = runs.solve.work() {
        let label = "neighbours visited by all evaluations of the force";
        study.checks.push(beside_baseline(&id(case, "work"), label, work.neighbour_visits as f64));
        study.notes.push(format!(
            "{} nodes, {} evaluations of the force, {} CPU s on one thread.",
            four_digits(runs.solve.figure("nodes").unwrap_or(f64::NAN)),
            work.force_evaluations,
            four_digits(runs.solve.cpu_s())
        ));
    }
}
