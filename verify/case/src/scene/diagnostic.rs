//! A mistake in a case file and its place.

use mtled_checks::escape::{printable, printable_lines};
use std::fmt;
use std::ops::Range;

/// A place in a file; lines and columns count from 1, columns in characters.
/// Line 0 means the file as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// Path of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
}

impl Location {
    /// The place of a byte of `text`.
    pub(crate) fn of(file: &str, text: &str, byte: usize) -> Location {
        let before = &text.as_bytes()[..byte.min(text.len())];
        let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
        Location {
            file: file.to_string(),
            line: before.iter().filter(|&&b| b == b'\n').count() + 1,
            column: String::from_utf8_lossy(&before[start..]).chars().count() + 1,
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}", printable(&self.file)),
            line => write!(f, "{}:{line}:{}", printable(&self.file), self.column),
        }
    }
}

/// A mistake: where, which key, and what was expected.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// Where it is.
    pub location: Location,
    /// Key path, such as `material.brain.poisson_ratio`; empty for syntax.
    pub key: String,
    /// What is wrong and what is expected.
    pub message: String,
    /// The line of the file, of a long one the part around the mistake; empty if there is
    /// none.
    pub source_line: String,
    /// Number of characters of `source_line` before the mistake.
    indent: u32,
    /// Number of characters that are wrong, at least one.
    pub width: u32,
}

/// At most so many characters of a line are shown.
const LONGEST_LINE: usize = 160;

impl Diagnostic {
    /// A mistake in some bytes of `text`.
    pub(crate) fn at(
        file: &str,
        text: &str,
        span: Range<usize>,
        key: String,
        message: String,
    ) -> Diagnostic {
        let location = Location::of(file, text, span.start);
        let line = text.lines().nth(location.line - 1).unwrap_or("");
        let shown_from = if line.len() > LONGEST_LINE {
            (location.column - 1).saturating_sub(LONGEST_LINE / 2)
        } else {
            0
        };
        let source_line: String = line.chars().skip(shown_from).take(LONGEST_LINE).collect();
        let indent = (location.column - 1 - shown_from) as u32;
        let marked = text.get(span).unwrap_or("").lines().next().unwrap_or("").chars().count();
        let shown = source_line.chars().count().saturating_sub(indent as usize);
        let width = marked.min(shown).max(1) as u32;
        Diagnostic { location, key, message, source_line, indent, width }
    }

    /// A mistake that concerns a whole file, such as one that does not exist.
    pub fn of_file(file: &str, message: String) -> Diagnostic {
        let location = Location { file: file.to_string(), line: 0, column: 0 };
        let (key, source_line) = (String::new(), String::new());
        Diagnostic { location, key, message, source_line, indent: 0, width: 1 }
    }
}

impl std::error::Error for Diagnostic {}

/// `file:line:column: key: message`, then the line with a caret under it.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.location)?;
        if !self.key.is_empty() {
            write!(f, "{}: ", printable(&self.key))?;
        }
        write!(f, "{}", printable(&self.message))?;
        if self.source_line.is_empty() {
            return Ok(());
        }
        let number = self.location.line.to_string();
        let gutter = " ".repeat(number.len());
        let mut characters = self.source_line.chars();
        let before: String = characters.by_ref().take(self.indent as usize).collect();
        let marked: String = characters.take(self.width as usize).collect();
        let indent: String = (printable_lines(&before).chars())
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        let line = printable_lines(&self.source_line);
        write!(f, "\n{number} | {line}\n{gutter} | {indent}")?;
        write!(f, "{}", "^".repeat(printable_lines(&marked).chars().count().max(1)))
    }
}

/// The mistakes of a case file.
#[derive(Debug, Clone, PartialEq)]
pub struct Mistakes(pub Vec<Diagnostic>);

impl std::error::Error for Mistakes {}

/// A mistake after the other.
impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texts: Vec<String> = self.0.iter().map(Diagnostic::to_string).collect();
        write!(f, "{}", texts.join("\n"))
    }
}

/// All mistakes of a case file as one error.
pub fn one_error(mistakes: Vec<Diagnostic>) -> anyhow::Error {
    Mistakes(mistakes).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_snippet_cannot_steer_the_terminal_and_its_caret_stays_below_the_mistake() {
        let text = "a = \"\u{1b}[2J\"; b = 1";
        let at = text.find('b').unwrap();
        let mistake = Diagnostic::at("c\u{7}.toml", text, at..at + 1, "b\n".into(), "no\r".into());
        let shown = mistake.to_string();
        let lines: Vec<&str> = shown.lines().collect();
        assert_eq!(lines[0], "c\\u{7}.toml:1:13: b\\n: no\\r");
        assert_eq!(lines[2].find('^'), lines[1].rfind('b'));
        assert!(!shown.contains('\u{1b}'), "{shown:?}");
    }
}
