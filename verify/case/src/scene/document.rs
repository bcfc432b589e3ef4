//! The text of a case file with the place of every key in it.

use crate::scene::diagnostic::{Diagnostic, Location};
use crate::scene::edit::{Overridden, Override};
use crate::scene::key_path::{entry, numbered, segments};
use std::ops::Range;
use toml_edit::{Item, TableLike};

/// A parsed case file with the place of every key and value.
#[derive(Debug, Clone)]
pub struct Document {
    file: String,
    text: String,
    tree: toml_edit::Document<String>,
    changed: Option<Box<Changed>>,
}

/// The file before its overrides.
#[derive(Debug, Clone)]
struct Changed {
    original: Document,
    overridden: Overridden,
}

impl Document {
    /// Parses `text`; a mistake of syntax is located.
    pub fn parse(text: &str, file: &str) -> Result<Document, Diagnostic> {
        match toml_edit::Document::parse(text.to_string()) {
            Ok(tree) => Ok(Document { file: file.into(), text: text.into(), tree, changed: None }),
            Err(error) => {
                let span = error.span().unwrap_or(0..0);
                let message = error.message().replace('\n', ", ");
                Err(Diagnostic::at(file, text, span, String::new(), message))
            }
        }
    }

    /// As [`Document::parse`], with overrides. Mistakes in these are located on the command
    /// line, others where they are in `text`.
    pub(crate) fn overridden(
        text: &str,
        file: &str,
        overrides: &[Override],
    ) -> Result<Document, Diagnostic> {
        let original = Document::parse(text, file)?;
        if overrides.is_empty() {
            return Ok(original);
        }
        let overridden = Overridden::new(text, overrides)?;
        let changed = Document::parse(&overridden.text, file)?;
        Ok(Document { changed: Some(Box::new(Changed { original, overridden })), ..changed })
    }

    /// What stands under its keys in place of what the file has.
    pub(crate) fn overrides(&self) -> &[Override] {
        self.changed.as_ref().map_or(&[], |changed| &changed.overridden.overrides)
    }

    /// The text as it was read, with the overrides.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// The name of the file, for messages.
    pub(crate) fn file(&self) -> &str {
        &self.file
    }

    /// Its tables, with their places.
    pub(crate) fn tree(&self) -> &toml_edit::Document<String> {
        &self.tree
    }

    /// A mistake at a key path; where the path ends early, at its last part
    /// that exists.
    pub fn diagnostic(&self, key: &str, message: String) -> Diagnostic {
        self.diagnostic_at(self.span(key).1, key.to_string(), message)
    }

    /// A mistake at bytes of the text.
    pub(crate) fn diagnostic_at(
        &self,
        span: Range<usize>,
        key: String,
        message: String,
    ) -> Diagnostic {
        let Some(changed) = &self.changed else {
            return Diagnostic::at(&self.file, &self.text, span, key, message);
        };
        let path = numbered(self.tree.as_item(), &key);
        let known = known_part(self, &path);
        let created = !changed.original.span(known).0;
        let on_key = segments(&key).last().map(String::as_str) == self.text.get(span.clone());
        let mistake = |path: &str, created: bool| {
            changed.overridden.mistake(path, created, on_key, (&key, &message))
        };
        mistake(&path, false)
            .or_else(|| mistake(known, created))
            .unwrap_or_else(|| changed.in_the_file(&self.text, span, key, message))
    }

    /// Place of a key path such as `prescribe[1].where`, `None` if there is no such key. A
    /// table of an array can be named too: `prescribe.top.where`.
    pub(crate) fn locate(&self, key: &str) -> Option<Location> {
        let (exists, span) = self.span(key);
        exists.then(|| self.diagnostic_at(span, key.to_string(), String::new()).location)
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
    pub(crate) fn numbers_that_are_not_finite(&self) -> Vec<Diagnostic> {
        const A_FEW: usize = 20;
        let mut mistakes: Vec<Diagnostic> = Vec::new();
        let mut more = 0;
        visit(self.tree.as_item(), "", &mut |path, span, item| {
            let Some(value) = item.as_float().filter(|value| !value.is_finite()) else { return };
            // A value under a key is seen with both of their places.
            if item.span().is_some_and(|own| own != span) {
                return;
            }
            if mistakes.len() < A_FEW {
                let message = format!("is {value}; it must be a finite number");
                mistakes.push(self.diagnostic_at(span, path.to_string(), message));
            } else {
                more += 1;
            }
        });
        if let Some(last) = mistakes.last_mut().filter(|_| more > 0) {
            last.message += &format!("; so must {more} more numbers of the file");
        }
        mistakes
    }

    /// The path of the innermost key or value at a byte of the text.
    pub(crate) fn path_at(&self, offset: usize) -> String {
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

impl Changed {
    /// A mistake that no override has made: `span` of `text` is looked for in the file, before
    /// or behind all that the overrides have changed, else by its key.
    fn in_the_file(
        &self,
        text: &str,
        span: Range<usize>,
        key: String,
        message: String,
    ) -> Diagnostic {
        let original = &self.original;
        let pairs = || text.bytes().zip(original.text.bytes());
        let before = pairs().take_while(|(a, b)| a == b).count();
        let backward = text.bytes().rev().zip(original.text.bytes().rev());
        let behind = backward.take_while(|(a, b)| a == b).count();
        let own = match (span.end <= before, text.len() - span.start <= behind) {
            (true, _) => span,
            (false, true) => {
                let end = |place: usize| original.text.len() - (text.len() - place);
                end(span.start)..end(span.end)
            }
            (false, false) => original.span(&key).1,
        };
        original.diagnostic_at(own, key, message)
    }
}

/// The part of a path that a document has.
fn known_part<'a>(document: &Document, path: &'a str) -> &'a str {
    let mut known = path;
    while !known.is_empty() && !document.span(known).0 {
        known = known.rfind(['.', '[']).map_or("", |end| &known[..end]);
    }
    known
}

/// The child called `segment` and its place.
fn step_into<'a>(item: &'a Item, segment: &str) -> Option<(&'a Item, Option<Range<usize>>)> {
    if let Some(table) = item.as_table_like() {
        let (key, child) = table.get_key_value(segment)?;
        return Some((child, child.span().or(key.span())));
    }
    let child = item.get(entry(item, segment)?)?;
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
