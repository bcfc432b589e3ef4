//! TOML text → the structs of the format, with the errors of serde turned into
//! located diagnostics.

use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::Document;
use crate::scene::format::CaseFormat;
use serde::Deserialize;
use std::ops::Range;

/// Reads the tables; the first mistake of a key or type is returned.
pub fn deserialise(document: &Document) -> Result<CaseFormat, Diagnostic> {
    let reader = toml_edit::de::Deserializer::from(document.tree().clone());
    CaseFormat::deserialize(reader).map_err(|error| located(document, &error))
}

fn located(document: &Document, error: &toml_edit::de::Error) -> Diagnostic {
    let span = error.span().unwrap_or(0..0);
    let path = document.path_at(span.start);
    let message = error.message().trim_end();
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if message.starts_with("missing field") {
        let key = join(&path, quoted[0]);
        return document.diagnostic_at(span, key, "is missing".to_string());
    }
    if message.starts_with("unknown field") {
        return unknown_key(document, span, path, quoted[0], &quoted[1..]);
    }
    // A table of an enum has a message of its own.
    if let Some(lists) = message.strip_prefix("unexpected keys in table: ") {
        let (names, known) = lists.split_once(", available keys: ").unwrap_or((lists, ""));
        let name = names.split(", ").next().unwrap_or(names);
        return unknown_key(document, span, path, name, &known.split(", ").collect::<Vec<_>>());
    }
    if message.starts_with("unknown variant") {
        let (name, known) = (quoted[0], &quoted[1..]);
        let path = path.strip_suffix(&format!(".{name}")).unwrap_or(&path).to_string();
        let path = path.strip_suffix(&format!(".{name}")).unwrap_or(&path).to_string();
        let message =
            format!("`{name}` is not a choice that is known here{}", choices(name, known));
        return document.diagnostic_at(span, path, message);
    }
    let message = message.replace("expected f64", "expected a number").replace('\n', ", ");
    document.diagnostic_at(span, path, message)
}

fn unknown_key(
    document: &Document,
    span: Range<usize>,
    path: String,
    name: &str,
    known: &[&str],
) -> Diagnostic {
    let key = if path.rsplit('.').next() == Some(name) { path } else { join(&path, name) };
    let message = format!("is not a key that is known here{}", choices(name, known));
    document.diagnostic_at(span, key, message)
}

fn join(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_string() } else { format!("{path}.{name}") }
}

/// What could have been meant.
fn choices(name: &str, known: &[&str]) -> String {
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("; did you mean `{near}`?"),
        None if known.is_empty() => String::new(),
        None => format!("; expected one of {}", known.join(", ")),
    }
}

/// The word at most two edits away from `name`, if there is one.
pub fn nearest<'a>(name: &str, words: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    words
        .map(|word| (edit_distance(name, word), word))
        .filter(|(distance, word)| *distance <= 2 && *distance < word.len())
        .min()
        .map(|(_, word)| word)
}

/// Levenshtein's distance: insertions, deletions and substitutions.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let change = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_finger_finds_the_word_that_was_meant() {
        let words = ["density", "law", "poisson_ratio"];
        assert_eq!(nearest("densty", words.into_iter()), Some("density"));
        assert_eq!(nearest("poison_ratio", words.into_iter()), Some("poisson_ratio"));
        assert_eq!(nearest("viscosity", words.into_iter()), None);
    }
}
