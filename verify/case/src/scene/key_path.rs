//! Paths of keys as messages write them: `prescribe[1].where`, and `prescribe.top.where` for
//! the entry of a list with that name.

use toml_edit::{Item, TableLike};

/// `a.b[2].c` as a, b, 2, c.
pub(crate) fn segments(key: &str) -> Vec<String> {
    key.split(['.', '[', ']']).filter(|part| !part.is_empty()).map(str::to_string).collect()
}

/// Number of the entry of a list that a segment means: by its number or its name.
pub(crate) fn entry(list: &Item, segment: &str) -> Option<usize> {
    match segment.parse::<usize>() {
        Ok(index) => list.get(index).map(|_| index),
        Err(_) => names(list).iter().position(|name| name.as_deref() == Some(segment)),
    }
}

/// The names of the entries of a list, of those that have one.
pub(crate) fn names(list: &Item) -> Vec<Option<String>> {
    let entries = (0..).map_while(|index| list.get(index));
    let name = |table: &dyn TableLike| Some(table.get("name")?.as_str()?.to_string());
    entries.map(|entry| entry.as_table_like().and_then(name)).collect()
}

/// The path with numbers in place of names, as far as `root` has it; the rest as it stands.
pub(crate) fn numbered(root: &Item, key: &str) -> String {
    let mut path = String::new();
    let mut item = Some(root);
    for segment in segments(key) {
        let index = item.filter(|item| item.as_table_like().is_none());
        match index.and_then(|list| entry(list, &segment)) {
            Some(index) => {
                path = joined_index(&path, index);
                item = item.and_then(|list| list.get(index));
            }
            None => {
                path = joined(&path, &segment);
                item = item.and_then(|table| table.as_table_like()?.get(&segment));
            }
        }
    }
    path
}

/// The path of a key in the table at `path`.
pub(crate) fn joined(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_string() } else { format!("{path}.{key}") }
}

/// The path of an entry of the list at `path`.
pub(crate) fn joined_index(path: &str, index: usize) -> String {
    format!("{path}[{index}]")
}

/// Whether a path is `outer` or below it.
pub(crate) fn is_within(path: &str, outer: &str) -> bool {
    path.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}
