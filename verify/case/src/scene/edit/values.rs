//! Reading and replacing values in the text of a case.

use crate::scene::knob::Level;
use toml_edit::{Item, TableLike, Value};

/// Why a case cannot be changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EditError {
    /// The text is not TOML.
    #[error("{0}")]
    Syntax(String),
    /// There is no such key or table.
    #[error("the case has no {0} to change")]
    Absent(String),
    /// The level is of the wrong kind.
    #[error("{knob} needs a {required}, not `{level}`")]
    Level {
        /// Name of the knob.
        knob: &'static str,
        /// What it needs instead.
        required: &'static str,
        /// What was asked for.
        level: Level,
    },
    /// The positions of nodes that come from a file are fixed.
    #[error("nodes that come from a file cannot be given another {0}")]
    GivenNodes(&'static str),
}

impl From<toml_edit::TomlError> for EditError {
    fn from(error: toml_edit::TomlError) -> EditError {
        EditError::Syntax(error.to_string())
    }
}

/// The table at a path; a missing inner one is created.
pub(crate) fn table<'a>(
    item: &'a mut Item,
    path: &[&str],
) -> Result<&'a mut dyn TableLike, EditError> {
    let absent = || EditError::Absent(path.join("."));
    let mut item = item;
    for (depth, key) in path.iter().enumerate() {
        let parent = item.as_table_like_mut().ok_or_else(absent)?;
        if !parent.contains_key(key) {
            if depth == 0 {
                return Err(absent());
            }
            parent.insert(key, Item::Value(toml_edit::InlineTable::new().into()));
        }
        item = parent.get_mut(key).ok_or_else(absent)?;
    }
    item.as_table_like_mut().ok_or_else(absent)
}

/// Replaces a value and keeps the text around it, such as a comment.
pub(crate) fn replace(old: &mut Value, mut new: Value) {
    *new.decor_mut() = old.decor().clone();
    *old = new;
}

/// Sets a key to a value.
pub(crate) fn set(table: &mut dyn TableLike, key: &str, new: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => replace(old, new),
        None => drop(table.insert(key, Item::Value(new))),
    }
}

/// The number under a key, whole or not.
pub(crate) fn float(table: &dyn TableLike, key: &str) -> Option<f64> {
    let item = table.get(key)?;
    item.as_float().or_else(|| item.as_integer().map(|number| number as f64))
}

/// Multiplies the number under a key, if it is there.
pub(crate) fn scale(table: &mut dyn TableLike, key: &str, factor: f64) {
    if let Some(old) = float(table, key) {
        set(table, key, Value::from(rounded(old * factor)));
    }
}

/// Multiplies a number in every row of a list of tables, if it is there.
pub(crate) fn scale_rows(table: &mut dyn TableLike, list: &str, key: &str, factor: f64) {
    let Some(item) = table.get_mut(list) else { return };
    for index in 0.. {
        let Some(row) = item.get_mut(index).and_then(Item::as_table_like_mut) else { break };
        scale(row, key, factor);
    }
}

/// Nine digits are enough for a length, and read better than seventeen.
pub(crate) fn rounded(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}
