//! The numbers of a case that move its body: materials, loads, prescribed values.

use mtled_case::scene::{Case, Override};
use toml_edit::{Item, TableLike, Value};

/// Lists of a case with the keys of their entries that hold such numbers.
const LISTS: [(&str, &[&str]); 6] = [
    ("prescribe", &["displacement", "rotation.angle", "formula.factor", "data.factor"]),
    ("traction", &["traction", "formula.factor"]),
    ("pressure", &["pressure"]),
    ("spring", &["normal", "tangential"]),
    ("cavity", &["fluid.bulk_modulus", "fluid.inflow"]),
    ("body_force", &["acceleration", "formula.factor"]),
];
/// Step of a number over itself \[–\]: what is left of curvature is a millionth.
const STEP: f64 = 1e-3;
/// Step of Poisson's ratio over its distance from ½, where stresses grow without bounds \[–\].
const STEP_TO_HALF: f64 = 1e-3;

/// A number of a case file.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// Its key, such as `material.tissue.young_modulus`.
    pub key: String,
    /// Its value in the unit of the case file.
    pub value: f64,
}

impl Number {
    /// Half of the distance of the two values between which it is varied.
    pub(crate) fn step(&self) -> f64 {
        let step = STEP * self.value.abs();
        if self.key.ends_with(".poisson_ratio") {
            step.min(STEP_TO_HALF * (0.5 - self.value))
        } else {
            step
        }
    }

    /// The key with so much more than the number.
    pub fn moved(&self, by: f64) -> Result<Override, mtled_case::scene::NotAnOverride> {
        format!("{}={:?}", self.key, self.value + by).parse()
    }
}

/// The numbers of a case other than 0, in the order of its file.
pub fn numbers(case: &Case) -> Vec<Number> {
    let Ok(document) = case.text().parse::<toml_edit::DocumentMut>() else { return Vec::new() };
    let mut found = Vec::new();
    if let Some(materials) = document.get("material") {
        add("material", materials, &mut found);
    }
    for (list, keys) in LISTS {
        let Some(entries) = document.get(list) else { continue };
        for (index, entry) in (0..).map_while(|index| entries.get(index).map(|own| (index, own))) {
            let path = path_of(list, index, entry);
            for key in keys {
                let inner = key.split('.').try_fold(entry, |item, part| item.get(part));
                if let Some(inner) = inner {
                    add(&format!("{path}.{key}"), inner, &mut found);
                }
            }
        }
    }
    found.retain(|number| number.value != 0.0 && number.value.is_finite());
    found
}

/// An entry by its name where that can be part of a key, or by its number.
fn path_of(list: &str, index: usize, entry: &Item) -> String {
    let name = entry.get("name").and_then(Item::as_str);
    let is_plain = |name: &&str| {
        name.chars().all(|letter| letter.is_alphanumeric() || "_- ".contains(letter))
            && name.parse::<usize>().is_err()
    };
    match name.filter(is_plain) {
        Some(name) => format!("{list}.{name}"),
        None => format!("{list}[{index}]"),
    }
}

/// Adds the numbers below a key.
fn add(path: &str, item: &Item, found: &mut Vec<Number>) {
    if let Some(table) = item.as_table_like() {
        add_table(path, table, found);
    } else if let Some(rows) = item.as_array_of_tables() {
        for (index, row) in rows.iter().enumerate() {
            add_table(&format!("{path}[{index}]"), row, found);
        }
    } else if let Some(value) = item.as_value() {
        add_value(path, value, found);
    }
}

fn add_table(path: &str, table: &dyn TableLike, found: &mut Vec<Number>) {
    for (key, item) in table.iter() {
        add(&format!("{path}.{key}"), item, found);
    }
}

fn add_value(path: &str, value: &Value, found: &mut Vec<Number>) {
    let number = value.as_float().or(value.as_integer().map(|whole| whole as f64));
    if let Some(value) = number {
        found.push(Number { key: path.into(), value });
    } else if let Some(table) = value.as_inline_table() {
        add_table(path, table, found);
    } else if let Some(values) = value.as_array() {
        for (index, value) in values.iter().enumerate() {
            add_value(&format!("{path}[{index}]"), value, found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mtled_case::bundled::CASES;
    use mtled_case::scene::{parse_case, parse_overridden};
    use std::path::Path;

    fn case(name: &str) -> Case {
        let (_, text) = CASES.iter().find(|(own, _)| *own == name).unwrap();
        parse_case(text, name, Path::new(".")).unwrap()
    }

    #[test]
    fn the_numbers_of_a_case_are_those_that_a_user_would_vary() {
        let keys: Vec<String> =
            numbers(&case("cube_shear")).into_iter().map(|number| number.key).collect();
        assert!(keys.iter().any(|key| key.ends_with(".young_modulus")), "{keys:?}");
        assert!(keys.iter().any(|key| key.starts_with("prescribe.")), "{keys:?}");
        let other = |key: &&String| {
            ["where", "name", "spacing", "duration"].iter().any(|no| key.contains(no))
        };
        assert_eq!(keys.iter().find(other), None);
    }

    #[test]
    fn every_number_of_every_bundled_case_can_be_set_under_its_key() {
        for (name, text) in CASES {
            // Those that name other files are tried by the command.
            let Ok(case) = parse_case(text, name, Path::new(".")) else { continue };
            let found = numbers(&case);
            assert!(!found.is_empty(), "{name}");
            for number in found {
                let moved = number.moved(number.step()).unwrap();
                let changed = parse_overridden(text, name, Path::new("."), &[moved]).unwrap();
                let own = |other: &Number| other.key == number.key;
                let now = numbers(&changed).into_iter().find(own).unwrap().value;
                assert!((now - number.value - number.step()).abs() < 1e-9 * now.abs(), "{name}");
            }
        }
    }
}
