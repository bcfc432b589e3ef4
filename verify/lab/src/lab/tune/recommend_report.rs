//! One recipe for many cases as a report.

use super::recommend::{Recommendation, Row};
use mtled_checks::study::{Cell, Study, Table, number, text};

/// The report with the table over all cases.
pub fn recommendation_study(recommendation: &Recommendation, command: &str) -> Study {
    let mut study = Study {
        id: "tune-cases".into(),
        title: "One recipe for all cases".into(),
        claim: format!(
            "Recommended: {}. Expected cost of each recipe at the error of the case's own recipe, over \
             the cost of that recipe, case by case; the smallest median first.",
            recommendation.candidates[recommendation.chosen().candidate].label()
        ),
        command: command.to_string(),
        ..Study::default()
    };
    study.tables.push(table(recommendation));
    study.notes.push(
        "Each recipe is run at 1.6 and 1.25 times the spacing of the case, on one and two clouds, and \
         compared with the case's own recipe at the same spacing. Its cost at the same error is \
         extrapolated with one order for all recipes of a case, the median of their observed orders, \
         each limited to 0.7 to 3, and a cost that grows as h⁻ᵈ⁻¹. The means are geometric, over both \
         spacings and over the cases where the recipe does not fail."
            .into(),
    );
    study.notes.push(
        "Of the recipes with the fewest failures and a median within 10 % of the smallest, which is the \
         scatter of CPU times of the same work, the one with the smallest cost in its worst case is \
         recommended."
            .into(),
    );
    study.notes.extend(recommendation.skipped.iter().map(|skipped| format!("Left out: {skipped}")));
    study
}

/// A row per recipe, a column per case.
fn table(recommendation: &Recommendation) -> Table {
    let mut columns = vec![
        text("recipe"),
        number("mean over the cases", "1"),
        number("median", "1"),
        number("largest", "1"),
        number("failures", "1"),
    ];
    columns.extend(recommendation.cases.iter().map(|case| number(case, "1")));
    let row = |row: &Row| {
        let mut cells = vec![
            Cell::Text(recommendation.candidates[row.candidate].label()),
            Cell::Number(row.mean),
            Cell::Number(row.median),
            Cell::Number(row.worst),
            Cell::Number(row.failures as f64),
        ];
        cells.extend(row.ratios.iter().map(|ratio| match ratio {
            ratio if ratio.is_finite() => Cell::Number(*ratio),
            ratio if ratio.is_nan() => Cell::Text("–".into()),
            _ => Cell::Text("fails".into()),
        }));
        cells
    };
    Table {
        title: "Expected CPU time at equal error, over the case's own recipe".into(),
        columns,
        rows: recommendation.rows.iter().map(row).collect(),
    }
}
