//! The text of a case file with the place of every key in it.

use crate::scene::diagnostic::{Diagnostic, Location};
use std::ops::Range;
use toml_edit::{Item, TableLike};

/// A parsed case file with the place of every key and value.
#[derive(Debug, Clone)]
pub struct Document {
    file: String,
    text: String,
    tree: toml_edit::Document<String>,
}

impl Document {
    /// Parses `text`; a mistake of syntax is located.
    pub fn parse(text: &str, file: &str) -> Result<Document, Diagnostic> {
        match toml_edit::Document::parse(text.to_string()) {
            Ok(tree) => Ok(Document { file: file.to_string(), text: text.to_string(), tree }),
            Err(error) => {
                let span = error.span().unwrap_or(0..0);
                let message = error.message().replace('\n', ", ");
                Err(Diagnostic::at(file, text, span, String::new(), message))
            }
        }
    }

    /// The text as it was read.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The name of the file, for messages.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Its tables, with their places.
    pub fn tree(&self) -> &toml_edit::Document<String> {
        &self.tree
    }

    /// A mistake at a key path; where the path ends early, at its last part
    /// that exists.
    pub fn diagnostic(&self, key: &str, message: String) -> Diagnostic {
        let span = self.span(key).1;
        Diagnostic::at(&self.file, &self.text, span, key.to_string(), message)
    }

    /// A mistake at bytes of the text.
    pub fn diagnostic_at(&self, span: Range<usize>, key: String, message: String) -> Diagnostic {
        Diagnostic::at(&self.file, &self.text, span, key, message)
    }

    /// Place of a key path such as `prescribe[1].where`, `None` if there is no such key. A
    /// table of an array can be named too: `prescribe.top.where`.
    pub fn locate(&self, key: &str) -> Option<Location> {
        let (exists, span) = self.span(key);
        exists.then(|| Location::of(&self.file, &self.text, span.start))
    }

    /// Whether the whole path exists, and the bytes of its last part that does.
    fn span(&self, key: &str) -> (bool, Range<usize>) {
        let mut item = self.tree.as_item();
        let mut span = 0..0;
        for segment in segments(key) {
            let Some((next, place)) = step_into(item, &segment) else {
                return (false, span);
            };
            item = next;
            span = place.unwrap_or(span);
        }
        (true, span)
    }

    /// Mistakes for the first few `nan` and `inf`, which TOML allows; the last one tells
    /// how many more there are.
    pub fn numbers_that_are_not_finite(&self) -> Vec<Diagnostic> {
        const A_FEW: usize = 20;
        let mut mistakes: Vec<Diagnostic> = Vec::new();
        let mut more = 0;
        visit(self.tree.as_item(), "", &mut |path, span, item| {
            let Some(value) = item.as_float().filter(|value| !value.is_finite()) else { return };
            // A value under a key is seen with both of their places.
            if item.span().is_some_and(|own| own != span) {
                return;
            }
            match mistakes.len() < A_FEW {
                true => {
                    let message = format!("is {value}; it must be a finite number");
                    mistakes.push(self.diagnostic_at(span, path.to_string(), message));
                }
                false => more += 1,
            }
        });
        if let Some(last) = mistakes.last_mut().filter(|_| more > 0) {
            last.message += &format!("; so must {more} more numbers of the file");
        }
        mistakes
    }

    /// The path of the innermost key or value at a byte of the text.
    pub fn path_at(&self, offset: usize) -> String {
        let mut best = (usize::MAX, String::new());
        visit(self.tree.as_item(), "", &mut |path, span, _| {
            let inside = span.start <= offset && offset < span.end;
            if inside && span.len() <= best.0 {
                best = (span.len(), path.to_string());
            }
        });
        best.1
    }
}

/// `a.b[2].c` as a, b, 2, c.
fn segments(key: &str) -> Vec<String> {
    key.split(['.', '[', ']']).filter(|part| !part.is_empty()).map(str::to_string).collect()
}

/// The child called `segment` and its place.
fn step_into<'a>(item: &'a Item, segment: &str) -> Option<(&'a Item, Option<Range<usize>>)> {
    if let Some(table) = item.as_table_like() {
        let (key, child) = table.get_key_value(segment)?;
        return Some((child, child.span().or(key.span())));
    }
    let index = match segment.parse::<usize>() {
        Ok(index) => index,
        Err(_) => item.as_array_of_tables()?.iter().position(|table| {
            table.get("name").and_then(Item::as_str).is_some_and(|name| name == segment)
        })?,
    };
    let child = item.get(index)?;
    Some((child, child.span()))
}

/// Calls `see` with the path and bytes of everything below `item`.
fn visit(item: &Item, path: &str, see: &mut dyn FnMut(&str, Range<usize>, &Item)) {
    if let Some(table) = item.as_table_like() {
        visit_table(table, path, see);
        return;
    }
    for index in 0.. {
        let Some(child) = item.get(index) else { break };
        let path = format!("{path}[{index}]");
        if let Some(span) = child.span() {
            see(&path, span, child);
        }
        visit(child, &path, see);
    }
}

fn visit_table(table: &dyn TableLike, path: &str, see: &mut dyn FnMut(&str, Range<usize>, &Item)) {
    for (name, child) in table.iter() {
        let path = if path.is_empty() { name.to_string() } else { format!("{path}.{name}") };
        let key = table.key(name).and_then(|key| key.span());
        for span in key.into_iter().chain(child.span()) {
            see(&path, span, child);
        }
        visit(child, &path, see);
    }
}
