//! STL files of text: every `solid` block of a file, in capitals or not.

use super::space::Space;
use crate::files::error::Mistake;
use std::iter::Enumerate;
use std::str::{Split, SplitWhitespace};

/// Coordinates of a corner as a file has them.
pub(super) type Corner = [f64; 3];

/// Corners of the triangles of all blocks, three to a triangle, in RAS. A block may lack its
/// `endsolid`, as files do that were put together; a facet may lack nothing.
pub(crate) fn corners(bytes: &[u8]) -> Result<Vec<Corner>, Mistake> {
    let text = String::from_utf8_lossy(bytes).replace("\r\n", "\n");
    let mut words = Words::of(&text);
    let (mut corners, mut space, mut open) = (Vec::new(), Space::default(), false);
    while let Some(keyword) = words.keyword() {
        match (keyword.as_str(), open) {
            ("solid", _) => {
                space = Space::stated(words.rest_of_line().as_bytes())?.unwrap_or_default();
                open = true;
            }
            ("endsolid", true) => {
                words.rest_of_line();
                open = false;
            }
            ("facet", true) => {
                corners.extend(facet(&mut words)?.map(|corner| space.to_ras(corner)))
            }
            (_, true) => return Err(words.bad_line("`facet`, `endsolid` or `solid`")),
            (_, false) => return Err(words.bad_line("`solid` or the end of the file")),
        }
    }
    Ok(corners)
}

/// The corners of a facet, whose first word has been read.
fn facet(words: &mut Words) -> Result<[Corner; 3], Mistake> {
    words.expect("normal", "`facet normal` and three numbers")?;
    words.numbers("`facet normal` and three numbers")?;
    words.expect("outer", "`outer loop`")?;
    words.expect("loop", "`outer loop`")?;
    let mut corners = [[0.0; 3]; 3];
    for corner in &mut corners {
        words.expect("vertex", "one of the three lines `vertex` of a facet")?;
        *corner = words.numbers("`vertex` and three numbers")?;
    }
    words.expect("endloop", "`endloop` after three lines `vertex`")?;
    words.expect("endfacet", "`endfacet`")?;
    Ok(corners)
}

/// The words of a text and where they stand.
struct Words<'a> {
    lines: Enumerate<Split<'a, [char; 2]>>,
    words: SplitWhitespace<'a>,
    /// Number and text of the line of the last word.
    line: (usize, &'a str),
}

impl<'a> Words<'a> {
    fn of(text: &'a str) -> Words<'a> {
        let lines = text.split(['\n', '\r']).enumerate();
        Words { lines, words: "".split_whitespace(), line: (0, "") }
    }

    fn next(&mut self) -> Option<&'a str> {
        loop {
            if let Some(word) = self.words.next() {
                return Some(word);
            }
            let (before, line) = self.lines.find(|(_, line)| !line.trim().is_empty())?;
            self.line = (before + 1, line);
            self.words = line.split_whitespace();
        }
    }

    /// The next word in small letters, `end` together with the word that it ends.
    fn keyword(&mut self) -> Option<String> {
        let mut word = self.next()?.to_lowercase();
        if word == "end" {
            word += &self.next().unwrap_or_default().to_lowercase();
        }
        Some(word)
    }

    fn expect(&mut self, keyword: &str, expected: &'static str) -> Result<(), Mistake> {
        match self.keyword() {
            Some(found) if found == keyword => Ok(()),
            Some(_) => Err(self.bad_line(expected)),
            None => Err(self.ended(expected)),
        }
    }

    /// Three numbers.
    fn numbers(&mut self, expected: &'static str) -> Result<Corner, Mistake> {
        let mut numbers = [0.0; 3];
        for number in &mut numbers {
            let Some(word) = self.next() else { return Err(self.ended(expected)) };
            *number = word.parse().map_err(|_| self.bad_line(expected))?;
        }
        Ok(numbers)
    }

    /// What stands behind the last word, which is thereby read.
    fn rest_of_line(&mut self) -> String {
        let rest: Vec<&str> = std::mem::replace(&mut self.words, "".split_whitespace()).collect();
        rest.join(" ")
    }

    fn bad_line(&self, expected: &'static str) -> Mistake {
        let (line, text) = self.line;
        Mistake::bad_line(line, text, expected)
    }

    fn ended(&self, expected: &'static str) -> Mistake {
        Mistake::TextEnds { line: self.line.0, expected }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: &str = "solid one part\nfacet normal 0 0 1\n outer loop\n  vertex 1 2 3\n  vertex 4 5 6\n  \
                         vertex 7 8 9e-1\n endloop\nendfacet\nendsolid one part\n";
    const TRIANGLE: [Corner; 3] = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 0.9]];

    fn read(text: &str) -> Vec<Corner> {
        corners(text.as_bytes()).unwrap_or_else(|mistake| panic!("{mistake} in {text:?}"))
    }

    #[test]
    fn every_solid_of_a_text_is_read() {
        let unended = BLOCK.replace("endsolid one part\n", "");
        for text in
            [[BLOCK, BLOCK].concat(), [&unended, BLOCK].concat(), [BLOCK, &unended].concat()]
        {
            assert_eq!(read(&text), [TRIANGLE, TRIANGLE].concat());
        }
    }

    #[test]
    fn capitals_ends_of_two_words_and_any_line_ends_are_read() {
        let spaced = BLOCK.replace("end", "end ");
        let unended = BLOCK.replace("endsolid one part\n", "");
        for text in [BLOCK.to_uppercase(), spaced, unended] {
            for line_end in ["\n", "\r\n", "\r"] {
                assert_eq!(read(&text.replace('\n', line_end)), TRIANGLE);
            }
        }
    }

    #[test]
    fn a_name_may_be_made_of_keywords() {
        assert_eq!(read(&BLOCK.replace("one part", "facet endsolid vertex")), TRIANGLE);
    }

    #[test]
    fn what_is_malformed_is_refused_with_its_line() {
        let mistakes = [
            (
                "vertex 4 5 6",
                "vertex 4 5",
                "line 6 is `vertex 7 8 9e-1`; expected `vertex` and three numbers",
            ),
            (
                "vertex 4 5 6",
                "vertex 4 5 6x",
                "line 5 is `vertex 4 5 6x`; expected `vertex` and three",
            ),
            (
                "  vertex 4 5 6\n",
                "",
                "line 6 is `endloop`; expected one of the three lines `vertex`",
            ),
            ("endloop", "vertex 0 0 0\n endloop", "line 7 is `vertex 0 0 0`; expected `endloop`"),
            ("endfacet", "endface", "line 8 is `endface`; expected `endfacet`"),
            ("endsolid one part\n", "endsolid\nfacet", "line 10 is `facet`; expected `solid`"),
            ("endfacet\nendsolid one part\n", "", "ends in line 7; expected `endfacet`"),
        ];
        for (right, wrong, expected) in mistakes {
            let mistake = corners(BLOCK.replace(right, wrong).as_bytes()).unwrap_err().to_string();
            assert!(mistake.contains(expected), "{mistake}\n{expected}");
        }
    }
}
