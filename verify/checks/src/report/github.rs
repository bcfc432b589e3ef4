//! Annotations and step summary of a job of GitHub Actions.

use super::change::{band_text, change_text, remark_text};
use super::labels::failure_text;
use crate::study::{Check, Report, Verdict};
use std::path::Path;

/// Largest size of a step summary \[bytes\].
pub const SUMMARY_LIMIT: usize = 1 << 20;

/// A workflow command per failed, worse or missing check, then per improved
/// one; `folder` is that of the report.
pub fn annotations(report: &Report, folder: &Path) -> Vec<String> {
    let mut lines = Vec::new();
    for study in &report.studies {
        if let Some(reason) = &study.failure {
            lines.push(command("error", &format!("{} could not run", study.id), reason));
        }
    }
    for study in &report.studies {
        let title = format!("{} is inconclusive", study.id);
        lines.extend(study.questions().iter().map(|question| command("warning", &title, question)));
    }
    for check in report.checks().filter(|check| !check.pass) {
        let title = format!("{} fails", check.id);
        lines.push(command("error", &title, &failure(report, check, folder)));
    }
    let kinds = [(Verdict::Worse, "error"), (Verdict::Missing, "error")];
    for (verdict, kind) in kinds.into_iter().chain([(Verdict::Improved, "notice")]) {
        for change in report.comparison.iter().flat_map(|comparison| comparison.of(verdict)) {
            let title = match verdict {
                Verdict::Improved => format!("{} improved", change.id),
                Verdict::Missing => format!("{} is missing", change.id),
                _ => format!("{} got {}", change.id, verdict.name()),
            };
            let (text, band) = (change_text(change), band_text(&change.band));
            let remark = remark_text(change);
            let message = format!("{text}; counts as the same: {band}{remark}");
            lines.push(command(kind, &title, &message));
        }
    }
    lines
}

/// The check that failed, by how much, and the case that reproduces it.
fn failure(report: &Report, check: &Check, folder: &Path) -> String {
    let mut text = failure_text(check);
    let study = report.studies.iter().find(|study| study.id == check.study);
    if let Some(study) = study.filter(|study| !study.claim.is_empty()) {
        text += &format!("\nbroken: {}", study.claim);
    }
    if let Some(file) = check.failure_file() {
        text += &format!("\nthe smallest case that shows it: {}", folder.join(file).display());
    }
    text
}

/// A workflow command; the percent sign is escaped first because it starts an escape.
fn command(kind: &str, title: &str, message: &str) -> String {
    let data = |text: &str| text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    let property = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    format!("::{kind} title={}::{}", property(title), data(message))
}

/// The summary in at most `limit` bytes: whole, else without the folded list of all
/// checks, else its first lines.
pub fn step_summary(report: &Report, limit: usize) -> String {
    let whole = super::markdown::to_markdown(report);
    if whole.len() <= limit {
        return whole;
    }
    let short = super::markdown::without_details(&whole);
    if short.len() <= limit {
        return short;
    }
    const CUT: &str = "\n(cut: the rest is in summary.md of the report)\n";
    let mut text = String::new();
    for line in short.lines() {
        if text.len() + line.len() + 1 + CUT.len() > limit {
            break;
        }
        text.push_str(line);
        text.push('\n');
    }
    if text.len() + CUT.len() <= limit { text + CUT } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn annotations_name_what_failed_and_what_got_worse_and_are_escaped() {
        let lines = annotations(&sample::compared(), Path::new("reports/verify"));
        let with = |text: &str| lines.iter().find(|line| line.contains(text)).unwrap();
        assert!(with("cook could not run").starts_with("::error title=cook could not run::"));
        let failed = with("brain/tumour/shift fails");
        assert!(failed.contains("is 0.03120 mm, must be ≤ 0.02 mm%0Abroken: Centres"), "{failed}");
        assert!(failed.ends_with("reports/verify/failures/brain-tumour-shift.toml"), "{failed}");
        assert!(with("got worse").contains("0.01010 mm → 0.03120 mm"));
        assert!(with("is missing").starts_with("::error"));
        assert!(with("improved").starts_with("::notice"));
        assert!(lines.iter().all(|line| !line.contains('\n')));
        let escaped = command("error", "a: b, c", "100 %\nnext");
        assert_eq!(escaped, "::error title=a%3A b%2C c::100 %25%0Anext");
    }

    #[test]
    fn a_summary_that_is_too_long_loses_its_details_first() {
        let report = sample::compared();
        let whole = step_summary(&report, SUMMARY_LIMIT);
        let short = step_summary(&report, whole.len() - 1);
        assert!(whole.contains("<details>") && !short.contains("<details>"));
        assert!(short.contains("mtled 0.1.0") && short.contains("got worse"), "{short}");
        let cut = step_summary(&report, 400);
        assert!(cut.len() <= 400 && cut.starts_with("## ❌ mtled quick"), "{cut}");
        assert!(cut.ends_with("of the report)\n"));
        assert_eq!(step_summary(&report, 3), "");
    }
}
