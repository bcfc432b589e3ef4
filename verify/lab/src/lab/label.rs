//! Labels of settings and numbers in tables and messages.

use mtled_case::scene::{Knob, Setting};
use mtled_checks::study::Cell;

/// Label of a knob that a run does not change.
pub(crate) const AS_IN_CASE: &str = "as in the case";

/// Name of a knob, such as "weight function".
pub(crate) fn knob_label(knob: Knob) -> String {
    knob.name().replace('_', " ")
}

/// Knobs and their levels, separated by commas.
pub(crate) fn settings_label<'a>(settings: impl Iterator<Item = &'a Setting>) -> String {
    let labels = settings.map(|setting| format!("{} {}", knob_label(setting.knob), setting.level));
    labels.collect::<Vec<_>>().join(", ")
}

/// A number, or a dash where there is none.
pub(crate) fn optional(value: Option<f64>) -> Cell {
    value.map_or(Cell::Text("–".into()), Cell::Number)
}

/// A fraction in per cent with three digits, without powers of ten.
pub fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    match percent.abs() {
        size if !size.is_finite() => "–".into(),
        0.0 => "0 %".into(),
        size if size < 1e-3 => "< 0.001 %".into(),
        size => {
            let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
            format!("{percent:.decimals$} %")
        }
    }
}
