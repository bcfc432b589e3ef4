//! What all pages are made of: style, script, templates, tables.

use super::super::number::four_digits;
use crate::study::{Cell, Table};
use minijinja::{Environment, Value, context};

/// Texts with more bytes get a wide column.
const LONG: usize = 24;

/// Style of every page; that of figures is [`super::super::svg::STYLE`].
pub const STYLE: &str = include_str!("page/page.css");
/// Script of every page.
pub(crate) const SCRIPT: &str = include_str!("page/page.js");

/// The templates of all pages.
pub(crate) fn pages() -> anyhow::Result<Environment<'static>> {
    let mut pages = Environment::new();
    pages.add_template("shared.html", include_str!("page/shared.html"))?;
    pages.add_template("index.html", include_str!("page/index.html"))?;
    pages.add_template("compare.html", include_str!("page/compare.html"))?;
    pages.add_template("plain.html", include_str!("page/plain.html"))?;
    Ok(pages)
}

/// A table as a value of a template.
pub(crate) fn table_value(table: &Table) -> Value {
    let is_number =
        |index: usize| table.rows.iter().any(|row| matches!(row.get(index), Some(Cell::Number(_))));
    let columns: Vec<Value> = table
        .columns
        .iter()
        .enumerate()
        .map(|(index, column)| {
            let unit = if column.unit == "1" { "" } else { column.unit.as_str() };
            context! { name => column.name.as_str(), unit => unit, number => is_number(index) }
        })
        .collect();
    let rows: Vec<Value> = table
        .rows
        .iter()
        .map(|row| Value::from(row.iter().map(cell_value).collect::<Vec<_>>()))
        .collect();
    context! { title => table.title.as_str(), columns => columns, rows => rows }
}

fn cell_value(cell: &Cell) -> Value {
    match cell {
        // NaN in a table stands for a figure that does not exist.
        Cell::Number(number) if number.is_nan() => {
            context! { text => "–", key => "NaN", number => true }
        }
        Cell::Number(number) => {
            context! { text => four_digits(*number), key => number.to_string(), number => true }
        }
        Cell::Text(text) => {
            context! { text => text, key => text, number => false, long => text.len() > LONG }
        }
    }
}
