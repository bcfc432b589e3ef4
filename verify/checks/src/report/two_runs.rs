//! Comparison of two runs, as a page and in Markdown.

use super::change::{change_values, figure_text, ratio, verdict_counts};
use super::html::{SCRIPT, STYLE, machine, pages};
use super::labels::counts;
use super::markdown_table::{cell, change_table};
use crate::escape::printable_lines;
use crate::study::{Change, Comparison, Report, Verdict};
use minijinja::{Value, context};
use std::fmt::Write;

/// The page of a comparison of `now` with `before`.
pub fn to_html(before: &Report, now: &Report, comparison: &Comparison) -> anyhow::Result<String> {
    let (same, changes): (Vec<&Change>, Vec<&Change>) =
        comparison.changes.iter().partition(|change| change.verdict == Verdict::Same);
    let page = context! {
        style => Value::from_safe_string(STYLE.to_string()),
        script => Value::from_safe_string(SCRIPT.to_string()),
        summary => verdict_counts(comparison),
        holds => comparison.holds(),
        provenance => provenance(before, now),
        changes => change_values(&changes),
        same => change_values(&same),
        times => time_values(before, now),
    };
    Ok(printable_lines(&pages()?.get_template("compare.html")?.render(page)?))
}

/// The same in Markdown.
pub fn to_markdown(before: &Report, now: &Report, comparison: &Comparison) -> String {
    let mut text = format!("## mtled, two runs: {}\n\n", verdict_counts(comparison));
    let _ = writeln!(text, "| | Before | Now |\n|---|---|---|");
    for (name, a, b) in rows(before, now) {
        let _ = writeln!(text, "| {name} | {} | {} |", cell(&a), cell(&b));
    }
    text.push('\n');
    change_table(&mut text, comparison.changes.iter());
    text.push_str("\n| Study | Before [s] | Now [s] | Ratio |\n|---|--:|--:|--:|\n");
    for (name, a, b) in times(before, now) {
        let (a, b, ratio) = (figure_text(a), figure_text(b), figure_text(ratio(a, b)));
        let _ = writeln!(text, "| {} | {a} | {b} | {ratio} |", cell(&name));
    }
    text
}

fn rows(before: &Report, now: &Report) -> Vec<(&'static str, String, String)> {
    let (a, b) = (&before.provenance, &now.provenance);
    vec![
        ("Suite", before.suite.clone(), now.suite.clone()),
        ("Version", a.version.clone(), b.version.clone()),
        ("Commit", a.commit.clone(), b.commit.clone()),
        ("Compiler", a.compiler.clone(), b.compiler.clone()),
        ("Machine", machine(a), machine(b)),
        ("Date", a.date.clone(), b.date.clone()),
        ("Checks passed", passed(before), passed(now)),
    ]
}

fn passed(report: &Report) -> String {
    let (passed, all) = counts(report.checks().map(|check| check.pass));
    format!("{passed} of {all}")
}

fn provenance(before: &Report, now: &Report) -> Vec<Value> {
    let value = |(name, before, now)| context! { name, before, now };
    rows(before, now).into_iter().map(value).collect()
}

/// Wall seconds of every study of either run and of the whole, NaN where it
/// was not run.
fn times(before: &Report, now: &Report) -> Vec<(String, f64, f64)> {
    let of = |report: &Report, id: &str| {
        let study = report.studies.iter().find(|study| study.id == id);
        study.map_or(f64::NAN, |study| study.wall_seconds)
    };
    let gone = before.studies.iter().filter(|old| now.studies.iter().all(|new| new.id != old.id));
    let mut times: Vec<(String, f64, f64)> = now
        .studies
        .iter()
        .chain(gone)
        .map(|study| (study.title.clone(), of(before, &study.id), of(now, &study.id)))
        .collect();
    times.push(("all".to_string(), before.wall_seconds, now.wall_seconds));
    times
}

fn time_values(before: &Report, now: &Report) -> Vec<Value> {
    let cell = |value: f64| {
        context! { text => figure_text(value), key => value.to_string() }
    };
    let row = |(name, a, b): (String, f64, f64)| {
        context! { name, cells => vec![cell(a), cell(b), cell(ratio(a, b))] }
    };
    times(before, now).into_iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn both_formats_show_old_and_new_value_ratio_verdict_and_times() {
        let now = sample::compared();
        let mut before = sample::report();
        before.studies.remove(0);
        let comparison = now.comparison.as_ref().unwrap();
        let html = to_html(&before, &now, comparison).unwrap();
        let markdown = to_markdown(&before, &now, comparison);
        for text in ["0.01010", "0.03120", "3.089", "worse", "its bound was loosened", "191.3"] {
            assert!(html.contains(text) && markdown.contains(text), "{text}\n{markdown}");
        }
        assert!(markdown.contains("| Affine patch test | – | 0.3420 | – |"), "{markdown}");
        assert!(!html.contains("href=\"http") && !html.contains("src="));
    }
}
