//! Sensitivities as text and as JSON.

use super::measure::{Row, Sensitivities};
use comfy_table::{CellAlignment, ContentArrangement, presets};
use mtled_checks::escape::printable;
use mtled_checks::report::four_digits;
use serde_json::{Value, json};

/// Answers beside each other in a table.
const COLUMNS: usize = 4;

/// A table for every few answers.
pub fn to_text(found: &Sensitivities) -> String {
    let Sensitivities { case, answers, rows, .. } = found;
    let mut text = printable(&format!("{}: {}", case.name, case.title));
    text += "\n  change of each answer in per cent where a number grows by one per cent\n\n";
    for first in (0..answers.len()).step_by(COLUMNS) {
        let shown = first..(first + COLUMNS).min(answers.len());
        text += &format!("{}\n\n", table(found, shown));
    }
    if answers.is_empty() || rows.is_empty() {
        text += "  no answer of this case changes with a number of its file\n\n";
    }
    text + &notes(found)
}

fn notes(found: &Sensitivities) -> String {
    let mut text = String::new();
    if !found.without_effect.is_empty() {
        text += &format!("  without effect: {}\n", printable(&found.without_effect.join(", ")));
    }
    if !found.nothing.is_empty() {
        text += &format!("  0 up to round-off: {}\n", printable(&found.nothing.join(", ")));
    }
    format!(
        "{text}  CPU time: {:.2} s for the run, {:.2} s for {} answers and {} numbers\n",
        found.run_cpu_s,
        found.sensitivities_cpu_s,
        found.answers.len(),
        found.rows.len() + found.without_effect.len()
    )
}

fn table(found: &Sensitivities, shown: std::ops::Range<usize>) -> comfy_table::Table {
    let mut table = comfy_table::Table::new();
    table.load_style(presets::NOTHING);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    let checked = found.rows.iter().any(|row| row.by_solutions.is_some());
    let answers = &found.answers[shown.clone()];
    let mut header = vec!["number".to_string(), "value".to_string()];
    header.extend(answers.iter().map(|(name, ..)| printable(name)));
    header.extend(checked.then(|| "differences".to_string()));
    let columns = header.len();
    table.set_header(header);
    let mut values = vec!["value of the answer".to_string(), String::new()];
    values.extend(answers.iter().map(|(_, unit, value)| format!("{} {unit}", four_digits(*value))));
    table.add_row(values);
    for row in &found.rows {
        let mut cells = vec![printable(&row.number.key), four_digits(row.number.value)];
        cells.extend(row.relative[shown.clone()].iter().map(|size| signed(*size)));
        cells.extend(row.difference().map(|check| format!("{check:.0e}")));
        table.add_row(cells);
    }
    for column in table.column_iter_mut().take(columns).skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// All of it, with derivatives in the units of the case file.
pub fn to_json(found: &Sensitivities) -> Value {
    let answer = |(name, unit, value): &(String, &str, f64)| json!({ "name": name, "unit": unit, "value": value });
    let number = |row: &Row| {
        json!({
            "key": row.number.key,
            "value": row.number.value,
            "derivatives": row.derivatives,
            "per_cent_per_per_cent": row.relative,
            "by_solutions": row.by_solutions,
            "largest_difference": row.difference(),
        })
    };
    json!({
        "case": found.case.name,
        "problem_hash": found.case.problem_hash,
        "answers": found.answers.iter().map(answer).collect::<Vec<_>>(),
        "numbers": found.rows.iter().map(number).collect::<Vec<_>>(),
        "without_effect": found.without_effect,
        "answers_of_0": found.nothing,
        "doubtful": found.audit.is_doubtful(),
        "timings": { "run_cpu_s": found.run_cpu_s, "sensitivities_cpu_s": found.sensitivities_cpu_s },
    })
}

/// With three decimals; nothing is +0.
fn signed(size: f64) -> String {
    format!("{:+.3}", (1000.0 * size).round() / 1000.0 + 0.0)
}
