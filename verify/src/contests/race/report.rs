//! The race as a study with figures and checks.

use super::challenge::Challenge;
use super::field::{CostOf, FamilyRuns, Field, RaceSettings, megabytes};
use super::finite_elements::FiniteElementCodes;
use super::notes::notes;
use super::race_run::{CODES, Code, RaceRun};
use super::tables::{equal_errors, runs_table, targets};
use mtled_checks::report::four_digits;
use mtled_checks::study::{Bound, Check, Figure, Kind, Plot, Study, axis, curve};

/// The study with its tables, figures, checks and notes.
pub fn study(settings: &RaceSettings, codes: &FiniteElementCodes, fields: &[Field]) -> Study {
    let mut study = Study {
        id: "race".into(),
        title: "Speed against error".into(),
        claim: "The same problems solved by mtled, FEniCSx and scikit-fem on this machine, one \
                thread each, in alternation: the CPU time and the memory that an error costs."
            .into(),
        command: "mtled study race".into(),
        ..Study::default()
    };
    if fields.iter().any(|field| field.challenge == Challenge::BondedBlock) {
        study.tables.push(targets(fields));
    }
    study.tables.push(equal_errors(fields));
    for field in fields {
        study.tables.push(runs_table(field));
        study.figures.push(figure(field, "CPU time", "s", |run| run.cpu_s));
        study.figures.push(figure(field, "peak memory", "MB", megabytes));
        study.checks.extend(checks(field));
    }
    study.leading = 1;
    study.notes = notes(settings, codes, fields);
    study
}

/// Families of a code that a figure shows, since it can distinguish eight curves: the first
/// one and those with the smallest products of error and cost.
fn shown(field: &Field, code: Code, cost: CostOf) -> Vec<FamilyRuns<'_>> {
    let count = if code == Code::ScikitFem { 2 } else { 3 };
    let mut all = field.families(code);
    let product = |runs: &[&RaceRun]| {
        runs.iter().map(|run| run.error * cost(run)).fold(f64::INFINITY, f64::min)
    };
    let others = all.get_mut(1..).unwrap_or_default();
    others.sort_by(|a, b| product(&a.1).total_cmp(&product(&b.1)));
    all.truncate(count);
    all
}

/// Error against a cost, with a curve per family.
fn figure(field: &Field, label: &str, unit: &str, cost: CostOf) -> Figure {
    let mut series = Vec::new();
    for code in CODES {
        for (name, runs) in shown(field, code, cost) {
            let points = runs.iter().map(|run| (cost(run), run.error)).collect();
            series.push(curve(&format!("{} {name}", field.title(code)), points));
        }
    }
    let error_unit = field.challenge.unit();
    let known = if field.uncertainty > 0.0 {
        format!(
            "Errors below the error bar of the reference, {} {error_unit}, are not significant.",
            four_digits(field.uncertainty)
        )
    } else {
        "The solution is known exactly.".to_string()
    };
    Figure::Plot(Plot {
        title: format!("{}: error against {label}", field.challenge.title()),
        caption: format!(
            "rms error of the displacement on a lattice over {label}, one thread; lower left is \
             better. Of each code the first family and the best ones; all are in the table. {known}"
        ),
        x: axis(label, unit, true),
        y: axis("rms error", error_unit, true),
        series,
        slopes: Vec::new(),
    })
}

/// Checks of figures that do not depend on the machine: the error of a recipe and its work.
fn checks(field: &Field) -> Vec<Check> {
    let newton = |run: &&RaceRun| run.family == "Newton to 1e-2" && run.per_edge == 8;
    let Some(run) = field.runs.iter().find(newton) else { return Vec::new() };
    let (error, visits) = field.challenge.earlier_figures();
    let visited = run.neighbour_visits.map_or(f64::NAN, |visits| visits as f64);
    let title = field.challenge.title();
    let check = |id: &str, label: &str, value: f64, earlier: f64, margin: f64, unit: &str| {
        Check::new(
            &format!("race/{}/{id}", field.challenge.name()),
            &format!("{title}: {label}, Newton's method with 8 spacings per edge"),
            Kind::Regression,
            value,
            Bound::AtMost((1.0 + margin) * earlier),
            unit,
            &format!("our own earlier figure, {}, with a margin of {margin}", four_digits(earlier)),
        )
    };
    vec![
        check("error", "rms error", run.error, error, 0.1, field.challenge.unit()),
        // An iteration more or less is no fault.
        check("work", "neighbour visits of the solution", visited, visits, 0.25, "1"),
    ]
}
