//! Texts and values of a comparison that all kinds of report share.

use super::labels::{unit_suffix, unit_text};
use super::number::four_digits;
use super::svg::escape;
use crate::study::{Band, BandSource, Change, Comparison, Verdict};
use minijinja::{Value, context};

/// Number of checks by verdict: `1 worse, 3 improved, 451 the same`.
pub(super) fn verdict_counts(comparison: &Comparison) -> String {
    let counts = Verdict::ALL.into_iter().filter_map(|verdict| {
        let count = comparison.count(verdict);
        let name = if verdict == Verdict::Same { "the same" } else { verdict.name() };
        (count > 0).then(|| format!("{count} {name}"))
    });
    let text = counts.collect::<Vec<_>>().join(", ");
    if text.is_empty() { "nothing to compare".to_string() } else { text }
}

/// A figure, or a dash where there is none.
pub(super) fn figure_text(value: f64) -> String {
    if value.is_nan() { "–".to_string() } else { four_digits(value) }
}

/// `0.0101 mm → 0.0312 mm`.
pub(super) fn change_text(change: &Change) -> String {
    let unit = unit_suffix(&change.unit);
    let figure = |value: f64| {
        if value.is_nan() { "nothing".to_string() } else { format!("{}{unit}", four_digits(value)) }
    };
    format!("{} → {}", figure(change.before), figure(change.now))
}

/// Now over before; NaN where it is not finite.
pub(super) fn ratio(before: f64, now: f64) -> f64 {
    let ratio = now / before;
    if ratio.is_finite() { ratio } else { f64::NAN }
}

/// A further reason for the verdict behind a semicolon, if there is one.
pub(super) fn remark_text(change: &Change) -> String {
    change.remark.as_ref().map_or(String::new(), |remark| format!("; {remark}"))
}

/// What counts as the same, and why.
pub(super) fn band_text(band: &Option<Band>) -> String {
    let Some(Band { low, high, source, scatter }) = band else { return "–".to_string() };
    let source = match (source, scatter) {
        (BandSource::Theory, _) => "theory".to_string(),
        (BandSource::Reference, _) => "error bar of the reference".to_string(),
        (BandSource::Scatter, Some(scatter)) => format!("scatter of {} clouds", scatter.samples),
        (BandSource::Scatter, None) => "scatter".to_string(),
    };
    format!("{} … {}: {source}", four_digits(*low), four_digits(*high))
}

/// An id with line breaks allowed at its slashes.
pub(super) fn breakable(id: &str) -> Value {
    Value::from_safe_string(escape(id).replace('/', "/<wbr>"))
}

/// Changes as values of a template.
pub(super) fn change_values(changes: &[&Change]) -> Vec<Value> {
    changes.iter().map(|change| change_value(change)).collect()
}

fn change_value(change: &Change) -> Value {
    let ratio = ratio(change.before, change.now);
    context! {
        id => change.id.as_str(),
        breakable_id => breakable(&change.id),
        quantity => change.quantity.as_str(),
        verdict => change.verdict.name(),
        bad => matches!(change.verdict, Verdict::Worse | Verdict::Missing),
        before => figure_text(change.before),
        before_key => change.before.to_string(),
        now => figure_text(change.now),
        now_key => change.now.to_string(),
        ratio => figure_text(ratio),
        ratio_key => ratio.to_string(),
        unit => unit_text(&change.unit),
        band => band_text(&change.band),
        remark => change.remark.as_deref(),
    }
}
