//! Keys of a case that are set from outside of its file, as `--set KEY=VALUE` does.

use crate::scene::diagnostic::Diagnostic;
use crate::scene::edit::values::replace;
use crate::scene::format::CaseFormat;
use crate::scene::key_path::{entry, is_within, joined, joined_index, names, segments};
use crate::scene::nearest::nearest;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};
use std::ops::Range;
use std::str::FromStr;
use toml_edit::{DocumentMut, InlineTable, Item, TableLike, Value};

/// A key of a case and the value that it has in place of that of the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Override {
    /// Such as `prescribe.top.displacement.z`.
    key: String,
    /// In the syntax of TOML; a word that is none is a text.
    value: String,
}

/// A text that is no key with a value.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a key with its value, such as discretisation.spacing=0.005")]
pub struct NotAnOverride(String);

impl Override {
    /// Whether both give the same key the same value, however numbers are written.
    pub fn means(&self, other: &Override) -> bool {
        let number = |text: &str| text.parse::<f64>().ok();
        let same_number = number(&self.value).is_some_and(|own| Some(own) == number(&other.value));
        segments(&self.key) == segments(&other.key) && (self.value == other.value || same_number)
    }
}

impl FromStr for Override {
    type Err = NotAnOverride;

    fn from_str(text: &str) -> Result<Override, NotAnOverride> {
        let parts = text.split_once('=').map(|(key, value)| (key.trim(), value.trim()));
        match parts.filter(|(key, value)| !segments(key).is_empty() && !value.is_empty()) {
            // Mistakes are shown on one line each.
            Some((key, value)) => {
                Ok(Override { key: key.into(), value: value.replace(['\n', '\r'], " ") })
            }
            None => Err(NotAnOverride(text.into())),
        }
    }
}

impl TryFrom<String> for Override {
    type Error = NotAnOverride;

    fn try_from(text: String) -> Result<Override, NotAnOverride> {
        text.parse()
    }
}

impl From<Override> for String {
    fn from(given: Override) -> String {
        given.to_string()
    }
}

impl Display for Override {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "{}={}", self.key, self.value)
    }
}

/// What stands for a file in messages about overrides; its lines are the overrides.
const COMMAND_LINE: &str = "command line";

/// Where an override stands on the command line.
#[derive(Debug, Clone)]
struct Place {
    /// Its key with numbers in place of names.
    path: String,
    key: Range<usize>,
    value: Range<usize>,
}

/// The text of a case with overrides, and where each of them stands.
#[derive(Debug, Clone)]
pub(crate) struct Overridden {
    /// The text with them.
    pub text: String,
    /// What they were.
    pub overrides: Vec<Override>,
    command: String,
    places: Vec<Place>,
}

impl Overridden {
    /// Writes overrides into the text of a case, one after the other.
    pub(crate) fn new(text: &str, overrides: &[Override]) -> Result<Overridden, Diagnostic> {
        let syntax = |error: toml_edit::TomlError| {
            Diagnostic::of_file(COMMAND_LINE, error.message().to_string())
        };
        let mut document: DocumentMut = text.parse().map_err(syntax)?;
        let (mut command, mut places) = (String::new(), Vec::new());
        for given in overrides {
            let start = command.len() + "--set ".len();
            command += &format!("--set {given}\n");
            let key = start..start + given.key.len();
            let value = key.end + 1..key.end + 1 + given.value.len();
            places.push(Place { path: String::new(), key, value });
        }
        for (given, place) in overrides.iter().zip(&mut places) {
            let mistake = |on_value: bool, path: String, message: String| {
                let span = if on_value { place.value.clone() } else { place.key.clone() };
                Diagnostic::at(COMMAND_LINE, &command, span, path, message)
            };
            let value =
                value(&given.value).map_err(|message| mistake(true, given.key.clone(), message))?;
            place.path = write(document.as_item_mut(), &segments(&given.key), value)
                .map_err(|Refused { path, message, on_value }| mistake(on_value, path, message))?;
        }
        let (text, overrides) = (document.to_string(), overrides.to_vec());
        Ok(Overridden { text, overrides, command, places })
    }

    /// A mistake under a key at a path that an override has set; none where none has. Where
    /// `created`, the path is one that the file does not have.
    pub(crate) fn mistake(
        &self,
        path: &str,
        created: bool,
        on_key: bool,
        (key, message): (&str, &str),
    ) -> Option<Diagnostic> {
        let set = |place: &&Place| is_within(path, &place.path);
        let above = |place: &&Place| created && is_within(&place.path, path);
        let last = self.places.iter().rev();
        let place = last.clone().find(set).or_else(|| last.clone().find(above))?;
        let of_value = is_within(path, &place.path) && !(on_key && path == place.path);
        let span = if of_value { place.value.clone() } else { place.key.clone() };
        Some(Diagnostic::at(COMMAND_LINE, &self.command, span, key.into(), message.into()))
    }
}

/// The value of a text: TOML, or a word without quotation marks.
fn value(text: &str) -> Result<Value, String> {
    match text.parse::<Value>() {
        Ok(mut value) => {
            value.decor_mut().clear();
            Ok(value)
        }
        Err(error) if text.starts_with(['"', '\'', '[', '{']) => {
            Err(error.message().trim().replace('\n', ", "))
        }
        Err(_) => Ok(Value::from(text)),
    }
}

/// Why a value cannot be written, and whether the value or the key is at fault.
struct Refused {
    path: String,
    message: String,
    on_value: bool,
}

impl Refused {
    fn key(path: &str, message: String) -> Refused {
        Refused { path: path.into(), message, on_value: false }
    }
}

/// Writes a value under a key and returns the path of the key with numbers in place of
/// names. Tables on the way that the case does not have are made where they can be meant.
fn write(root: &mut Item, segments: &[String], value: Value) -> Result<String, Refused> {
    let (mut item, mut path) = (root, String::new());
    for (depth, segment) in segments.iter().enumerate() {
        let last = depth + 1 == segments.len();
        let here = path.clone();
        if item.as_table_like().is_some() {
            path = joined(&path, segment);
            let table = item.as_table_like_mut().ok_or_else(|| no_keys(&here))?;
            if !table.contains_key(segment) {
                if last {
                    table.insert(segment, Item::Value(value));
                    return Ok(path);
                }
                if here.is_empty() && is_list(segment) {
                    return Err(no_list(segment));
                }
                refuse_unlikely(table, segment, &path)?;
                table.insert(segment, Item::Value(InlineTable::new().into()));
            }
            item = table.get_mut(segment).ok_or_else(|| no_keys(&here))?;
        } else if item.is_array() || item.is_array_of_tables() {
            let index = entry(item, segment).ok_or_else(|| no_entry(item, segment, &here))?;
            path = joined_index(&path, index);
            item = item.get_mut(index).ok_or_else(|| no_keys(&here))?;
        } else {
            return Err(no_keys(&here));
        }
    }
    put(item, value, &path)?;
    Ok(path)
}

fn no_keys(path: &str) -> Refused {
    Refused::key(path, "is a value and has no keys".into())
}

/// Whether a case has a list of tables under a key.
fn is_list(key: &str) -> bool {
    let schema = schemars::schema_for!(CaseFormat);
    schema.get("properties").is_some_and(|keys| keys[key]["type"] == "array")
}

fn no_list(key: &str) -> Refused {
    let message = format!(
        "is a list of which this case has no entry; set whole entries: {key}=[{{ name = \"…\", … }}]"
    );
    Refused::key(key, message)
}

/// Refuses the name of a table that is most likely a slip of the finger, and one among named
/// tables such as materials, of which a single key would be no more than a part.
fn refuse_unlikely(table: &dyn TableLike, segment: &str, path: &str) -> Result<(), Refused> {
    let keys: Vec<&str> = table.iter().map(|(key, _)| key).collect();
    let named = path.contains('.') && table.iter().all(|(_, item)| item.is_table_like());
    let hint = match nearest(segment, keys.iter().copied()) {
        Some(near) => format!("; did you mean `{near}`?"),
        None if named && !keys.is_empty() => format!(", which has {}", keys.join(", ")),
        None => return Ok(()),
    };
    Err(Refused::key(path, format!("is not a table of this case{hint}")))
}

fn no_entry(list: &Item, segment: &str, path: &str) -> Refused {
    let entries = names(list);
    let known: Vec<&str> = entries.iter().flatten().map(String::as_str).collect();
    let hint = match nearest(segment, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if known.is_empty() => {
            format!("it has {}, numbered from 0", entries.len())
        }
        None => format!("its entries are {}, numbered from 0", known.join(", ")),
    };
    Refused::key(path, format!("has no entry `{segment}`; {hint}"))
}

/// Puts a value in the place of what is there; tables with headers keep them.
fn put(item: &mut Item, value: Value, path: &str) -> Result<(), Refused> {
    let refused = |what: &str| Refused {
        path: path.into(),
        message: format!("is {what}, and `{value}` is none"),
        on_value: true,
    };
    match (&mut *item, &value) {
        (Item::Value(old), _) => replace(old, value),
        (Item::Table(table), Value::InlineTable(inner)) => {
            table.clear();
            for (key, value) in inner {
                let mut value = value.clone();
                value.decor_mut().clear();
                table.insert(key, Item::Value(value));
            }
        }
        (Item::ArrayOfTables(_), Value::Array(_)) => *item = Item::Value(value),
        (Item::ArrayOfTables(_), _) => return Err(refused("a list of tables")),
        (_, _) => return Err(refused("a table")),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"title = "Block" # a comment
[material.tissue]
density = 1000 # kg/m³
[[prescribe]]
name = "bottom"
displacement = { x = 0.0, z = 0.0 }
[[prescribe]]
name = "top"
displacement = { z = 0.1 } # m
[time]
method = "static"
"#;

    fn changed(overrides: &[&str]) -> Result<Overridden, Diagnostic> {
        let overrides: Vec<Override> = overrides.iter().map(|text| text.parse().unwrap()).collect();
        Overridden::new(TEXT, &overrides)
    }

    #[test]
    fn a_value_replaces_that_of_the_file_and_keeps_the_comments() {
        for (given, line) in [
            ("material.tissue.density=1200.5", "density = 1200.5 # kg/m³"),
            ("prescribe.top.displacement.z=-0.2", "displacement = { z = -0.2 } # m"),
            ("prescribe[1].displacement.z=-0.2", "displacement = { z = -0.2 } # m"),
            ("prescribe.1.displacement={ x = 1 }", "displacement = { x = 1 } # m"),
            ("time.method=dynamic", "method = \"dynamic\""),
            ("title='A # b'", "title = 'A # b' # a comment"),
            ("title=My own block", "title = \"My own block\" # a comment"),
            ("time={method=\"dynamic\", end=2}", "[time]\nmethod = \"dynamic\"\nend = 2"),
            ("output.frames=3", "output = { frames = 3 }"),
            ("material.tissue.c.d=true", "c = { d = true }"),
            ("prescribe=[]", "= []"),
        ] {
            let text = changed(&[given]).unwrap().text;
            assert!(text.contains(line), "{given}: {text}");
        }
        let text = changed(&["time.end=1", "time.end=2"]).unwrap().text;
        assert!(text.contains("end = 2") && !text.contains("end = 1"), "{text}");
        assert_eq!(changed(&[]).unwrap().text, TEXT);
    }

    #[test]
    fn what_cannot_be_set_is_shown_on_the_command_line() {
        for (given, path, message) in [
            ("prescribe.tpo.release=1", "prescribe", "has no entry `tpo`; did you mean `top`?"),
            ("prescribe[2].release=1", "prescribe", "its entries are bottom, top, numbered from 0"),
            ("materal.tissue.density=1", "materal", "did you mean `material`?"),
            ("material.tisue.density=1", "material.tisue", "did you mean `tissue`?"),
            ("material.skin.density=1", "material.skin", "this case, which has tissue"),
            ("obstacle.floor.offset=1", "obstacle", "a list of which this case has no entry"),
            ("probe[0].name=a", "probe", "set whole entries: probe=[{ name"),
            ("title.x=1", "title", "is a value and has no keys"),
            ("time=3", "time", "is a table, and `3` is none"),
            ("prescribe=3", "prescribe", "is a list of tables"),
            ("time.end=[1", "time.end", "unclosed array"),
        ] {
            let refused = changed(&["time.end=1", given]).unwrap_err();
            assert_eq!((refused.key.as_str(), refused.location.line), (path, 2), "{refused}");
            assert!(refused.to_string().contains(message), "{refused}");
            assert!(refused.to_string().starts_with("command line:2:"), "{refused}");
        }
    }

    #[test]
    fn a_text_without_key_or_value_is_no_override() {
        for text in ["", "spacing", "=1", "spacing=", " = ", "[].=1"] {
            assert_eq!(text.parse::<Override>(), Err(NotAnOverride(text.into())));
        }
        assert_eq!("a.b = c=d".parse::<Override>().unwrap().to_string(), "a.b=c=d");
    }
}
