//! Tables as CSV.

use super::table::{Cells, Table};
use ::csv::{QuoteStyle, WriterBuilder};
use anyhow::Result;
use mtled_checks::escape::csv_text;

/// A header and a line for each row (RFC 4180); an empty cell is nothing between commas.
/// Numbers have as many digits as tell them from every other. The header is in quotation marks:
/// DuckDB guesses from the first 20 480 rows whether there are any, and where the first came
/// later it took the comma in it for the end of a cell.
pub fn to_csv(table: &Table) -> Result<Vec<u8>> {
    let mut header = WriterBuilder::new().quote_style(QuoteStyle::Always).from_writer(Vec::new());
    header.write_record(table.columns.iter().map(|column| column.name))?;
    let mut writer = ::csv::Writer::from_writer(header.into_inner()?);
    for row in 0..table.rows {
        writer.write_record(table.columns.iter().map(|column| cell(&column.cells, row)))?;
    }
    Ok(writer.into_inner()?)
}

/// A number that need not be whole has a point or an exponent, so that a reader that guesses
/// the kind of a column from its first rows is right about the others.
fn cell(cells: &Cells, row: usize) -> String {
    let text = match cells {
        Cells::Text(texts) => texts[row].as_deref().map(csv_text),
        Cells::Count(counts) => counts[row].map(|count| count.to_string()),
        Cells::Number(numbers) => numbers[row].map(|number| format!("{number:?}")),
    };
    text.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore::records::Column;

    #[test]
    fn numbers_come_back_bit_for_bit_and_texts_as_they_were() {
        let numbers = [0.1 + 0.2, -1e-300, 5e22, 1.0, f64::MIN_POSITIVE, 1.0 / 3.0];
        let texts = ["a, b", "\"quoted\"", "2 µm", "", " x", "1e5"].map(String::from);
        let table = Table {
            columns: vec![
                Column { name: "value", cells: Cells::Number(numbers.map(Some).into()) },
                Column { name: "text", cells: Cells::Text(texts.clone().map(Some).into()) },
                Column { name: "none", cells: Cells::Count(vec![None; 6]) },
            ],
            rows: 6,
        };
        let written = to_csv(&table).unwrap();
        let mut reader = ::csv::Reader::from_reader(written.as_slice());
        assert!(written.starts_with(b"\"value\","));
        assert_eq!(reader.headers().unwrap(), ["value", "text", "none"].as_slice());
        let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
        for (row, (number, text)) in rows.iter().zip(numbers.iter().zip(&texts)) {
            assert_eq!(row[0].parse::<f64>().unwrap().to_bits(), number.to_bits());
            assert!(row[0].contains(['.', 'e']), "{}", &row[0]);
            assert_eq!((&row[1], &row[2]), (text.as_str(), ""));
        }
    }
}
