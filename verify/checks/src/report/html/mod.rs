//! One page for people that works offline, in print and on small screens.

mod figures;
mod plain;
mod template;

pub use plain::{Link, Page, Part, page_to_html};
pub use template::STYLE;
pub(super) use template::{SCRIPT, pages};

use super::change::{breakable, change_values, verdict_counts};
use super::labels::{counts, duration, plural, result_line, study_counts, unit_text};
use super::number::{bound_text, four_digits};
use super::svg;
use crate::escape::printable_lines;
use crate::study::{
    Bound, Change, Check, Comparison, Kind, Outcome, Provenance, Report, Study, Verdict,
};
use figures::{figure_value, leading_figures};
use minijinja::{Value, context};
use template::table_value;

/// The page as one file without links to other files.
pub(crate) fn to_html(report: &Report) -> anyhow::Result<String> {
    let studies: Vec<Value> = report.studies.iter().map(study_value).collect();
    let failures: Vec<Value> =
        report.checks().filter(|check| !check.pass).map(check_value).collect();
    let mut leading = leading_figures(report);
    let page = context! {
        style => Value::from_safe_string(format!("{STYLE}{}", svg::STYLE)),
        script => Value::from_safe_string(SCRIPT.to_string()),
        suite => report.suite.as_str(),
        outcome => class(report.outcome()),
        mark => mark(report.outcome()),
        failed => !report.bounds_hold(),
        open => report.studies.iter().any(|study| !study.questions().is_empty()),
        compared => report.comparison.as_ref().map(comparison_value),
        verdict => result_line(report),
        judged => report.checks().next().is_some(),
        kinds => kind_values(report),
        failures => failures,
        lead => leading.next().map(figure_value),
        pictures => leading.map(figure_value).collect::<Vec<_>>(),
        studies => studies,
        provenance => provenance_values(report),
        date => report.provenance.date.as_str(),
        version => report.provenance.version.as_str(),
        commit => report.provenance.commit.as_str(),
        wall => duration(report.wall_seconds),
        machine => machine(&report.provenance),
    };
    Ok(printable_lines(&pages()?.get_template("index.html")?.render(page)?))
}

/// Class of the elements that show an outcome.
fn class(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Passed => "pass",
        Outcome::Inconclusive => "open",
        Outcome::Failed | Outcome::CouldNotRun => "fail",
    }
}

/// Sign of an outcome.
fn mark(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Passed => "✓",
        Outcome::Inconclusive => "?",
        Outcome::Failed | Outcome::CouldNotRun => "✗",
    }
}

fn study_value(study: &Study) -> Value {
    let (passed, all) = study_counts(study);
    let below = study.figures.iter().skip(study.leading);
    let (passing, failing): (Vec<&Check>, Vec<&Check>) =
        study.checks.iter().partition(|check| check.passed());
    let values = |checks: Vec<&Check>| checks.into_iter().map(check_value).collect::<Vec<_>>();
    context! {
        id => study.id.as_str(),
        title => study.title.as_str(),
        claim => study.claim.as_str(),
        command => study.command.as_str(),
        failure => study.failure.as_deref(),
        outcome => class(study.outcome()),
        word => study.outcome().word(),
        undecided => study.questions().into_iter().map(Value::from).collect::<Vec<_>>(),
        counts => if all == 0 { "figures only".into() } else { format!("{passed} of {all}") },
        failing => values(failing),
        passing => values(passing),
        tables => study.tables.iter().map(table_value).collect::<Vec<_>>(),
        figures => below.map(figure_value).collect::<Vec<_>>(),
        notes => study.notes.iter().map(Value::from).collect::<Vec<_>>(),
        above => study.leading > 0 && !study.figures.is_empty(),
        wall => duration(study.wall_seconds),
        wall_key => study.wall_seconds.to_string(),
    }
}

fn check_value(check: &Check) -> Value {
    let limit = match check.bound {
        Bound::AtMost(limit) | Bound::AtLeast(limit) => limit,
        Bound::Between(low, high) => 0.5 * (low + high),
        Bound::Baseline(_) => f64::NAN,
    };
    context! {
        id => check.id.as_str(),
        breakable_id => breakable(&check.id),
        study => check.study.as_str(),
        quantity => check.quantity.as_str(),
        kind => check.kind.name(),
        value => four_digits(check.value),
        value_key => check.value.to_string(),
        bound => bound_text(&check.bound),
        bound_key => limit.to_string(),
        unit => unit_text(&check.unit),
        pass => check.pass,
        outcome => class(check.outcome()),
        word => check.outcome().word(),
        source => check.source.as_str(),
        file => check.failure_file().map(|file| Value::from_safe_string(svg::escape(&file))),
    }
}

fn comparison_value(comparison: &Comparison) -> Value {
    let (same, changes): (Vec<&Change>, Vec<&Change>) =
        comparison.changes.iter().partition(|change| change.verdict == Verdict::Same);
    context! {
        with => comparison.with.as_str(),
        summary => verdict_counts(comparison),
        holds => comparison.holds(),
        changes => change_values(&changes),
        same => change_values(&same),
    }
}

/// Passed and all checks of each kind, with what the kind means.
fn kind_values(report: &Report) -> Vec<Value> {
    let kinds = [
        (Kind::Exact, "closed forms and theorems"),
        (Kind::Reference, "published or finite-element values"),
        (Kind::Regression, "our own earlier figures"),
    ];
    kinds
        .into_iter()
        .filter(|(kind, _)| report.checks().any(|check| check.kind == *kind))
        .map(|(kind, meaning)| {
            let of_kind = report.checks().filter(|check| check.kind == kind);
            let (passed, all) = counts(of_kind.map(Check::passed));
            context! { name => kind.name(), meaning, passed, all, pass => passed == all }
        })
        .collect()
}

/// `AMD EPYC, 2 threads`.
pub(super) fn machine(p: &Provenance) -> String {
    format!("{}, {} {}", p.processor, p.threads, plural(p.threads, "thread", "threads"))
}

fn provenance_values(report: &Report) -> Vec<Value> {
    let p = &report.provenance;
    let rows = [
        ("Version", p.version.clone()),
        ("Commit", p.commit.clone()),
        ("Compiler", p.compiler.clone()),
        ("Processor", machine(p)),
        ("Features", p.processor_features.clone()),
        ("Date", p.date.clone()),
        ("Wall time", duration(report.wall_seconds)),
    ];
    let known = rows.into_iter().filter(|(_, value)| !value.is_empty());
    known.map(|(name, value)| context! { name, value }).collect()
}

#[cfg(test)]
mod tests;
