//! Tables of the published problems.

use super::numbers::Number;
use super::runs::Solved;
use mtled_checks::study::{Cell, Table, number, text};

/// One published number beside one run.
pub(crate) struct Row {
    pub problem: String,
    pub case: String,
    pub spacing: f64,
    pub nodes: usize,
    /// Whether the spacing is that of the case file.
    pub is_own: bool,
    /// Ours, or why there is none.
    pub ours: Result<f64, String>,
    /// Our own error bar, or words.
    pub bar: String,
}

impl Row {
    /// |ours − published| over the scale \[–\], where there is an answer.
    pub fn difference(&self, number: &Number) -> Option<f64> {
        self.ours.as_ref().ok().map(|ours| number.difference(*ours))
    }

    fn verdict(&self, number: &Number) -> String {
        match &self.ours {
            Err(reason) => format!("no answer: {reason}"),
            Ok(ours) if number.difference(*ours) <= number.bound() => "met".into(),
            Ok(_) => "missed".into(),
        }
    }
}

/// A number, or a dash where there is none.
fn known(value: Option<f64>) -> Cell {
    value.map_or_else(|| Cell::Text("–".into()), Cell::Number)
}

/// Every number beside every run.
pub(crate) fn numbers_table(rows: &[(Row, &Number)]) -> Table {
    let line = |(row, number): &(Row, &Number)| {
        vec![
            Cell::Text(row.problem.clone()),
            Cell::Text(row.case.clone()),
            Cell::Text(number.name.clone()),
            Cell::Number(number.value),
            Cell::Number(number.spread),
            Cell::Text(number.unit.clone()),
            Cell::Text(number.by.words().into()),
            Cell::Number(row.spacing),
            Cell::Number(row.nodes as f64),
            known(row.ours.as_ref().ok().copied()),
            Cell::Text(row.bar.clone()),
            known(row.difference(number).map(|difference| 100.0 * difference)),
            Cell::Number(100.0 * number.bound()),
            Cell::Text(row.verdict(number)),
        ]
    };
    Table {
        title: "Published numbers beside ours".into(),
        columns: vec![
            text("problem"),
            text("case"),
            text("number"),
            number("published", ""),
            number("±", ""),
            text("unit"),
            text("by"),
            number("spacing", "m"),
            number("nodes", ""),
            number("ours", ""),
            text("our error bar"),
            number("difference", "%"),
            number("bound", "%"),
            text("verdict"),
        ],
        rows: rows.iter().map(line).collect(),
    }
}

/// Where the numbers come from.
pub(crate) fn sources_table(rows: &[(Row, &Number)]) -> Table {
    let line = |(row, number): &(Row, &Number)| {
        let cell = |text: &str| Cell::Text(text.into());
        vec![
            cell(&row.problem),
            cell(&row.case),
            cell(&number.name),
            cell(number.by.words()),
            cell(&number.source),
            cell(&number.licence),
        ]
    };
    Table {
        title: "Sources of the numbers".into(),
        columns: ["problem", "case", "number", "by", "source", "licence of the data"]
            .map(text)
            .into(),
        rows: rows.iter().filter(|(row, _)| row.is_own).map(line).collect(),
    }
}

/// What every run costs.
pub(crate) fn costs_table(runs: &[Solved]) -> Table {
    let line = |run: &Solved| {
        vec![
            Cell::Text(run.problem.clone()),
            Cell::Text(run.case.name.clone()),
            Cell::Number(run.spacing),
            Cell::Number(run.nodes as f64),
            Cell::Number(run.cpu),
            Cell::Text(run.remark()),
        ]
    };
    Table {
        title: "Cost of the runs on one thread, set-up included".into(),
        columns: vec![
            text("problem"),
            text("case"),
            number("spacing", "m"),
            number("nodes", ""),
            number("CPU time", "s"),
            text("what the run says"),
        ],
        rows: runs.iter().map(line).collect(),
    }
}
