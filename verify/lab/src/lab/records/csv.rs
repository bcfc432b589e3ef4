//! Tables as CSV.

use ::csv::{QuoteStyle, WriterBuilder};
use anyhow::Result;
use mtled_checks::escape::csv_text;

/// A column of a table of such rows.
pub(crate) struct Column<R> {
    /// Its name, which ends with the unit where there is one.
    name: &'static str,
    cell: Box<dyn Fn(&R) -> String>,
}

impl<R> Column<R> {
    /// A column of texts; a cell may be empty, here and below.
    pub(crate) fn text(
        name: &'static str,
        cell: impl Fn(&R) -> Option<String> + 'static,
    ) -> Column<R> {
        Column::new(name, move |row| cell(row).map(|text| csv_text(&text)))
    }

    /// A column of whole numbers.
    pub(crate) fn count(
        name: &'static str,
        cell: impl Fn(&R) -> Option<i64> + 'static,
    ) -> Column<R> {
        Column::new(name, move |row| cell(row).map(|count| count.to_string()))
    }

    /// A column of numbers with as many digits as tell them from every other. One that need not
    /// be whole has a point or an exponent, so that a reader that guesses the kind of a column
    /// from its first rows is right about the others.
    pub(crate) fn number(
        name: &'static str,
        cell: impl Fn(&R) -> Option<f64> + 'static,
    ) -> Column<R> {
        Column::new(name, move |row| cell(row).map(|number| format!("{number:?}")))
    }

    fn new(name: &'static str, cell: impl Fn(&R) -> Option<String> + 'static) -> Column<R> {
        Column { name, cell: Box::new(move |row| cell(row).unwrap_or_default()) }
    }
}

/// A header and a line for each row (RFC 4180); an empty cell is nothing between commas.
/// The header is in quotation marks: DuckDB guesses from the first 20 480 rows whether there are
/// any, and where the first came later it took the comma in it for the end of a cell.
pub(crate) fn to_csv<R>(columns: &[Column<R>], rows: &[R]) -> Result<Vec<u8>> {
    let mut header = WriterBuilder::new().quote_style(QuoteStyle::Always).from_writer(Vec::new());
    header.write_record(columns.iter().map(|column| column.name))?;
    let mut writer = ::csv::Writer::from_writer(header.into_inner()?);
    for row in rows {
        writer.write_record(columns.iter().map(|column| (column.cell)(row)))?;
    }
    Ok(writer.into_inner()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_bit_for_bit_and_texts_as_they_were() {
        let numbers = [0.1 + 0.2, -1e-300, 5e22, 1.0, f64::MIN_POSITIVE, 1.0 / 3.0];
        let texts = ["a, b", "\"quoted\"", "2 µm", "", " x", "1e5"].map(String::from);
        let columns = [
            Column::number("value", |row: &(f64, String)| Some(row.0)),
            Column::text("text", |row: &(f64, String)| Some(row.1.clone())),
            Column::count("none", |_| None),
        ];
        let table: Vec<_> = numbers.into_iter().zip(texts).collect();
        let written = to_csv(&columns, &table).unwrap();
        let mut reader = ::csv::Reader::from_reader(written.as_slice());
        assert!(written.starts_with(b"\"value\","));
        assert_eq!(reader.headers().unwrap(), ["value", "text", "none"].as_slice());
        let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), table.len());
        for (row, (number, text)) in rows.iter().zip(&table) {
            assert_eq!(row[0].parse::<f64>().unwrap().to_bits(), number.to_bits());
            assert!(row[0].contains(['.', 'e']), "{}", &row[0]);
            assert_eq!((&row[1], &row[2]), (text.as_str(), ""));
        }
    }
}
