//! Tables as Parquet files.
//!
//! The layout is that of <https://parquet.apache.org/docs/file-format/>: groups of rows, in
//! each one page per column with plain values, compressed by gzip; then where they are.

use super::compact::{Compact, varint};
use super::table::{Cells, Column, Table};
use anyhow::Result;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;
use std::ops::Range;

/// First and last bytes of a file.
const MAGIC: &[u8] = b"PAR1";
/// A reader holds one group in memory, and a page has less than 2³¹ bytes.
const ROWS_OF_A_GROUP: usize = 1 << 16;

// Numbers of the format.
const INT64: i32 = 2;
const DOUBLE: i32 = 5;
const BYTE_ARRAY: i32 = 6;
const OPTIONAL: i32 = 1;
const UTF8: i32 = 0;
const PLAIN: i32 = 0;
const RLE: i32 = 3;
const GZIP: i32 = 2;
const DATA_PAGE: i32 = 0;

/// Where the page of a column is.
struct Chunk {
    offset: usize,
    /// With the header of the page.
    length: usize,
    /// The same before compression.
    plain_length: usize,
}

/// The rows of a group and the page of each column.
struct Group {
    rows: usize,
    chunks: Vec<Chunk>,
}

/// The bytes of a file with the table.
pub fn to_parquet(table: &Table) -> Result<Vec<u8>> {
    let mut file = MAGIC.to_vec();
    let mut groups = Vec::new();
    for start in (0..table.rows).step_by(ROWS_OF_A_GROUP) {
        let rows = start..table.rows.min(start + ROWS_OF_A_GROUP);
        let chunks = table.columns.iter().map(|column| page(&mut file, &column.cells, &rows));
        groups.push(Group { chunks: chunks.collect::<Result<_>>()?, rows: rows.len() });
    }
    let footer = footer(table, &groups);
    file.extend(&footer);
    file.extend(u32::try_from(footer.len())?.to_le_bytes());
    file.extend(MAGIC);
    Ok(file)
}

/// Appends the page of some rows of a column.
fn page(file: &mut Vec<u8>, cells: &Cells, rows: &Range<usize>) -> Result<Chunk> {
    let (levels, values) = match cells {
        Cells::Text(texts) => contents(&texts[rows.clone()], |text, bytes| {
            bytes.extend((text.len() as u32).to_le_bytes());
            bytes.extend(text.as_bytes());
        }),
        Cells::Count(counts) => {
            contents(&counts[rows.clone()], |count, bytes| bytes.extend(count.to_le_bytes()))
        }
        Cells::Number(numbers) => {
            contents(&numbers[rows.clone()], |number, bytes| bytes.extend(number.to_le_bytes()))
        }
    };
    let plain = [&(levels.len() as u32).to_le_bytes(), levels.as_slice(), &values].concat();
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(&plain)?;
    let compressed = encoder.finish()?;
    let (plain_size, size) = (i32::try_from(plain.len())?, i32::try_from(compressed.len())?);
    let header = Compact::message(|header| {
        header.i32(1, DATA_PAGE);
        header.i32(2, plain_size);
        header.i32(3, size);
        header.structure(5, |page| {
            page.i32(1, rows.len() as i32);
            page.i32(2, PLAIN);
            page.i32(3, RLE);
            page.i32(4, RLE);
        });
    });
    let offset = file.len();
    file.extend(&header);
    file.extend(&compressed);
    let plain_length = header.len() + plain.len();
    Ok(Chunk { offset, length: file.len() - offset, plain_length })
}

/// Which cells are there, as runs of equal answers, and the values of those that are.
fn contents<T>(cells: &[Option<T>], write: impl Fn(&T, &mut Vec<u8>)) -> (Vec<u8>, Vec<u8>) {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    for run in cells.chunk_by(|a, b| a.is_some() == b.is_some()) {
        varint(&mut levels, (run.len() as u64) << 1);
        levels.push(u8::from(run[0].is_some()));
    }
    cells.iter().flatten().for_each(|value| write(value, &mut values));
    (levels, values)
}

fn kind(cells: &Cells) -> i32 {
    match cells {
        Cells::Text(_) => BYTE_ARRAY,
        Cells::Count(_) => INT64,
        Cells::Number(_) => DOUBLE,
    }
}

/// Names and kinds of the columns, and where their pages are.
fn footer(table: &Table, groups: &[Group]) -> Vec<u8> {
    // The first element is the root with its number of columns.
    let elements: Vec<Option<&Column>> =
        std::iter::once(None).chain(table.columns.iter().map(Some)).collect();
    Compact::message(|file| {
        file.i32(1, 1);
        file.structures(2, &elements, |element, column| match column {
            None => {
                element.text(4, "schema");
                element.i32(5, table.columns.len() as i32);
            }
            Some(column) => {
                element.i32(1, kind(&column.cells));
                element.i32(3, OPTIONAL);
                element.text(4, column.name);
                if let Cells::Text(_) = column.cells {
                    element.i32(6, UTF8);
                    element.structure(10, |logical| logical.structure(1, |_| {}));
                }
            }
        });
        file.i64(3, table.rows as i64);
        file.structures(4, groups, |group, of| {
            let total: usize = of.chunks.iter().map(|chunk| chunk.plain_length).sum();
            let columns: Vec<(&Column, &Chunk)> = table.columns.iter().zip(&of.chunks).collect();
            group.structures(1, &columns, |compact, (column, chunk)| {
                place(compact, column, chunk, of.rows);
            });
            group.i64(2, total as i64);
            group.i64(3, of.rows as i64);
        });
        file.text(6, concat!("mtled version ", env!("CARGO_PKG_VERSION")));
    })
}

/// What is known about a column in a group, and where it is.
fn place(compact: &mut Compact, column: &Column, chunk: &Chunk, rows: usize) {
    compact.i64(2, chunk.offset as i64);
    compact.structure(3, |about| {
        about.i32(1, kind(&column.cells));
        about.i32s(2, &[PLAIN, RLE]);
        about.texts(3, &[column.name]);
        about.i32(4, GZIP);
        about.i64(5, rows as i64);
        about.i64(6, chunk.plain_length as i64);
        about.i64(7, chunk.length as i64);
        about.i64(9, chunk.offset as i64);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::GzDecoder;
    use std::io::Read;

    #[test]
    fn a_page_has_what_is_there_and_which_cells_are() {
        let cells = Cells::Number(vec![None, Some(0.1), Some(-2.0), None, None]);
        let mut file = Vec::new();
        let chunk = page(&mut file, &cells, &(0..5)).unwrap();
        let start = file.windows(2).position(|pair| pair == [0x1f, 0x8b]).unwrap();
        assert_eq!((chunk.offset, chunk.length), (0, file.len()));
        let mut plain = Vec::new();
        GzDecoder::new(&file[start..]).read_to_end(&mut plain).unwrap();
        assert_eq!(chunk.plain_length, start + plain.len());
        assert_eq!(&plain[..10], [6, 0, 0, 0, 2, 0, 4, 1, 4, 0]);
        assert_eq!(plain[10..], [0.1f64.to_le_bytes(), (-2.0f64).to_le_bytes()].concat());
    }

    #[test]
    fn a_long_table_is_written_in_groups_that_say_where_they_are() {
        let rows = 2 * ROWS_OF_A_GROUP + 7;
        let cells = Cells::Count((0..rows as i64).map(Some).collect());
        let table = Table { columns: vec![Column { name: "row", cells }], rows };
        let file = to_parquet(&table).unwrap();
        assert!(file.starts_with(MAGIC) && file.ends_with(MAGIC));
        let pages = file.windows(3).filter(|bytes| *bytes == [0x1f, 0x8b, 8]).count();
        assert!(pages >= 3, "{pages}");
        let length = u32::from_le_bytes(file[file.len() - 8..][..4].try_into().unwrap());
        assert_eq!(file[file.len() - 8 - length as usize], 0x15);
    }
}
