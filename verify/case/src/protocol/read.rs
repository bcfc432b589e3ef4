//! Reading the file that a solver wrote: what is wrong with it is typed and names the key.

use super::answer::{Answer, Refusal, Reply, SolverName};
use super::job::Job;
use super::version::PROTOCOL;
use crate::reference::{Family, Quantity, quantities};
use crate::scene::Case;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The longest answer that is read \[byte\].
const LONGEST: u64 = 1 << 26;

/// What is wrong with the file of an answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnswerFault {
    #[error("there is no answer file")]
    Absent,
    #[error("the answer file cannot be read: {reason}")]
    Unreadable { reason: String },
    #[error("the answer file has more than {LONGEST} bytes")]
    TooLong,
    #[error("not JSON: {reason}")]
    NotJson { reason: String },
    #[error("there is a number that is not finite, line {line}, column {column}")]
    NotFinite { line: usize, column: usize },
    #[error("protocol is {found}; this program speaks version {PROTOCOL}")]
    Version { found: Value },
    #[error("{key}: {reason}")]
    Schema { key: String, reason: String },
    #[error("{key} is missing")]
    Missing { key: String },
    #[error("{key}: the job has no such {what}")]
    Unknown { key: String, what: &'static str },
    #[error("{key} has {found} entries instead of {expected}, one per {per}")]
    Count { key: String, found: usize, expected: usize, per: &'static str },
}

/// A reply that fits the job.
#[derive(Debug, Clone, PartialEq)]
pub enum SoundReply {
    /// Values of the quantities of the case.
    Answered(Answered),
    /// Why there are none.
    Refused(Refusal),
}

/// The values of an answer in the order of the quantities of its case.
#[derive(Debug, Clone, PartialEq)]
pub struct Answered {
    /// Name and version.
    pub solver: SolverName,
    /// Instant by instant, as in a reference; None for quantities that are not answered.
    pub values: Vec<Option<Vec<f64>>>,
    /// Scalar unknowns.
    pub unknowns: u64,
    /// Processor time \[s\] that the program believes to have taken.
    pub claimed_cpu_s: Option<f64>,
    /// Processor time \[s\] that it tells apart from that of the solution.
    pub apart_cpu_s: Option<f64>,
    /// Memory \[byte\] that the program believes to have taken.
    pub claimed_memory_bytes: Option<u64>,
    /// How it was solved.
    pub method: Option<String>,
}

/// Reads the reply to a job of a case with some number of instants.
pub fn read_reply(path: &Path, case: &Case, instants: usize) -> Result<SoundReply, AnswerFault> {
    sound_reply(reply_value(path)?, case, instants)
}

/// Reads the file of a reply, whatever is in it.
pub fn reply_value(path: &Path) -> Result<Value, AnswerFault> {
    json(&read_text(path)?)
}

/// A reply to a job of a case with some number of instants.
pub fn sound_reply(reply: Value, case: &Case, instants: usize) -> Result<SoundReply, AnswerFault> {
    match reply_of(reply)? {
        Reply::Refusal(refusal) => Ok(SoundReply::Refused(refusal)),
        Reply::Answer(answer) => Ok(SoundReply::Answered(answered(answer, case, instants)?)),
    }
}

fn read_text(path: &Path) -> Result<String, AnswerFault> {
    let mut bytes = Vec::new();
    let unreadable = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::NotFound => AnswerFault::Absent,
        _ => AnswerFault::Unreadable { reason: error.to_string() },
    };
    // A pipe would never end.
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(AnswerFault::Unreadable { reason: "it is not a file".into() });
    }
    let file = File::open(path).map_err(unreadable)?;
    file.take(LONGEST + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > LONGEST {
        return Err(AnswerFault::TooLong);
    }
    String::from_utf8(bytes).map_err(|_| AnswerFault::NotJson { reason: "it is not UTF-8".into() })
}

/// The job in a text.
pub fn parse_job(text: &str) -> Result<Job, AnswerFault> {
    fitting(versioned(json(text)?)?)
}

fn reply_of(value: Value) -> Result<Reply, AnswerFault> {
    let value = versioned(value)?;
    match value.get("refused") {
        Some(_) => Ok(Reply::Refusal(fitting(value)?)),
        None => Ok(Reply::Answer(fitting(value)?)),
    }
}

fn json(text: &str) -> Result<Value, AnswerFault> {
    serde_json::from_str(text).map_err(|error| not_json(text, &error))
}

/// A JSON object of this version of the protocol.
fn versioned(value: Value) -> Result<Value, AnswerFault> {
    match value.get("protocol") {
        Some(version) if version.as_u64() == Some(PROTOCOL.into()) => Ok(value),
        Some(version) => Err(AnswerFault::Version { found: version.clone() }),
        None if value.is_object() => Err(AnswerFault::Missing { key: "protocol".into() }),
        None => Err(AnswerFault::NotJson { reason: "it is not an object".into() }),
    }
}

/// Python and others write NaN and Infinity where JSON has no such word.
fn not_json(text: &str, error: &serde_json::Error) -> AnswerFault {
    let (line, column) = (error.line(), error.column());
    let before = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
    let word: String = before.chars().skip(column.saturating_sub(2)).take(10).collect();
    let word = word.trim_start_matches(['-', ' ', ',', '[', ':']).to_ascii_lowercase();
    match word.starts_with("nan") || word.starts_with("inf") {
        true => AnswerFault::NotFinite { line, column },
        false if error.to_string().starts_with("number out of range") => {
            AnswerFault::NotFinite { line, column }
        }
        false => AnswerFault::NotJson { reason: error.to_string() },
    }
}

fn fitting<T: DeserializeOwned>(value: Value) -> Result<T, AnswerFault> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let (key, reason) = (error.path().to_string(), error.inner().to_string());
        match reason.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`')) {
            Some(name) if key == "." => AnswerFault::Missing { key: name.to_string() },
            Some(name) => AnswerFault::Missing { key: format!("{key}.{name}") },
            None => AnswerFault::Schema { key, reason },
        }
    })
}

/// The values of an answer, each of which fits the case.
fn answered(answer: Answer, case: &Case, instants: usize) -> Result<Answered, AnswerFault> {
    if answer.unknowns == 0 {
        let reason = "is 0; a system without unknowns solves nothing".to_string();
        return Err(AnswerFault::Schema { key: "unknowns".into(), reason });
    }
    let required = quantities(case);
    refuse_unknown("displacements_m", "probe", answer.displacements_m.keys(), &required)?;
    refuse_unknown("reactions_n", "support", answer.reactions_n.keys(), &required)?;
    refuse_unknown("moments_nm", "support", answer.moments_nm.keys(), &required)?;
    let values = required.iter().map(|quantity| values(&answer, quantity, instants));
    Ok(Answered {
        values: values.collect::<Result<_, _>>()?,
        solver: answer.solver,
        unknowns: answer.unknowns,
        claimed_cpu_s: answer.cpu_s,
        apart_cpu_s: answer.apart_cpu_s,
        claimed_memory_bytes: answer.peak_memory_bytes,
        method: answer.method,
    })
}

fn refuse_unknown<'a>(
    table: &str,
    what: &'static str,
    names: impl Iterator<Item = &'a String>,
    required: &[Quantity],
) -> Result<(), AnswerFault> {
    let prefix = if what == "probe" { "displacement" } else { "force" };
    for name in names {
        let key = format!("{prefix}/{name}");
        if required.iter().all(|quantity| quantity.name != key) {
            return Err(AnswerFault::Unknown { key: format!("{table}.{name}"), what });
        }
    }
    Ok(())
}

/// The values of a quantity; None where the solver leaves it out and may do so.
fn values(
    answer: &Answer,
    quantity: &Quantity,
    instants: usize,
) -> Result<Option<Vec<f64>>, AnswerFault> {
    let name = quantity.name.split_once('/').map_or("", |(_, name)| name);
    match quantity.family {
        Family::Centre => Ok(None),
        Family::Displacement => {
            let key = format!("displacements_m.{name}");
            let Some(rows) = answer.displacements_m.get(name) else {
                return Err(AnswerFault::Missing { key });
            };
            count(&key, rows.len(), instants, "instant")?;
            for (n, positions) in rows.iter().enumerate() {
                let expected = quantity.width / quantity.family.components();
                count(&format!("{key}[{n}]"), positions.len(), expected, "position")?;
            }
            Ok(Some(rows.iter().flatten().flatten().copied().collect()))
        }
        Family::Force => vectors("reactions_n", &answer.reactions_n, name, instants),
        Family::Moment => vectors("moments_nm", &answer.moments_nm, name, instants),
        Family::StrainEnergy => numbers("strain_energy_j", &answer.strain_energy_j, instants),
        Family::KineticEnergy => numbers("kinetic_energy_j", &answer.kinetic_energy_j, instants),
    }
}

fn vectors(
    table: &str,
    rows: &BTreeMap<String, Vec<[f64; 3]>>,
    name: &str,
    instants: usize,
) -> Result<Option<Vec<f64>>, AnswerFault> {
    let Some(row) = rows.get(name) else { return Ok(None) };
    count(&format!("{table}.{name}"), row.len(), instants, "instant")?;
    Ok(Some(row.iter().flatten().copied().collect()))
}

fn numbers(
    key: &str,
    row: &Option<Vec<f64>>,
    instants: usize,
) -> Result<Option<Vec<f64>>, AnswerFault> {
    if let Some(row) = row {
        count(key, row.len(), instants, "instant")?;
    }
    Ok(row.clone())
}

fn count(key: &str, found: usize, expected: usize, per: &'static str) -> Result<(), AnswerFault> {
    if found == expected {
        Ok(())
    } else {
        Err(AnswerFault::Count { key: key.into(), found, expected, per })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse_reply(text: &str) -> Result<Reply, AnswerFault> {
        reply_of(json(text)?)
    }

    const START: &str = r#""protocol": 1, "solver": {"name": "s", "version": "1"}"#;

    fn fault(rest: &str) -> AnswerFault {
        parse_reply(&format!("{{{START}{rest}}}")).unwrap_err()
    }

    #[test]
    fn a_number_that_json_does_not_have_is_called_not_finite() {
        for word in ["NaN", "-Infinity", "Infinity", "1e999"] {
            let text =
                format!(r#", "unknowns": 3, "displacements_m": {{"p": [[[0.0, {word}, 0]]]}}"#);
            let found = fault(&text);
            assert!(matches!(found, AnswerFault::NotFinite { line: 1, .. }), "{word}: {found:?}");
        }
        assert!(matches!(parse_reply("hello"), Err(AnswerFault::NotJson { .. })));
    }

    #[test]
    fn a_breach_of_the_schema_names_its_key() {
        let found = fault(r#", "unknowns": 3, "displacements_m": {"p": [[[0.0, null, 0]]]}"#);
        let AnswerFault::Schema { key, reason } = &found else { panic!("{found:?}") };
        assert_eq!(key, "displacements_m.p[0][0][1]");
        assert!(reason.contains("null"), "{reason}");
        let missing = fault(r#", "displacements_m": {}"#);
        assert_eq!(missing, AnswerFault::Missing { key: "unknowns".into() });
        assert!(
            fault(r#", "displacements_m": {}, "unknowns": 1, "probes": 2"#)
                .to_string()
                .contains("probes")
        );
    }

    #[test]
    fn another_version_is_refused() {
        let found = parse_reply(r#"{"protocol": 2}"#).unwrap_err();
        assert!(matches!(found, AnswerFault::Version { .. }), "{found:?}");
    }

    #[test]
    fn a_refusal_is_read_with_its_reason() {
        let text =
            format!(r#"{{{START}, "refused": {{"reason": "unsupported", "what": "contact"}}}}"#);
        let Reply::Refusal(refusal) = parse_reply(&text).unwrap() else { panic!("an answer") };
        assert_eq!(refusal.refused.what, "contact");
        let unknown = fault(r#", "refused": {"reason": "tired", "what": "all"}"#);
        assert!(unknown.to_string().starts_with("refused.reason"), "{unknown}");
    }
}
