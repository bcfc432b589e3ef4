//! Scaling all that moves a body, and moving the file itself, in the text of a case.

use crate::scene::edit::{rounded, scale};
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
            let decor = value.decor().clone();
            *value = Value::from(path.display().to_string());
            *value.decor_mut() = decor;
        }
        visit_table_like_kv_mut(self, key, node);
    }
}

/// The text of a case that may stand in any folder: files that it refers to, found from
/// `base` so far, get their whole path.
pub fn movable(text: &str, base: &Path) -> Result<String, toml_edit::TomlError> {
    let mut document: DocumentMut = text.parse()?;
    Absolute { base }.visit_document_mut(&mut document);
    Ok(document.to_string())
}

/// Multiplies prescribed displacements and angles, tractions, body forces and initial
/// velocities.
pub(super) fn scale_loads(document: &mut DocumentMut, factor: f64) {
    let numbers = [
        ("prescribe", "displacement", &["x", "y", "z"][..]),
        ("prescribe", "rotation", &["angle"][..]),
    ];
    for (list, inner, keys) in numbers {
        for row in rows(document, list) {
            let Some(inner) = row.get_mut(inner).and_then(Item::as_table_like_mut) else {
                continue;
            };
            keys.iter().for_each(|key| scale(inner, key, factor));
        }
    }
    let triples = [
        ("traction", "traction"),
        ("body_force", "acceleration"),
        ("initial_velocity", "velocity"),
    ];
    for (list, key) in triples {
        for row in rows(document, list) {
            let Some(array) = row.get_mut(key).and_then(Item::as_array_mut) else { continue };
            for value in array.iter_mut() {
                let old = value.as_float().or(value.as_integer().map(|whole| whole as f64));
                if let Some(old) = old {
                    let decor = value.decor().clone();
                    *value = Value::from(rounded(old * factor));
                    *value.decor_mut() = decor;
                }
            }
        }
    }
}

/// The tables of a list such as `[[prescribe]]`.
fn rows<'a>(document: &'a mut DocumentMut, list: &str) -> Vec<&'a mut toml_edit::Table> {
    let tables = document.get_mut(list).and_then(Item::as_array_of_tables_mut);
    tables.map_or(Vec::new(), |tables| tables.iter_mut().collect())
}
