//! How errors and work of mtled itself have changed from commit to commit.

use super::super::results::is_date;
use super::super::run_tables::label;
use crate::lab::label::optional;
use anyhow::{Context, Result, bail};
use mtled_checks::input::read_text;
use mtled_checks::report::html::{Link, Page, Part};
use mtled_checks::study::{Cell, Column, Figure, Plot, Series, Table, axis, curve, number, text};
use std::collections::BTreeMap;
use std::path::Path;

/// First line of the file that `reports/history.py` writes.
const HEADER: &str = "date,commit,figure,value";
/// Figures that count the work of a run; the others are errors \[–\].
const WORK: &str = "work/";
/// Curves in a plot.
const CURVES: usize = 7;

/// Figures of mtled by commit.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// (date, commit), the oldest first.
    commits: Vec<(String, String)>,
    /// By name: (number of the commit from 0, value).
    figures: BTreeMap<String, Vec<(usize, f64)>>,
}

impl History {
    /// Reads the file of `reports/history.py`.
    pub fn read(path: &Path) -> Result<History> {
        let shown = path.display();
        let text = read_text(path).with_context(|| format!("cannot read the history {shown}"))?;
        let mut lines = text.lines();
        if lines.next() != Some(HEADER) {
            bail!("{shown}: line 1 is not `{HEADER}`");
        }
        let mut history = History { commits: Vec::new(), figures: BTreeMap::new() };
        for (n, line) in lines.enumerate() {
            let row: Vec<&str> = line.split(',').collect();
            let [date, commit, figure, value] = row[..] else {
                bail!("{shown}: line {} has {} columns instead of 4", n + 2, row.len());
            };
            let value: f64 = match value.parse() {
                Ok(value) if f64::is_finite(value) => value,
                _ => bail!("{shown}: line {}: `{value}` is not a number", n + 2),
            };
            if !is_date(date) {
                bail!("{shown}: line {}: `{date}` is not a day such as 2026-11-29", n + 2);
            }
            let commit = (date.to_string(), commit.to_string());
            if history.commits.last() != Some(&commit) {
                history.commits.push(commit);
            }
            let at = history.commits.len() - 1;
            history.figures.entry(figure.to_string()).or_default().push((at, value));
        }
        Ok(history)
    }

    /// The page.
    pub(crate) fn page(&self, back: Option<Link>) -> Page {
        let (work, errors): (Vec<_>, Vec<_>) =
            self.figures.iter().partition(|(name, _)| name.starts_with(WORK));
        let part = |title: &str, quantity: &str, figures: &[Named]| Part {
            title: title.into(),
            figures: figures.chunks(CURVES).map(|some| plot(title, quantity, some)).collect(),
            tables: vec![self.table(title, figures)],
            ..Part::default()
        };
        let row = |(n, (date, commit)): (usize, &(String, String))| {
            vec![Cell::Number((n + 1) as f64), label(date), label(commit)]
        };
        let commits = Table {
            title: "Commits that changed the accepted figures".into(),
            columns: vec![text("number"), text("date"), text("commit")],
            rows: self.commits.iter().enumerate().map(row).collect(),
        };
        Page {
            title: "mtled by commit".into(),
            back,
            lead: vec![
                "Errors against references and counters of work at every commit that changed the accepted figures \
                 (reports/baseline.json). The spacings of the cases stay the same."
                    .into(),
            ],
            parts: vec![
                part("Errors", "rms error over the largest value", &errors),
                part("Work", "count", &work),
                Part { title: "Commits".into(), tables: vec![commits], folded: true, ..Part::default() },
            ],
            foot: Vec::new(),
        }
    }

    /// First and last values.
    fn table(&self, title: &str, figures: &[Named]) -> Table {
        let row = |(name, values): &Named| {
            let (first, last) = (values.first().map(|v| v.1), values.last().map(|v| v.1));
            let ratio = first.zip(last).map(|(first, last)| last / first);
            vec![label(name.as_str()), optional(first), optional(last), optional(ratio)]
        };
        let columns: Vec<Column> =
            vec![text("figure"), number("first", "1"), number("last", "1"), number("ratio", "1")];
        Table {
            title: format!("{title}, first and last"),
            columns,
            rows: figures.iter().map(row).collect(),
        }
    }
}

type Named<'a> = (&'a String, &'a Vec<(usize, f64)>);

fn plot(title: &str, quantity: &str, figures: &[Named]) -> Figure {
    let series = |(n, (name, values)): (usize, &Named)| {
        let points = values.iter().map(|(at, value)| ((at + 1) as f64, *value)).collect();
        // The middle of `comparison/CASE/displacement` is the case.
        let short = name.split('/').nth(1).unwrap_or(name);
        Series { colour: Some(n), ..curve(short, points) }
    };
    Figure::Plot(Plot {
        title: title.into(),
        caption: "Over the number of the commit.".into(),
        x: axis("commit", "", false),
        y: axis(quantity, "1", true),
        series: figures.iter().enumerate().map(series).collect(),
        slopes: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_history_is_read_and_a_faulty_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            History::read(&path)
        };
        let sound = format!("{HEADER}\n2026-11-21,a,comparison/x/displacement,0.1\n");
        let history = read(&format!("{sound}2026-11-22,b,work/x/evaluations,3\n")).unwrap();
        assert_eq!((history.commits.len(), history.figures.len()), (2, 2));
        assert_eq!(history.page(None).parts.len(), 3);
        for (more, part) in [
            ("1,2,3\n", "line 3 has 3 columns"),
            ("1,2,3,x\n", "line 3: `x`"),
            ("1,2,3,4\n", "`1` is not a day"),
        ] {
            let error = read(&format!("{sound}{more}")).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
