//! Keys and values of older case files: what they are called now, and the text of
//! a file rewritten with the new ones.

use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::Document;
use crate::scene::edit::EditError;
use toml_edit::Item;

/// A key of a table that has another name now, and its values that have.
struct Renamed {
    table: &'static str,
    old: &'static str,
    new: &'static str,
    /// Old and new spelling of each value.
    values: &'static [(&'static str, &'static str)],
}

const RENAMED: &[Renamed] = &[Renamed {
    table: "discretisation",
    old: "dilatation",
    new: "volumetric_projection",
    values: &[("projected", "patches"), ("pointwise", "none")],
}];

impl Renamed {
    /// The key as it is written today with its value, if `tree` has the old one.
    fn replacement(&self, tree: &Item) -> Option<String> {
        let item = tree.get(self.table)?.get(self.old)?;
        let word = item.as_str().unwrap_or_default();
        let value = self.values.iter().find(|(old, _)| *old == word).map(|(_, new)| *new);
        Some(match value {
            Some(value) => format!("{} = \"{value}\"", self.new),
            None => self.new.to_string(),
        })
    }
}

/// A diagnostic for every key of an older format.
pub fn outdated(document: &Document) -> Vec<Diagnostic> {
    let found = RENAMED.iter().filter_map(|renamed| {
        let replacement = renamed.replacement(document.tree().as_item())?;
        let message = format!(
            "is now `{replacement}`; `mtled case migrate {}` rewrites the file",
            document.file()
        );
        Some(document.diagnostic(&format!("{}.{}", renamed.table, renamed.old), message))
    });
    found.collect()
}

/// The text of a case file with today's keys and values, comments and layout kept, and
/// one line for each change.
pub fn migrated(text: &str) -> Result<(String, Vec<String>), EditError> {
    let tree = toml_edit::Document::parse(text)?;
    let (mut edits, mut changes) = (Vec::new(), Vec::new());
    for renamed in RENAMED {
        let Some(replacement) = renamed.replacement(tree.as_item()) else { continue };
        let table = tree.get(renamed.table).and_then(Item::as_table_like);
        let Some((key, item)) = table.and_then(|table| table.get_key_value(renamed.old)) else {
            continue;
        };
        edits.extend(key.span().map(|span| (span, renamed.new.to_string())));
        let value = replacement.split_once(" = ").zip(item.span());
        edits.extend(value.map(|((_, value), span)| (span, value.to_string())));
        changes.push(format!("{}.{} is now {replacement}", renamed.table, renamed.old));
    }
    // From the end, so that earlier places stay where they are.
    edits.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    let mut text = text.to_string();
    for (span, new) in edits {
        text.replace_range(span, &new);
    }
    Ok((text, changes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_old_key_and_its_value_are_rewritten_and_the_rest_is_kept() {
        for (old, new) in [("projected", "patches"), ("pointwise", "none")] {
            let before = format!(
                "title = \"x\" # dilatation\n[discretisation]\n  dilatation =   '{old}' # why\n\
                 dilation = 1.8\n"
            );
            let (after, changes) = migrated(&before).unwrap();
            let expected = before
                .replace("  dilatation =", "  volumetric_projection =")
                .replace(&format!("'{old}'"), &format!("\"{new}\""));
            assert_eq!(after, expected);
            let change =
                format!("discretisation.dilatation is now volumetric_projection = \"{new}\"");
            assert_eq!(changes, [change]);
        }
    }

    #[test]
    fn a_value_that_is_not_known_keeps_its_place_and_an_inline_table_works_too() {
        let (after, changes) = migrated("discretisation = { dilatation = 3 }").unwrap();
        assert_eq!(after, "discretisation = { volumetric_projection = 3 }");
        assert_eq!(changes, ["discretisation.dilatation is now volumetric_projection"]);
    }

    #[test]
    fn a_file_of_today_is_unchanged_and_a_mistake_of_syntax_is_reported() {
        let text = "[discretisation]\nvolumetric_projection = \"none\"\n";
        assert_eq!(migrated(text).unwrap(), (text.to_string(), Vec::new()));
        assert!(matches!(migrated("[discretisation"), Err(EditError::Syntax(_))));
    }

    #[test]
    fn an_old_key_is_reported_where_it_stands() {
        let text = "\n[discretisation]\ndilatation = \"projected\"\n";
        let document = Document::parse(text, "old.toml").unwrap();
        let found = outdated(&document);
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].location.line, found[0].key.as_str()),
            (3, "discretisation.dilatation")
        );
        assert_eq!(
            found[0].message,
            "is now `volumetric_projection = \"patches\"`; `mtled case migrate old.toml` rewrites \
             the file"
        );
    }
}
