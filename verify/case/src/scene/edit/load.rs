//! Scaling everything that moves a body.

use crate::scene::edit::values::{replace, rounded, scale};
use toml_edit::{DocumentMut, Item, Value};

/// Multiplies prescribed displacements and angles, tractions, pressures, inflows, body forces
/// and initial velocities.
pub(crate) fn scale_loads(document: &mut DocumentMut, factor: f64) {
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
    for name in ["formula", "data"] {
        for row in rows(document, "prescribe") {
            let Some(inner) = row.get_mut(name).and_then(Item::as_table_like_mut) else {
                continue;
            };
            if !inner.contains_key("factor") {
                inner.insert("factor", toml_edit::value(1.0));
            }
            scale(inner, "factor", factor);
        }
    }
    for row in rows(document, "pressure") {
        scale(row, "pressure", factor);
    }
    for row in rows(document, "cavity") {
        if let Some(fluid) = row.get_mut("fluid").and_then(Item::as_table_like_mut) {
            scale(fluid, "inflow", factor);
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
                    replace(value, Value::from(rounded(old * factor)));
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
