//! How one job with one program ended.

use super::process::{ChildRun, Ended, Usage};
use super::results::StoredEnd;
use mtled_case::protocol::{
    AnswerFault, Answered, Refused, SolverName, SoundReply, reply_value, sound_reply,
};
use mtled_case::scene::Case;
use mtled_checks::escape::printable;
use serde_json::Value;
use std::path::Path;

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
    /// The program or its answer breaks the protocol, and how.
    Faulty(String),
}

/// What is wrong with a program.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
enum Fault {
    #[error("ended with exit code {code}{last_words}")]
    Exit { code: i32, last_words: LastWords },
    #[error("ended by signal {signal}{last_words}")]
    Signal { signal: i32, last_words: LastWords },
    #[error("{0}")]
    Answer(AnswerFault),
}

/// The last lines of standard error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct LastWords(String);

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
    /// What a stored end is worth, where the job had so many instants.
    pub(crate) fn judged(ended: &StoredEnd, case: &Case, instants: usize) -> Outcome {
        match ended {
            StoredEnd::TimedOut => Outcome::TimedOut,
            StoredEnd::Fault(what) => Outcome::Faulty(what.clone()),
            StoredEnd::Reply(reply) => match sound_reply(reply.clone(), case, instants) {
                Ok(SoundReply::Answered(answered)) => Outcome::Answered(answered),
                Ok(SoundReply::Refused(refusal)) => {
                    Outcome::Refused(refusal.solver, refusal.refused)
                }
                Err(fault) => Outcome::Faulty(fault.to_string()),
            },
        }
    }

    /// The values.
    pub fn answered(&self) -> Option<&Answered> {
        match self {
            Outcome::Answered(answered) => Some(answered),
            _ => None,
        }
    }

    /// Who replied.
    pub(crate) fn solver(&self) -> Option<&SolverName> {
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
            Outcome::Faulty(fault) => format!("FAULT: {}", printable(fault)),
        }
    }
}

impl StoredEnd {
    /// Of a process that has ended; its answer is read. None where the user has stopped this
    /// program.
    pub(crate) fn of(run: &ChildRun, answer: &Path) -> Option<StoredEnd> {
        let status = match run.ended {
            Ended::Stopped => return None,
            Ended::TimedOut => return Some(StoredEnd::TimedOut),
            Ended::Exited(status) => status,
        };
        let last_words = LastWords::new(&run.last_words);
        let fault = match (status.success(), status.code(), signal(&status)) {
            (true, ..) => match reply_value(answer) {
                Ok(reply) => return Some(StoredEnd::Reply(rounded(reply))),
                Err(fault) => Fault::Answer(fault),
            },
            (false, None, Some(signal)) => Fault::Signal { signal, last_words },
            (false, code, _) => Fault::Exit { code: code.unwrap_or(-1), last_words },
        };
        Some(StoredEnd::Fault(fault.to_string()))
    }

    /// Of a program that could not be started.
    pub(crate) fn not_started(error: &std::io::Error) -> StoredEnd {
        StoredEnd::Fault(format!("does not start: {}", printable(&error.to_string())))
    }
}

/// Digits with which numbers of an answer are stored: a million times finer than errors of one per
/// mille, and half of the bytes.
const DIGITS: usize = 9;

/// A reply whose fractions have [`DIGITS`].
fn rounded(reply: Value) -> Value {
    match reply {
        Value::Array(list) => list.into_iter().map(rounded).collect(),
        Value::Object(keys) => keys.into_iter().map(|(key, value)| (key, rounded(value))).collect(),
        Value::Number(number) if number.is_f64() => {
            let value = number.as_f64().unwrap_or_default();
            // Nine digits are a number again.
            format!("{value:.*e}", DIGITS - 1)
                .parse()
                .map_or(Value::Number(number), |v: f64| v.into())
        }
        other => other,
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
    pub(crate) fn cpu_s(&self) -> Option<f64> {
        self.usage.map(|usage| usage.cpu_s)
    }

    /// Processor time \[s\] that the program tells apart from that of the solution.
    pub(crate) fn apart_cpu_s(&self) -> Option<f64> {
        self.outcome.answered()?.apart_cpu_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_stored_with_nine_digits_and_whole_numbers_as_they_are() {
        let reply =
            serde_json::json!({"u": [[0.12345678912345, -1e-300]], "unknowns": 12345678912u64});
        let kept = serde_json::json!({"u": [[0.123456789, -1e-300]], "unknowns": 12345678912u64});
        assert_eq!(rounded(reply), kept);
    }

    #[test]
    fn last_words_are_the_last_lines_without_escape_sequences() {
        let text = "one\ntwo\n\u{1b}[31mthree\nfour\n\n";
        assert_eq!(LastWords::new(text).to_string(), ": two; \\u{1b}[31mthree; four");
        assert_eq!(LastWords::new("").to_string(), "");
        assert!(LastWords::new(&"x".repeat(5000)).to_string().len() < 400);
    }
}
