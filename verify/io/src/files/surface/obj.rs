//! Faces of Wavefront OBJ files, of all objects and groups.

use super::polygons::Polygons;
use crate::files::error::{Mistake, shown};
use std::borrow::Cow;

/// Keywords that say nothing about the shape of faces.
const OTHERS: [&str; 20] = [
    "vt",
    "vn",
    "vp",
    "g",
    "o",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "vc",
];
/// Keywords of curved surfaces, which have no polygons.
const CURVED: [&str; 11] =
    ["cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "con"];

/// The faces of a text.
pub(crate) fn polygons(bytes: &[u8]) -> Result<Polygons, Mistake> {
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    let mut reader = Reader::default();
    let mut lines = (1..).zip(text.split(['\n', '\r']));
    while let Some((number, line)) = lines.next() {
        let mut line = Cow::Borrowed(line);
        // A line that ends with a backslash goes on in the next one.
        while let Some(start) = line.strip_suffix('\\') {
            let next = lines.next().map_or("", |(_, next)| next);
            line = Cow::Owned(format!("{start} {next}"));
        }
        reader.line(number, &line)?;
    }
    reader.finished()
}

#[derive(Default)]
struct Reader {
    found: Polygons,
    /// Line, text and number of the point of corners whose point comes later, or never.
    later: Vec<(usize, String, u64)>,
}

impl Reader {
    fn line(&mut self, number: usize, line: &str) -> Result<(), Mistake> {
        let (content, comment) = line.split_once('#').unwrap_or((line, ""));
        self.found.state_space(comment)?;
        let bad = |expected| Mistake::bad_line(number, line, expected);
        let mut words = content.split_whitespace();
        match words.next() {
            None => {}
            Some("v") => {
                let point = point(words).ok_or_else(|| {
                    bad("`v` and three numbers, behind them nothing, the weight 1 or a colour")
                })?;
                self.found.points.push(point);
            }
            Some("f" | "fo") => {
                let corners: Vec<&str> = words.collect();
                if corners.len() < 3 {
                    return Err(bad("`f` and at least three corners"));
                }
                let corners = corners.iter().map(|corner| self.corner(corner, number, line));
                let corners: Vec<u32> = corners.collect::<Result<_, _>>()?;
                self.found.push(corners);
            }
            Some("l" | "p") => self.found.lines += 1,
            Some(word) if OTHERS.contains(&word) => {}
            Some(word) if CURVED.contains(&word) => {
                return Err(bad(
                    "faces (`f`): curved surfaces must be cut into polygons where they come from",
                ));
            }
            Some(_) => return Err(bad("a line of an OBJ file, such as `v`, `f` or `g`")),
        }
        Ok(())
    }

    /// The point of a corner such as `3`, `3/1`, `3//2`, `3/1/2`; −1 is the last one so far.
    fn corner(&mut self, word: &str, number: usize, line: &str) -> Result<u32, Mistake> {
        let expected = "`f` and corners such as 3, 3/1 or 3//2, counted from 1, or back from -1";
        let bad = || Mistake::bad_line(number, line, expected);
        let mut parts = word.split('/');
        let index: i64 = parts.next().and_then(|part| part.parse().ok()).ok_or_else(bad)?;
        let is_index = |part: &str| part.is_empty() || part.parse::<i64>().is_ok();
        if !parts.all(is_index) || word.split('/').count() > 3 {
            return Err(bad());
        }
        let count = self.found.points.len() as i64;
        let point = if index < 0 { count.checked_add(index) } else { index.checked_sub(1) };
        let point = point.and_then(|point| u32::try_from(point).ok()).ok_or_else(bad)?;
        if i64::from(point) >= count {
            self.later.push((number, line.to_string(), u64::from(point) + 1));
        }
        Ok(point)
    }

    fn finished(self) -> Result<Polygons, Mistake> {
        let count = self.found.points.len();
        match self.later.into_iter().find(|(.., point)| *point > count as u64) {
            Some((line, text, point)) => {
                let text = shown(&text);
                Err(Mistake::LineWithoutPoint { line, text, point, count })
            }
            None => Ok(self.found),
        }
    }
}

/// Three coordinates; a weight behind them must be 1, a colour has three or four numbers.
fn point<'a>(words: impl Iterator<Item = &'a str>) -> Option<[f64; 3]> {
    let numbers: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
    match numbers?[..] {
        [x, y, z] | [x, y, z, 1.0] | [x, y, z, _, _, _] | [x, y, z, _, _, _, _] => Some([x, y, z]),
        _ => None,
    }
}
