//! How one job with one program ended.

use super::process::{ChildRun, Ended, Usage};
use crate::protocol::{AnswerFault, Answered, Refused, SolverName, SoundReply};
use mtled_checks::escape::printable;
use std::io;

/// Lines of standard error that are shown.
const LINES: usize = 3;
/// Characters of standard error that are shown.
const CHARACTERS: usize = 300;

/// How a job ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// With values.
    Answered(Answered),
    /// The program says why it does not solve it.
    Refused(SolverName, Refused),
    /// The program did not end in time and was killed.
    TimedOut,
    /// The program or its answer breaks the protocol.
    Faulty(Fault),
}

/// What is wrong with a program.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Fault {
    #[error("does not start: {reason}")]
    NotStarted { reason: String },
    #[error("ended with exit code {code}{last_words}")]
    Exit { code: i32, last_words: LastWords },
    #[error("ended by signal {signal}{last_words}")]
    Signal { signal: i32, last_words: LastWords },
    #[error("{0}")]
    Answer(AnswerFault),
}

/// The last lines of standard error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LastWords(String);

impl std::fmt::Display for LastWords {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(out, ": {}", self.0) }
    }
}

impl LastWords {
    fn new(text: &str) -> LastWords {
        let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
        let shown = lines[lines.len().saturating_sub(LINES)..].join("; ");
        let skipped = shown.chars().count().saturating_sub(CHARACTERS);
        LastWords(printable(&shown.chars().skip(skipped).collect::<String>()))
    }
}

impl Outcome {
    /// Of a program that could not be started.
    pub fn not_started(error: &io::Error) -> Outcome {
        Outcome::Faulty(Fault::NotStarted { reason: printable(&error.to_string()) })
    }

    /// Of a process that has ended; `reply` reads its answer. None where the user has stopped
    /// this program.
    pub fn of(
        run: &ChildRun,
        reply: impl FnOnce() -> Result<SoundReply, AnswerFault>,
    ) -> Option<Outcome> {
        let status = match run.ended {
            Ended::Stopped => return None,
            Ended::TimedOut => return Some(Outcome::TimedOut),
            Ended::Exited(status) => status,
        };
        if !status.success() {
            let last_words = LastWords::new(&run.last_words);
            let fault = match (status.code(), signal(&status)) {
                (None, Some(signal)) => Fault::Signal { signal, last_words },
                (code, _) => Fault::Exit { code: code.unwrap_or(-1), last_words },
            };
            return Some(Outcome::Faulty(fault));
        }
        Some(match reply() {
            Ok(SoundReply::Answered(answered)) => Outcome::Answered(answered),
            Ok(SoundReply::Refused(refusal)) => Outcome::Refused(refusal.solver, refusal.refused),
            Err(fault) => Outcome::Faulty(Fault::Answer(fault)),
        })
    }

    /// The values.
    pub fn answered(&self) -> Option<&Answered> {
        match self {
            Outcome::Answered(answered) => Some(answered),
            _ => None,
        }
    }

    /// Who replied.
    pub fn solver(&self) -> Option<&SolverName> {
        match self {
            Outcome::Answered(answered) => Some(&answered.solver),
            Outcome::Refused(solver, _) => Some(solver),
            _ => None,
        }
    }

    /// In tables.
    pub fn label(&self) -> String {
        match self {
            Outcome::Answered(_) => "answered".into(),
            Outcome::Refused(_, refused) => {
                format!("refused, {}: {}", refused.reason.label(), printable(&refused.what))
            }
            Outcome::TimedOut => "timed out".into(),
            Outcome::Faulty(fault) => format!("FAULT: {}", printable(&fault.to_string())),
        }
    }
}

#[cfg(unix)]
fn signal(status: &std::process::ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(status)
}

#[cfg(not(unix))]
fn signal(_: &std::process::ExitStatus) -> Option<i32> {
    None
}

/// One job with one program.
#[derive(Debug, Clone)]
pub struct SolverRun {
    /// Number of the resolution.
    pub level: usize,
    /// Wanted distance of nodes \[m\].
    pub spacing_m: f64,
    /// How it ended.
    pub outcome: Outcome,
    /// What it has taken; None where it did not start.
    pub usage: Option<Usage>,
}

impl SolverRun {
    /// Measured CPU time \[s\].
    pub fn cpu_s(&self) -> Option<f64> {
        self.usage.map(|usage| usage.cpu_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_words_are_the_last_lines_without_escape_sequences() {
        let text = "one\ntwo\n\u{1b}[31mthree\nfour\n\n";
        assert_eq!(LastWords::new(text).to_string(), ": two; \\u{1b}[31mthree; four");
        assert_eq!(LastWords::new("").to_string(), "");
        assert!(LastWords::new(&"x".repeat(5000)).to_string().len() < 400);
    }
}
