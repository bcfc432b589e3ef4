//! Changes to the recipe of a case file: the text stays as it was written,
//! comments and all, but for the keys that change.

use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Nodes of a lattice that becomes another cloud move by this share of their
/// distance \[–\]: enough to be another cloud, too little to be a poor one.
const MILD_JITTER: f64 = 0.1;

/// What may be changed about a recipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Knob {
    /// Node spacing \[m\]; every other length of the recipe is scaled with it.
    Spacing,
    /// Influence radius over node spacing \[–\].
    Dilation,
    /// Cells along a node spacing \[–\]; smaller cells keep their ratio.
    CellsPerSpacing,
    GaussPoints,
    Basis,
    WeightFunction,
    Mass,
    Enforcement,
    Gradients,
    Dilatation,
    /// Largest random move over the spacing \[–\]; a lattice becomes jittered.
    Jitter,
    /// Another cloud of the same spacing: added to the seed of a jittered or
    /// graded cloud; a lattice is jittered by a tenth. 0 changes nothing.
    Cloud,
    /// Step over the critical one \[–\].
    SafetyFactor,
    /// How a static solution is found.
    Solver,
    /// Of a static solution \[–\].
    Tolerance,
}

/// Every knob, its name on the command line and in plans, and its key.
pub const KNOBS: &[(Knob, &str, &[&str])] = &[
    (Knob::Spacing, "spacing", &["discretisation", "spacing"]),
    (Knob::Dilation, "dilation", &["discretisation", "dilation"]),
    (Knob::CellsPerSpacing, "cells_per_spacing", &["discretisation", "grid", "cells_per_spacing"]),
    (Knob::GaussPoints, "gauss_points", &["discretisation", "grid", "gauss_points"]),
    (Knob::Basis, "basis", &["discretisation", "basis"]),
    (Knob::WeightFunction, "weight_function", &["discretisation", "weight_function"]),
    (Knob::Mass, "mass", &["discretisation", "mass"]),
    (Knob::Enforcement, "enforcement", &["discretisation", "enforcement"]),
    (Knob::Gradients, "gradients", &["discretisation", "gradients"]),
    (Knob::Dilatation, "dilatation", &["discretisation", "dilatation"]),
    (Knob::Jitter, "jitter", &["discretisation", "jitter"]),
    (Knob::Cloud, "cloud", &["discretisation", "seed"]),
    (Knob::SafetyFactor, "safety_factor", &["time", "safety_factor"]),
    (Knob::Solver, "solver", &["time", "solver"]),
    (Knob::Tolerance, "tolerance", &["time", "tolerance"]),
];

impl Knob {
    pub fn name(self) -> &'static str {
        KNOBS.iter().find(|row| row.0 == self).map_or("", |row| row.1)
    }

    fn path(self) -> &'static [&'static str] {
        KNOBS.iter().find(|row| row.0 == self).map_or(&[], |row| row.2)
    }
}

/// A number or a word.
#[derive(Debug, Clone, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Level {
    Number(f64),
    Word(String),
}

impl Display for Level {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Level::Number(number) => write!(out, "{number}"),
            Level::Word(word) => write!(out, "{word}"),
        }
    }
}

/// One change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    pub knob: Knob,
    pub level: Level,
}

impl Setting {
    pub fn number(knob: Knob, value: f64) -> Setting {
        Setting { knob, level: Level::Number(value) }
    }

    pub fn word(knob: Knob, word: &str) -> Setting {
        Setting { knob, level: Level::Word(word.to_string()) }
    }
}

impl Display for Setting {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "{} {}", self.knob.name(), self.level)
    }
}

/// Why a case cannot be changed so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EditError {
    #[error("{0}")]
    Syntax(String),
    #[error("the case has no {0} to change")]
    Absent(String),
    #[error("{knob} needs a {wanted}, not `{level}`")]
    Level { knob: &'static str, wanted: &'static str, level: Level },
    #[error("nodes that come from a file cannot be given another {0}")]
    GivenNodes(&'static str),
}

/// The case file with other settings, in the order in which they stand.
pub fn edited(text: &str, settings: &[Setting]) -> Result<String, EditError> {
    let mut document: DocumentMut =
        text.parse().map_err(|error: toml_edit::TomlError| EditError::Syntax(error.to_string()))?;
    for setting in settings {
        change(&mut document, setting)?;
    }
    Ok(document.to_string())
}

fn change(document: &mut DocumentMut, setting: &Setting) -> Result<(), EditError> {
    let Setting { knob, level } = setting;
    match knob {
        Knob::Spacing => respace(document, number(setting)?),
        Knob::CellsPerSpacing => rescale_cells(document, number(setting)?),
        Knob::Jitter => {
            let jitter = number(setting)?;
            let recipe = table(document.as_item_mut(), &["discretisation"])?;
            refuse_given(recipe, "jitter")?;
            set(recipe, "cloud", Value::from(if jitter == 0.0 { "regular" } else { "jittered" }));
            match jitter == 0.0 {
                true => ["jitter", "seed"].iter().for_each(|key| drop(recipe.remove(key))),
                false => set(recipe, "jitter", Value::from(jitter)),
            }
            Ok(())
        }
        Knob::Cloud => another_cloud(document, number(setting)?),
        Knob::Solver => {
            let time = table(document.as_item_mut(), &["time"])?;
            for key in
                ["tolerance", "load_steps", "max_steps", "safety_factor", "reevaluate_every", "fixed_step"]
            {
                time.remove(key);
            }
            set(time, "solver", value(knob, level)?);
            Ok(())
        }
        _ => {
            let path = knob.path();
            let parent = table(document.as_item_mut(), &path[..path.len() - 1])?;
            set(parent, path[path.len() - 1], value(knob, level)?);
            Ok(())
        }
    }
}

/// The level as it is written under the key.
fn value(knob: &Knob, level: &Level) -> Result<Value, EditError> {
    match (knob, level) {
        (Knob::GaussPoints, Level::Number(number)) => Ok(Value::from(*number as i64)),
        (_, Level::Number(number)) => Ok(Value::from(*number)),
        (_, Level::Word(word)) => Ok(Value::from(word.as_str())),
    }
}

fn number(setting: &Setting) -> Result<f64, EditError> {
    match &setting.level {
        Level::Number(number) if number.is_finite() => Ok(*number),
        level => Err(EditError::Level {
            knob: setting.knob.name(),
            wanted: "number",
            level: level.clone(),
        }),
    }
}

/// The table at a path; a missing last one is made.
fn table<'a>(
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

/// Replaces a value; what stands around it, such as a comment, stays.
fn set(table: &mut dyn TableLike, key: &str, mut new: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            *new.decor_mut() = old.decor().clone();
            *old = new;
        }
        None => drop(table.insert(key, Item::Value(new))),
    }
}

fn float(table: &dyn TableLike, key: &str) -> Option<f64> {
    let item = table.get(key)?;
    item.as_float().or_else(|| item.as_integer().map(|number| number as f64))
}

/// Multiplies the number under a key, if it is there.
fn scale(table: &mut dyn TableLike, key: &str, factor: f64) {
    if let Some(old) = float(table, key) {
        set(table, key, Value::from(rounded(old * factor)));
    }
}

/// Multiplies a number in every row of a list of tables, if it is there.
fn scale_rows(table: &mut dyn TableLike, list: &str, key: &str, factor: f64) {
    let Some(item) = table.get_mut(list) else { return };
    for index in 0.. {
        let Some(row) = item.get_mut(index).and_then(Item::as_table_like_mut) else { break };
        scale(row, key, factor);
    }
    // Rows of an array in one line are values, not items.
    if let Some(array) = item.as_array_mut() {
        for row in array.iter_mut().filter_map(Value::as_inline_table_mut) {
            scale(row, key, factor);
        }
    }
}

/// Nine digits are enough for a length, and read better than seventeen.
fn rounded(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}

fn refuse_given(recipe: &dyn TableLike, what: &'static str) -> Result<(), EditError> {
    match recipe.get("cloud").and_then(Item::as_str) {
        Some("file") => Err(EditError::GivenNodes(what)),
        _ => Ok(()),
    }
}

fn respace(document: &mut DocumentMut, spacing: f64) -> Result<(), EditError> {
    let recipe = table(document.as_item_mut(), &["discretisation"])?;
    refuse_given(recipe, "spacing")?;
    let old = float(recipe, "spacing")
        .ok_or_else(|| EditError::Absent("discretisation.spacing".into()))?;
    let factor = spacing / old;
    set(recipe, "spacing", Value::from(spacing));
    scale_rows(recipe, "refine", "spacing", factor);
    scale_grid(recipe, factor);
    Ok(())
}

/// Scales every edge of cells that is stated.
fn scale_grid(recipe: &mut dyn TableLike, factor: f64) {
    let Some(grid) = recipe.get_mut("grid").and_then(Item::as_table_like_mut) else { return };
    scale(grid, "cell", factor);
    scale(grid, "boundary_cell", factor);
    scale_rows(grid, "refine", "cell", factor);
}

fn rescale_cells(document: &mut DocumentMut, ratio: f64) -> Result<(), EditError> {
    let recipe = table(document.as_item_mut(), &["discretisation"])?;
    refuse_given(recipe, "cells_per_spacing")?;
    let spacing = float(recipe, "spacing")
        .ok_or_else(|| EditError::Absent("discretisation.spacing".into()))?;
    let grid = recipe.get("grid").and_then(Item::as_table_like);
    let stated = grid.and_then(|grid| float(grid, "cells_per_spacing"));
    let old = grid
        .and_then(|grid| float(grid, "cell"))
        .unwrap_or(spacing / stated.unwrap_or(super::defaults::CELLS_PER_SPACING));
    scale_grid(recipe, spacing / ratio / old);
    let grid = table(document.as_item_mut(), &["discretisation", "grid"])?;
    grid.remove("cell");
    set(grid, "cells_per_spacing", Value::from(ratio));
    Ok(())
}

fn another_cloud(document: &mut DocumentMut, seed: f64) -> Result<(), EditError> {
    let recipe = table(document.as_item_mut(), &["discretisation"])?;
    refuse_given(recipe, "seed")?;
    if seed == 0.0 {
        return Ok(());
    }
    if recipe.get("cloud").and_then(Item::as_str) == Some("regular") {
        set(recipe, "cloud", Value::from("jittered"));
        set(recipe, "jitter", Value::from(MILD_JITTER));
    }
    let old = match (recipe.get("seed").and_then(Item::as_integer), recipe.get("cloud")) {
        (Some(old), _) => old,
        (None, Some(cloud)) if cloud.as_str() == Some("graded") => 0,
        (None, _) => super::defaults::SEED as i64,
    };
    set(recipe, "seed", Value::from(old + seed as i64));
    Ok(())
}
