//! TOML text → the structs of the format, with the errors of serde turned into
//! located diagnostics.

use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::Document;
use crate::scene::nearest::nearest;
use serde::de::DeserializeOwned;
use std::ops::Range;

/// Reads the tables; the first mistake of a key or type is returned.
pub fn deserialise<T: DeserializeOwned>(document: &Document) -> Result<T, Diagnostic> {
    let reader = toml_edit::de::Deserializer::from(document.tree().clone());
    T::deserialize(reader).map_err(|error| located(document, &error))
}

fn located(document: &Document, error: &toml_edit::de::Error) -> Diagnostic {
    let span = error.span().unwrap_or(0..0);
    // What the file as a whole lacks belongs to no table that begins where the file does.
    let is_whole = document.tree().as_item().span().as_ref() == Some(&span);
    let path = if is_whole { String::new() } else { document.path_at(span.start) };
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
    let whole = "expected a whole number that is not negative";
    let message = message.replace("expected f64", "expected a number").replace('\n', ", ");
    let message = ["usize", "u32", "u64"]
        .iter()
        .fold(message, |text, kind| text.replace(&format!("expected {kind}"), whole));
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
