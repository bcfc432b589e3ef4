//! One setting after the other written into the text of a case.

use crate::scene::edit::load::scale_loads;
use crate::scene::edit::values::{EditError, float, scale, scale_rows, set, table};
use crate::scene::knob::{Knob, Level, Levels, Setting};
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Nodes of a lattice that becomes another cloud move by this fraction of their
/// distance \[–\]: a different cloud of the same quality.
const MILD_JITTER: f64 = 0.1;

/// The text of a case with other settings, applied in order.
pub fn edited(text: &str, settings: &[Setting]) -> Result<String, EditError> {
    let mut document: DocumentMut = text.parse()?;
    for setting in settings {
        change(&mut document, setting)?;
    }
    Ok(document.to_string())
}

fn change(document: &mut DocumentMut, setting: &Setting) -> Result<(), EditError> {
    let Setting { knob, level } = setting;
    match knob {
        Knob::Spacing => respace(document, level),
        Knob::Load => {
            scale_loads(document, number(setting)?);
            Ok(())
        }
        Knob::CellsPerSpacing => rescale_cells(document, number(setting)?),
        Knob::Jitter => {
            let jitter = number(setting)?;
            let recipe = table(document.as_item_mut(), &["discretisation"])?;
            refuse_given(recipe, "jitter")?;
            set(recipe, "cloud", Value::from(if jitter == 0.0 { "regular" } else { "jittered" }));
            if jitter == 0.0 {
                ["jitter", "seed"].iter().for_each(|key| drop(recipe.remove(key)))
            } else {
                set(recipe, "jitter", Value::from(jitter))
            }
            Ok(())
        }
        Knob::Cloud => another_cloud(document, number(setting)?),
        Knob::Solver => {
            let time = table(document.as_item_mut(), &["time"])?;
            for key in [
                "tolerance",
                "load_steps",
                "max_steps",
                "safety_factor",
                "reevaluate_every",
                "fixed_step",
            ] {
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
        (_, Level::Number(number)) if knob.levels() == Levels::Count => {
            Ok(Value::from(*number as i64))
        }
        (_, Level::Number(number)) => Ok(Value::from(*number)),
        (_, Level::Word(word)) => Ok(Value::from(word.as_str())),
    }
}

fn number(setting: &Setting) -> Result<f64, EditError> {
    match &setting.level {
        Level::Number(number) if number.is_finite() => Ok(*number),
        level => Err(EditError::Level {
            knob: setting.knob.name(),
            required: "number",
            level: level.clone(),
        }),
    }
}

fn refuse_given(recipe: &dyn TableLike, what: &'static str) -> Result<(), EditError> {
    match recipe.get("cloud").and_then(Item::as_str) {
        Some("file") => Err(EditError::GivenNodes(what)),
        _ => Ok(()),
    }
}

/// A spacing \[m\], or `x0.8` for 0.8 times the one that the case has.
fn respace(document: &mut DocumentMut, level: &Level) -> Result<(), EditError> {
    let recipe = table(document.as_item_mut(), &["discretisation"])?;
    refuse_given(recipe, "spacing")?;
    let old = float(recipe, "spacing")
        .ok_or_else(|| EditError::Absent("discretisation.spacing".into()))?;
    let factor = match level {
        Level::Number(spacing) => Some(spacing / old),
        Level::Word(word) => word.strip_prefix('x').and_then(|factor| factor.parse().ok()),
    };
    let factor: f64 =
        factor.filter(|factor| *factor > 0.0 && factor.is_finite()).ok_or(EditError::Level {
            knob: "spacing",
            required: "length in metres, or a factor such as x0.8",
            level: level.clone(),
        })?;
    scale(recipe, "spacing", factor);
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
        .unwrap_or(spacing / stated.unwrap_or(mtled::problem::defaults::CELLS_PER_SPACING));
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
        (None, _) => mtled::problem::defaults::SEED as i64,
    };
    set(recipe, "seed", Value::from(old + seed as i64));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
title = "Block" # a comment
[discretisation]
cloud = "graded"
spacing = 0.004 # [m]
refine = [{ where = "all", spacing = 0.003 }]
[discretisation.grid]
cell = 0.003
boundary_cell = 0.0015 # half as wide
refine = [{ where = "all", cell = 0.0015 }]
[[prescribe]]
displacement = { x = 0.01, z = 0 }
[[traction]]
traction = [0.0, 2, -4.0]
[[pressure]]
pressure = 300
"#;

    #[test]
    fn another_spacing_scales_every_length_of_the_recipe_and_keeps_the_comments() {
        let half = edited(TEXT, &[Setting::word(Knob::Spacing, "x0.5")]).unwrap();
        for line in [
            "title = \"Block\" # a comment",
            "spacing = 0.002 # [m]",
            "refine = [{ where = \"all\", spacing = 0.0015 }]",
            "cell = 0.0015\n",
            "boundary_cell = 0.00075 # half as wide",
            "refine = [{ where = \"all\", cell = 0.00075 }]",
        ] {
            assert!(half.contains(line), "{line} in {half}");
        }
        let metres = edited(TEXT, &[Setting::number(Knob::Spacing, 0.002)]).unwrap();
        assert_eq!(metres, half);
    }

    #[test]
    fn another_cell_density_keeps_the_ratio_of_small_cells() {
        let dense = edited(TEXT, &[Setting::number(Knob::CellsPerSpacing, 2.0)]).unwrap();
        assert!(dense.contains("cells_per_spacing = 2.0"), "{dense}");
        assert!(!dense.contains("\ncell ="), "{dense}");
        assert!(dense.contains("boundary_cell = 0.001 # half as wide"), "{dense}");
    }

    #[test]
    fn a_lattice_becomes_another_cloud_by_a_mild_jitter_and_cloud_0_is_the_case_itself() {
        let text = "[discretisation]\ncloud = \"regular\"\nspacing = 0.1\n";
        assert_eq!(edited(text, &[Setting::number(Knob::Cloud, 0.0)]).unwrap(), text);
        let moved = edited(text, &[Setting::number(Knob::Cloud, 3.0)]).unwrap();
        assert!(
            moved.contains("cloud = \"jittered\"") && moved.contains("jitter = 0.1"),
            "{moved}"
        );
        assert!(moved.contains("seed = 4"), "{moved}");
        assert!(edited(TEXT, &[Setting::number(Knob::Cloud, 3.0)]).unwrap().contains("seed = 3"));
    }

    #[test]
    fn a_load_scales_all_that_moves_the_body() {
        let half = edited(TEXT, &[Setting::number(Knob::Load, 0.5)]).unwrap();
        assert!(half.contains("displacement = { x = 0.005, z = 0.0 }"), "{half}");
        assert!(half.contains("traction = [0.0, 1.0, -2.0]"), "{half}");
        assert!(half.contains("pressure = 150.0"), "{half}");
    }

    #[test]
    fn what_cannot_be_changed_says_why() {
        let given = "[discretisation]\ncloud = \"file\"\n";
        let refused = edited(given, &[Setting::number(Knob::Spacing, 0.1)]);
        assert_eq!(refused, Err(EditError::GivenNodes("spacing")));
        let refused = edited(TEXT, &[Setting::word(Knob::Spacing, "small")]).unwrap_err();
        assert!(refused.to_string().contains("length in metres"), "{refused}");
    }
}
