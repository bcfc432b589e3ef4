//! Names of other files in the text of a case.

use crate::scene::edit::values::replace;
use std::path::Path;
use toml_edit::visit_mut::{VisitMut, visit_table_like_kv_mut};
use toml_edit::{DocumentMut, Item, KeyMut, Value};

/// Makes the names of other files absolute.
struct Absolute<'a> {
    base: &'a Path,
}

impl VisitMut for Absolute<'_> {
    fn visit_table_like_kv_mut(&mut self, key: KeyMut<'_>, node: &mut Item) {
        if key.get() == "file"
            && let Some(value) = node.as_value_mut()
            && let Some(name) = value.as_str()
        {
            let path = self.base.join(name);
            let path = path.canonicalize().unwrap_or(path);
            replace(value, Value::from(path.display().to_string()));
        }
        visit_table_like_kv_mut(self, key, node);
    }
}

/// The text of a case with absolute paths for the files that it names relative to
/// `base`, so that it can be stored in any folder.
pub fn with_absolute_paths(text: &str, base: &Path) -> Result<String, toml_edit::TomlError> {
    let mut document: DocumentMut = text.parse()?;
    Absolute { base }.visit_document_mut(&mut document);
    Ok(document.to_string())
}
