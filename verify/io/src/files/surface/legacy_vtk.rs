//! Faces of legacy VTK files of PolyData, as text or binary (big-endian).

use super::polygons::Polygons;
use crate::files::bytes::{ByteOrder, Scalar, take_line, take_numbers};
use crate::files::error::Mistake;

/// The faces of a file; what is attached to points and cells behind them is not read.
pub(crate) fn polygons(bytes: &[u8]) -> Result<Polygons, Mistake> {
    let mut file = File { rest: bytes, line: 0, binary: false };
    let mut found = Polygons::default();
    file.next_line();
    found.state_space(&file.next_line().unwrap_or_default())?;
    let encoding = file.word_line()?;
    file.binary = match encoding.to_uppercase().as_str() {
        "BINARY" => true,
        "ASCII" => false,
        _ => return Err(file.bad(&encoding, "`ASCII` or `BINARY`")),
    };
    let kind = file.word_line()?;
    if kind.to_uppercase().split_whitespace().collect::<Vec<_>>() != ["DATASET", "POLYDATA"] {
        let expected = "`DATASET POLYDATA`: extract the surface and save it as PolyData";
        return Err(file.bad(&kind, expected));
    }
    while let Some(line) = file.full_line() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["POINTS", count, kind] => {
                let (count, scalar) = file.array(count, kind, &line)?;
                let values = file.numbers(count.saturating_mul(3), scalar, "POINTS")?;
                found.points = values.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
            }
            ["VERTICES" | "LINES", first, second] => {
                found.lines += file.cells(first, second, &line)?.len();
            }
            ["POLYGONS", first, second] => {
                file.cells(first, second, &line)?.into_iter().for_each(|face| found.push(face));
            }
            ["TRIANGLE_STRIPS", first, second] => {
                file.cells(first, second, &line)?.iter().for_each(|strip| found.push_strip(strip));
            }
            ["FIELD", _, count] => file.fields(count, &line)?,
            ["METADATA"] => file.skip_metadata(),
            ["POINT_DATA" | "CELL_DATA", _] => break,
            _ => {
                let expected = "POINTS, POLYGONS, LINES, VERTICES, TRIANGLE_STRIPS or data";
                return Err(file.bad(&line, expected));
            }
        }
    }
    Ok(found)
}

/// What is left of a file.
struct File<'a> {
    rest: &'a [u8],
    /// Number of the last line; those within binary data do not count.
    line: usize,
    binary: bool,
}

impl File<'_> {
    fn next_line(&mut self) -> Option<String> {
        let line = take_line(&mut self.rest)?;
        self.line += 1;
        Some(line)
    }

    /// The next line that is not empty.
    fn full_line(&mut self) -> Option<String> {
        std::iter::from_fn(|| self.next_line()).find(|line| !line.is_empty())
    }

    fn word_line(&mut self) -> Result<String, Mistake> {
        let expected = "`ASCII` or `BINARY`, then `DATASET POLYDATA`";
        self.full_line().ok_or(Mistake::TextEnds { line: self.line, expected })
    }

    fn bad(&self, text: &str, expected: &'static str) -> Mistake {
        Mistake::bad_line(self.line, text, expected)
    }

    /// Number and type of the entries of an array.
    fn array(&self, count: &str, kind: &str, line: &str) -> Result<(usize, Scalar), Mistake> {
        let scalar = match kind.to_lowercase().as_str() {
            "char" => Scalar::I8,
            "unsigned_char" => Scalar::U8,
            "short" => Scalar::I16,
            "unsigned_short" => Scalar::U16,
            // VTK writes its own type of numbers of points as int.
            "int" | "vtkidtype" | "vtktypeint32" => Scalar::I32,
            "unsigned_int" => Scalar::U32,
            "long" | "vtktypeint64" => Scalar::I64,
            "unsigned_long" | "vtktypeuint64" => Scalar::U64,
            "float" => Scalar::F32,
            "double" => Scalar::F64,
            _ => return Err(self.bad(line, "a type such as float, double or int")),
        };
        let count = count.parse().map_err(|_| self.bad(line, "a whole number"))?;
        Ok((count, scalar))
    }

    /// The next numbers.
    fn numbers(
        &mut self,
        count: usize,
        scalar: Scalar,
        field: &'static str,
    ) -> Result<Vec<f64>, Mistake> {
        if self.binary {
            return take_numbers(&mut self.rest, count, scalar, ByteOrder::Big);
        }
        let mut values = Vec::new();
        while values.len() < count {
            let Some(word) = self.word() else {
                let (expected, found) = (count, values.len());
                return Err(Mistake::FewNumbers { field, expected, found });
            };
            let number = word.parse().map_err(|_| self.bad(&word, "a number"))?;
            values.push(number);
        }
        Ok(values)
    }

    /// The next word of a text.
    fn word(&mut self) -> Option<String> {
        let space = self.rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
        self.line += self.rest[..space].iter().filter(|b| **b == b'\n').count();
        self.rest = &self.rest[space..];
        let length = self.rest.iter().take_while(|b| !b.is_ascii_whitespace()).count();
        let word = String::from_utf8_lossy(&self.rest[..length]).to_string();
        self.rest = &self.rest[length..];
        (length > 0).then_some(word)
    }

    /// Cells as lists of a count and so many points, or, from version 5 on, as offsets and points.
    fn cells(&mut self, first: &str, second: &str, line: &str) -> Result<Vec<Vec<u32>>, Mistake> {
        let (first, _) = self.array(first, "int", line)?;
        let (size, _) = self.array(second, "int", line)?;
        if !self.rest.trim_ascii_start().starts_with(b"OFFSETS") {
            let numbers = self.numbers(size, Scalar::I32, "cells")?;
            return counted(first, &numbers);
        }
        let offsets = self.named("OFFSETS", first)?;
        let points = self.named("CONNECTIVITY", size)?;
        cells(offsets.get(1..).unwrap_or_default(), &points)
    }

    fn named(&mut self, name: &'static str, count: usize) -> Result<Vec<f64>, Mistake> {
        let line = self.full_line().ok_or(Mistake::MissingField { field: name })?;
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            [found, kind] if found == name => {
                let (_, scalar) = self.array("0", kind, &line)?;
                self.numbers(count, scalar, name)
            }
            _ => Err(self.bad(&line, "OFFSETS and CONNECTIVITY, each with its type")),
        }
    }

    /// Reads past arrays of a field: name, components, number, type, and their numbers.
    fn fields(&mut self, count: &str, line: &str) -> Result<(), Mistake> {
        let (count, _) = self.array(count, "int", line)?;
        for _ in 0..count {
            let line = self.full_line().ok_or(Mistake::MissingField { field: "FIELD" })?;
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                ["METADATA"] => self.skip_metadata(),
                [_, components, tuples, "string"] => {
                    let (components, _) = self.array(components, "int", &line)?;
                    let (tuples, _) = self.array(tuples, "int", &line)?;
                    for _ in 0..components.saturating_mul(tuples) {
                        self.skip_string().ok_or(Mistake::MissingField { field: "FIELD" })?;
                    }
                }
                [_, components, tuples, kind] => {
                    let (components, scalar) = self.array(components, kind, &line)?;
                    let (tuples, _) = self.array(tuples, kind, &line)?;
                    self.numbers(components.saturating_mul(tuples), scalar, "FIELD")?;
                }
                _ => return Err(self.bad(&line, "name, components, number and type")),
            }
        }
        Ok(())
    }

    /// Reads past a text: a line, or bytes behind their number, whose first two bits say how many
    /// bytes it has.
    fn skip_string(&mut self) -> Option<()> {
        if !self.binary {
            return self.next_line().map(drop);
        }
        let bytes = [8, 4, 2, 1][usize::from(self.rest.first()? >> 6)];
        let (head, rest) = self.rest.split_at_checked(bytes)?;
        let whole = head.iter().fold(0u64, |sum, byte| sum << 8 | u64::from(*byte));
        let length = whole & (u64::MAX >> (66 - 8 * bytes as u32));
        self.rest = rest.get(usize::try_from(length).ok()?..)?;
        Some(())
    }

    /// Lines up to an empty one.
    fn skip_metadata(&mut self) {
        while self.next_line().is_some_and(|line| !line.is_empty()) {}
    }
}

/// Cells of a count and so many points each.
fn counted(count: usize, numbers: &[f64]) -> Result<Vec<Vec<u32>>, Mistake> {
    let (mut rest, mut found) = (numbers, Vec::new());
    for _ in 0..count {
        let part = rest.split_first().and_then(|(corners, behind)| {
            let corners = Some(*corners).filter(|n| *n >= 0.0 && *n <= behind.len() as f64)?;
            Some(behind.split_at(corners as usize))
        });
        let (corners, behind) = part.ok_or(Mistake::bad_cells("counts"))?;
        found.push(points_of(corners)?);
        rest = behind;
    }
    if rest.is_empty() { Ok(found) } else { Err(Mistake::bad_cells("counts")) }
}

/// Cells whose points end at these offsets.
pub(super) fn cells(ends: &[f64], points: &[f64]) -> Result<Vec<Vec<u32>>, Mistake> {
    let (mut first, mut found) = (0, Vec::new());
    for end in ends {
        let end = *end as usize;
        let corners = points.get(first..end).ok_or(Mistake::bad_cells("offsets"))?;
        found.push(points_of(corners)?);
        first = end;
    }
    if first == points.len() { Ok(found) } else { Err(Mistake::bad_cells("offsets")) }
}

fn points_of(corners: &[f64]) -> Result<Vec<u32>, Mistake> {
    let is_number = |n: &f64| n.fract() == 0.0 && (0.0..f64::from(u32::MAX)).contains(n);
    match corners.iter().find(|n| !is_number(n)) {
        Some(other) => {
            let expected = "numbers of points, counted from 0";
            Err(Mistake::bad_field("connectivity", &other.to_string(), expected))
        }
        None => Ok(corners.iter().map(|n| *n as u32).collect()),
    }
}
