//! The audit of a run as JSON and as text.

use mtled::audit::{Audit, Figure, Row};
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use serde_json::{Value, json};

/// `audit` of `result.json`.
pub(crate) fn audit_json(audit: &Audit) -> Value {
    json!({
        "doubtful": audit.is_doubtful(),
        "rows": audit.rows.iter().map(row_json).collect::<Vec<_>>(),
    })
}

fn row_json(row: &Row) -> Value {
    let figure = |figure: &Figure| match figure {
        Figure::Number(value) => json!(value),
        Figure::Vector(value) => json!(<[f64; 3]>::from(*value)),
    };
    let mut json = json!({
        "what": row.kind.name(),
        "label": row.kind.label(),
        "of": row.of,
        "unit": row.kind.unit(),
        "asked": figure(&row.asked),
        "done": figure(&row.done),
        "difference": row.difference,
        "limit": row.limit,
        "doubtful": row.exceeds(),
    });
    if row.exceeds() {
        json["advice"] = json!(row.kind.advice());
    }
    json
}

/// The rows that are a reason to doubt the run, a sentence each.
pub fn audit_doubts(audit: &Audit) -> Vec<String> {
    audit.doubts().map(doubt).collect()
}

fn doubt(row: &Row) -> String {
    let figure = |figure: &Figure| match figure {
        Figure::Number(value) => four_digits(*value),
        Figure::Vector(value) => {
            format!("({})", <[f64; 3]>::from(*value).map(four_digits).join(", "))
        }
    };
    let of = match row.of.as_str() {
        "" => String::new(),
        name => format!(" \"{}\"", printable(name)),
    };
    format!(
        "doubtful: {}{of}: asked {}, done {} {}; the difference of {} is above its limit of {}: {}",
        row.kind.label(),
        figure(&row.asked),
        figure(&row.done),
        row.kind.unit(),
        four_digits(row.difference),
        four_digits(row.limit),
        row.kind.advice()
    )
}

/// A line that says how the audit ended.
pub(crate) fn audit_line(audit: &Audit) -> String {
    let (all, doubts) = (audit.rows.len(), audit.doubts().count());
    match doubts {
        0 => format!(
            "  audit: {all} comparisons of what was asked with what was done, all within their limits"
        ),
        _ => format!(
            "  audit: {doubts} of {all} comparisons of what was asked with what was done exceed their limits"
        ),
    }
}
