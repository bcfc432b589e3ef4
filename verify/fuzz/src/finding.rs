//! What must never happen.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Kind of finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The program panicked.
    Panic,
    /// It asked for more memory than it may have.
    Memory,
    /// Its stack overflowed.
    StackOverflow,
    /// A signal ended it.
    Signal,
    /// It took longer than it may.
    Hang,
    /// Its exit code is none of those that are documented.
    ExitCode,
    /// It refused the input without a message that names it.
    Unlocated,
    /// It printed control characters.
    ControlCharacter,
    /// A result has numbers that are not finite.
    NotFinite,
    /// A file that it wrote cannot be read, or belongs to nothing.
    BadFile,
    /// It changed something outside its own folder.
    Outside,
    /// A relation that must hold of any scene does not.
    Relation,
}

impl Kind {
    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Panic => "panic",
            Kind::Memory => "memory",
            Kind::StackOverflow => "stack-overflow",
            Kind::Signal => "signal",
            Kind::Hang => "hang",
            Kind::ExitCode => "exit-code",
            Kind::Unlocated => "unlocated",
            Kind::ControlCharacter => "control-character",
            Kind::NotFinite => "not-finite",
            Kind::BadFile => "bad-file",
            Kind::Outside => "outside",
            Kind::Relation => "relation",
        }
    }
}

/// Something that must never happen.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Finding {
    /// What it is.
    pub kind: Kind,
    /// Where, or the message.
    pub detail: String,
}

impl Finding {
    /// A finding with its detail on one line, without control characters.
    pub(crate) fn new(kind: Kind, detail: impl fmt::Display) -> Finding {
        let detail = detail.to_string();
        let words: Vec<String> =
            detail.split_whitespace().map(|word| word.escape_debug().to_string()).collect();
        Finding { kind, detail: words.join(" ").chars().take(300).collect() }
    }

    /// The same for findings of one cause: the detail without its numbers, for control
    /// characters only where they were.
    pub(crate) fn signature(&self) -> String {
        let detail = match self.kind {
            Kind::ControlCharacter => self.detail.split(':').next().unwrap_or_default(),
            _ => &self.detail,
        };
        let letters = detail.chars().filter(|c| !c.is_ascii_digit());
        format!("{} {}", self.kind.name(), letters.take(60).collect::<String>())
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "{}: {}", self.kind.name(), self.detail)
    }
}

/// How a run ended that is none of the findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// To its end.
    Succeeded,
    /// To its end, with a reason to doubt it.
    Doubtful,
    /// With a message that names the input.
    Refused,
    /// With a message that no solution was found.
    Diverged,
    /// On request, after its time.
    Stopped,
    /// Not tried, since it is a large case.
    LeftOut,
}
