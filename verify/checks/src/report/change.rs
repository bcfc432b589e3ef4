//! How a comparison reads, in every kind of report.

use super::number::four_digits;
use super::svg::escape;
use super::words::unit_text;
use crate::study::{Band, BandSource, Change, Comparison, Verdict};
use minijinja::{Value, context};

pub(super) fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Worse => "worse",
        Verdict::Missing => "missing",
        Verdict::New => "new",
        Verdict::Improved => "improved",
        Verdict::Same => "same",
    }
}

/// `1 worse, 3 improved, 451 the same`.
pub(super) fn gate_words(comparison: &Comparison) -> String {
    let verdicts =
        [Verdict::Worse, Verdict::Missing, Verdict::New, Verdict::Improved, Verdict::Same];
    let told = verdicts.into_iter().filter_map(|verdict| {
        let count = comparison.count(verdict);
        let word = if verdict == Verdict::Same { "the same" } else { verdict_name(verdict) };
        (count > 0).then(|| format!("{count} {word}"))
    });
    let words = told.collect::<Vec<_>>().join(", ");
    if words.is_empty() { "nothing to compare".to_string() } else { words }
}

/// A figure, or a dash where there is none.
pub(super) fn figure_text(value: f64) -> String {
    if value.is_nan() { "–".to_string() } else { four_digits(value) }
}

/// `0.0101 mm → 0.0312 mm`.
pub(super) fn change_text(change: &Change) -> String {
    let unit = match unit_text(&change.unit) {
        "–" => String::new(),
        unit => format!(" {unit}"),
    };
    let written = |value: f64| match value.is_nan() {
        true => "nothing".to_string(),
        false => format!("{}{unit}", four_digits(value)),
    };
    format!("{} → {}", written(change.before), written(change.now))
}

/// Now over before; NaN where that says nothing.
pub(super) fn ratio(before: f64, now: f64) -> f64 {
    let ratio = now / before;
    if ratio.is_finite() { ratio } else { f64::NAN }
}

/// What counts as the same, and why.
pub(super) fn band_text(band: &Option<Band>) -> String {
    let Some(Band { low, high, source, spread }) = band else { return "–".to_string() };
    let source = match (source, spread) {
        (BandSource::Theory, _) => "theory".to_string(),
        (BandSource::Reference, _) => "error bar of the reference".to_string(),
        (BandSource::Scatter, Some(spread)) => format!("scatter of {} clouds", spread.samples),
        (BandSource::Scatter, None) => "scatter".to_string(),
    };
    format!("{} … {}: {source}", four_digits(*low), four_digits(*high))
}

/// An id that may be broken at its slashes.
pub(super) fn breakable(id: &str) -> Value {
    Value::from_safe_string(escape(id).replace('/', "/<wbr>"))
}

pub(super) fn change_values(changes: &[&Change]) -> Vec<Value> {
    changes.iter().map(|change| change_value(change)).collect()
}

fn change_value(change: &Change) -> Value {
    let ratio = ratio(change.before, change.now);
    context! {
        id => change.id.as_str(),
        breakable_id => breakable(&change.id),
        quantity => change.quantity.as_str(),
        verdict => verdict_name(change.verdict),
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
