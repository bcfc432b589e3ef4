//! Findings in how a child ended, in what it printed and in the files that it wrote.

use crate::finding::{Finding, Kind};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Keys of result.json that may be null: they belong to other methods or are not known.
const MAY_BE_NULL: &[&str] = &[
    "relaxation",
    "instability",
    "newton",
    "newton_failed",
    "smallest_time_step_s",
    "largest_time_step_s",
    "critical_time_step_s",
    "per_point_bound_s",
    "smallest_patch_jacobian",
    "estimated_memory_bytes",
    "peak_memory_bytes",
    "energies",
];

/// Why a child died, from its standard error and the signal, if one ended it.
pub(crate) fn death(stderr: &str, signal: Option<i32>) -> Finding {
    if let Some(at) = stderr.find("panicked at ") {
        let place =
            stderr[at + 12..].rsplit_once("/registry/src/").map_or(&stderr[at + 12..], |p| p.1);
        return Finding::new(Kind::Panic, place);
    }
    if stderr.contains("memory allocation of") || stderr.contains("Cannot allocate memory") {
        return Finding::new(Kind::Memory, last_line(stderr));
    }
    if stderr.contains("has overflowed its stack") {
        return Finding::new(Kind::StackOverflow, "the stack overflowed");
    }
    match signal {
        Some(signal) => {
            Finding::new(Kind::Signal, format!("signal {signal}: {}", last_line(stderr)))
        }
        None => Finding::new(Kind::ExitCode, format!("ended early: {}", last_line(stderr))),
    }
}

/// The last line that is no note.
fn last_line(text: &str) -> &str {
    text.trim_end().lines().rfind(|line| !line.starts_with("note: ")).unwrap_or("")
}

/// Control characters in what was printed; line ends and tabs are none.
pub(crate) fn control_character(what: &str, text: &[u8]) -> Option<Finding> {
    let text = String::from_utf8_lossy(text);
    let found = text.char_indices().find(|(_, c)| c.is_control() && !matches!(c, '\n' | '\t'));
    let (at, c) = found?;
    let start = text[..at].char_indices().rev().nth(30).map_or(0, |(at, _)| at);
    Some(Finding::new(
        Kind::ControlCharacter,
        format!("{what}: U+{:04X} after {}", u32::from(c), &text[start..at]),
    ))
}

/// A refusal whose message does not name the input.
pub(crate) fn unlocated(message: &str, name: &str) -> Option<Finding> {
    (!message.contains(name))
        .then(|| Finding::new(Kind::Unlocated, format!("says only: {message}")))
}

/// Findings in the files of a folder.
pub(crate) fn files(folder: &Path) -> Vec<Finding> {
    let mut found = Vec::new();
    for file in all_files(folder) {
        let name = file.strip_prefix(folder).unwrap_or(&file).display().to_string();
        let Ok(bytes) = std::fs::read(&file) else { continue };
        let text = String::from_utf8_lossy(&bytes);
        match file.extension().and_then(|extension| extension.to_str()) {
            Some("json") => found.extend(json(&name, &text)),
            Some("csv") => found.extend(csv(&name, &text)),
            Some("pvd") => found.extend(pvd(&file, &text)),
            Some("vtu") => found.extend(vtu(&name, &bytes)),
            Some("tmp") => {
                found.push(Finding::new(Kind::BadFile, format!("{name} was left behind")))
            }
            _ => {}
        }
        if !matches!(file.extension().and_then(|e| e.to_str()), Some("vtu")) {
            found.extend(control_character(&name, &bytes));
        }
    }
    found
}

fn all_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.path()) {
        if path.is_dir() { files.extend(all_files(&path)) } else { files.push(path) }
    }
    files.sort();
    files
}

/// A document that is no JSON; for result.json also a null that stands for NaN.
pub(crate) fn json(name: &str, text: &str) -> Option<Finding> {
    let value: Value = match serde_json::from_str(text) {
        Ok(value) => value,
        Err(error) => return Some(Finding::new(Kind::BadFile, format!("{name}: {error}"))),
    };
    let result = name.ends_with("result.json");
    let at = result.then(|| null(&value, "")).flatten()?;
    Some(Finding::new(Kind::NotFinite, format!("{name}: {at} is null")))
}

/// Path of the first null that no key explains.
fn null(value: &Value, path: &str) -> Option<String> {
    match value {
        Value::Null => Some(path.to_string()),
        Value::Array(items) => items.iter().find_map(|item| null(item, path)),
        Value::Object(fields) => (fields.iter())
            .filter(|(key, value)| !(value.is_null() && MAY_BE_NULL.contains(&key.as_str())))
            .find_map(|(key, value)| null(value, &format!("{path}.{key}"))),
        _ => None,
    }
}

fn csv(name: &str, text: &str) -> Option<Finding> {
    let bad = |cell: &&str| matches!(cell.trim(), "NaN" | "-NaN" | "inf" | "-inf");
    let rows = text.lines().skip(1);
    let row = rows.into_iter().find(|line| line.split(',').any(|cell| bad(&cell)))?;
    Some(Finding::new(Kind::NotFinite, format!("{name}: {row}")))
}

/// Frames that are named and not there, or there and not named, of the kinds that a collection
/// lists.
fn pvd(file: &Path, text: &str) -> Option<Finding> {
    let folder = file.parent()?;
    let named: BTreeSet<&str> =
        text.split("file=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let there: BTreeSet<String> = (all_files(folder).iter())
        .filter(|path| path.extension().is_some_and(|extension| extension == "vtu"))
        .filter_map(|path| Some(path.file_name()?.to_str()?.to_string()))
        .collect();
    let kind = |name: &str| name.split('_').next().unwrap_or_default().to_string();
    let kinds: BTreeSet<String> = named.iter().map(|name| kind(name)).collect();
    let listed = |name: &&str| kinds.is_empty() || kinds.contains(&kind(name));
    let there: BTreeSet<&str> = there.iter().map(String::as_str).filter(listed).collect();
    let odd = named.symmetric_difference(&there).next()?;
    Some(Finding::new(Kind::BadFile, format!("frame {odd} is either not there or not in the PVD")))
}

/// Numbers of the appended data that are not finite.
fn vtu(name: &str, bytes: &[u8]) -> Option<Finding> {
    let marker = b"<AppendedData encoding=\"raw\">";
    let header = bytes.windows(marker.len()).position(|window| window == marker);
    let data =
        header.and_then(|at| Some((at, at + bytes[at..].iter().position(|b| *b == b'_')? + 1)));
    let Some((header, data)) = data else {
        return Some(Finding::new(Kind::BadFile, format!("{name} has no appended data")));
    };
    let text = String::from_utf8_lossy(&bytes[..header]);
    for array in text.split("<DataArray ").skip(1) {
        let size = match array {
            _ if array.contains("\"Float64\"") => 8,
            _ if array.contains("\"Float32\"") => 4,
            _ => continue,
        };
        let offset = array.split("offset=\"").nth(1).and_then(|rest| rest.split('"').next());
        let start = data + offset.and_then(|text| text.parse::<usize>().ok())?;
        let word =
            |at: usize| bytes.get(at..at + 8).and_then(|word| <[u8; 8]>::try_from(word).ok());
        let length = u64::from_le_bytes(word(start)?) as usize;
        let number = |at: usize| match size {
            8 => word(at).map(f64::from_le_bytes),
            _ => {
                let word = bytes.get(at..at + 4).and_then(|word| <[u8; 4]>::try_from(word).ok());
                word.map(|word| f64::from(f32::from_le_bytes(word)))
            }
        };
        let bad = (0..length / size)
            .find(|n| number(start + 8 + size * n).is_none_or(|number| !number.is_finite()));
        if bad.is_some() {
            let array = array.split("Name=\"").nth(1).and_then(|rest| rest.split('"').next());
            let detail = format!("{name}: {}", array.unwrap_or("an array"));
            return Some(Finding::new(Kind::NotFinite, detail));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(name: &str, bytes: &[u8]) -> Vec<Kind> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), bytes).unwrap();
        files(folder.path()).iter().map(|finding| finding.kind).collect()
    }

    #[test]
    fn files_that_are_damaged_or_have_numbers_that_are_not_finite_are_found() {
        assert_eq!(kinds("result.json", b"{\"newton\": null, \"a\": [0.5]}"), []);
        assert_eq!(kinds("result.json", b"{\"a\": [null]}"), [Kind::NotFinite]);
        assert_eq!(kinds("result.json", b"{\"a\": "), [Kind::BadFile]);
        assert_eq!(kinds("history.csv", b"a,b\n1,2\n"), []);
        assert_eq!(kinds("history.csv", b"a,b\n1,NaN\n"), [Kind::NotFinite]);
        assert_eq!(kinds("a.pvd", b"<DataSet file=\"nodes_0000.vtu\"/>"), [Kind::BadFile]);
        assert_eq!(kinds(".a.json.1.tmp", b""), [Kind::BadFile]);
        assert_eq!(kinds("index.html", b"\x1b[31m"), [Kind::ControlCharacter]);
    }

    #[test]
    fn a_field_that_is_not_finite_is_found_in_a_frame() {
        let frame = |value: f64| {
            let header = "<DataArray type=\"Float64\" Name=\"J\" offset=\"0\"/>\n<AppendedData encoding=\"raw\">\n_";
            [header.as_bytes(), &8u64.to_le_bytes(), &value.to_le_bytes()].concat()
        };
        assert_eq!(vtu("a.vtu", &frame(1.0)), None);
        let found = vtu("a.vtu", &frame(f64::NAN)).unwrap();
        assert_eq!((found.kind, found.detail.as_str()), (Kind::NotFinite, "a.vtu: J"));
    }

    #[test]
    fn escape_sequences_are_found_and_line_ends_are_not() {
        assert_eq!(control_character("a", "é\tb\n".as_bytes()), None);
        for text in ["\u{1b}[31m", "a\r", "\0", "\u{9b}1m", "\u{7f}"] {
            let found = control_character("standard error", text.as_bytes()).unwrap();
            assert_eq!(found.kind, Kind::ControlCharacter, "{text:?}");
        }
    }

    #[test]
    fn ends_of_programs_are_told_apart() {
        let kind = |stderr: &str, signal| death(stderr, signal).kind;
        assert_eq!(kind("thread 'main' panicked at src/a.rs:1:2:\nno", None), Kind::Panic);
        assert_eq!(kind("memory allocation of 8 bytes failed", Some(6)), Kind::Memory);
        assert_eq!(kind("thread 'main' has overflowed its stack", Some(6)), Kind::StackOverflow);
        assert_eq!(kind("", Some(11)), Kind::Signal);
        assert_eq!(kind("", None), Kind::ExitCode);
    }
}
