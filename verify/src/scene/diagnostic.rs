//! A mistake in a case file and its place.

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
    pub fn of(file: &str, text: &str, byte: usize) -> Location {
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
            0 => write!(f, "{}", self.file),
            line => write!(f, "{}:{line}:{}", self.file, self.column),
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
    /// The line of the file, empty if there is none.
    pub source_line: String,
    /// Number of characters that are wrong, at least one.
    pub width: usize,
}

impl Diagnostic {
    /// A mistake in some bytes of `text`.
    pub fn at(
        file: &str,
        text: &str,
        span: Range<usize>,
        key: String,
        message: String,
    ) -> Diagnostic {
        let location = Location::of(file, text, span.start);
        let source_line = text.lines().nth(location.line - 1).unwrap_or("").to_string();
        let marked = text.get(span).unwrap_or("").lines().next().unwrap_or("").chars().count();
        Diagnostic { location, key, message, source_line, width: marked.max(1) }
    }

    /// A mistake that concerns a whole file, such as one that does not exist.
    pub fn of_file(file: &str, message: String) -> Diagnostic {
        let location = Location { file: file.to_string(), line: 0, column: 0 };
        Diagnostic { location, key: String::new(), message, source_line: String::new(), width: 1 }
    }
}

impl std::error::Error for Diagnostic {}

/// `file:line:column: key: message`, then the line with a caret under it.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.location)?;
        if !self.key.is_empty() {
            write!(f, "{}: ", self.key)?;
        }
        write!(f, "{}", self.message)?;
        if self.source_line.is_empty() {
            return Ok(());
        }
        let number = self.location.line.to_string();
        let gutter = " ".repeat(number.len());
        let indent: String = (self.source_line.chars().take(self.location.column - 1))
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        write!(f, "\n{number} | {}\n{gutter} | {indent}", self.source_line)?;
        write!(f, "{}", "^".repeat(self.width))
    }
}

/// All mistakes of a case file as one error, a line each.
pub fn one_error(mistakes: Vec<Diagnostic>) -> anyhow::Error {
    let lines: Vec<String> = mistakes.iter().map(Diagnostic::to_string).collect();
    anyhow::anyhow!("{}", lines.join("\n"))
}
