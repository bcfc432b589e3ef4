//! Cases, references and templates that the program has with it.

use crate::scene::nearest;
use anyhow::Context;
use mtled_checks::report::write_atomically;
use mtled_reference::LABEL_MAPS;
use std::path::{Path, PathBuf};

pub use mtled_reference::{CASES, REFERENCES};

/// A commented case to start from.
#[derive(Debug)]
pub struct Template {
    /// Name.
    pub name: &'static str,
    /// What it is a start for.
    pub purpose: &'static str,
    /// Text of the case file.
    pub text: &'static str,
}

/// The templates, the simplest first.
pub static TEMPLATES: [Template; 6] = [
    Template {
        name: "block",
        purpose: "a block between two plates, at rest",
        text: include_str!("templates/block.toml"),
    },
    Template {
        name: "beam",
        purpose: "a beam that swings under its weight, in time",
        text: include_str!("templates/beam.toml"),
    },
    Template {
        name: "ball",
        purpose: "a ball that is pressed onto a floor, with contact",
        text: include_str!("templates/ball.toml"),
    },
    Template {
        name: "brain",
        purpose: "brain tissue that relaxes while it is held, with the constants of the literature",
        text: include_str!("templates/brain.toml"),
    },
    Template {
        name: "surface",
        purpose: "a body inside a closed surface (STL, OBJ, PLY, VTK)",
        text: include_str!("templates/surface.toml"),
    },
    Template {
        name: "image",
        purpose: "a body from a label map (NRRD, NIfTI) with regions and a cavity",
        text: include_str!("templates/image.toml"),
    },
];

/// Cases that take seconds rather than parts of one: studies that solve every case many times
/// leave them out.
pub const LARGE: [&str; 2] = ["brain_gravity", "brain_shift"];

/// Why a name is no case.
pub fn no_such_case(name: &str) -> String {
    let meant = nearest(name, CASES.iter().map(|(name, _)| *name));
    let hint = meant.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    format!(
        "there is no such file, and no bundled case of that name{hint} (`mtled case list` prints their names)"
    )
}

/// Writes the bundled cases to `dir/cases` and the label maps to `dir/brain`,
/// where the cases look for them; returns the folder of the cases.
pub fn unpack(dir: &Path) -> anyhow::Result<PathBuf> {
    let cases = dir.join("cases");
    for (name, text) in CASES {
        write_atomically(&cases.join(format!("{name}.toml")), text.as_bytes())?;
    }
    write_label_maps(dir, |_| true)?;
    Ok(cases)
}

/// Writes the label maps that the text of a bundled case names to `dir/brain`; returns the folder
/// in which it is to be read.
pub fn unpack_label_maps_of(text: &str, dir: &Path) -> anyhow::Result<PathBuf> {
    let cases = dir.join("cases");
    std::fs::create_dir(&cases).context("cannot make the folder of a bundled case")?;
    write_label_maps(dir, |name| text.contains(name))?;
    Ok(cases)
}

fn write_label_maps(dir: &Path, chosen: impl Fn(&str) -> bool) -> anyhow::Result<()> {
    for (name, bytes) in LABEL_MAPS.iter().filter(|(name, _)| chosen(name)) {
        write_atomically(&dir.join("brain").join(name), bytes)
            .with_context(|| format!("cannot write the label map {name}"))?;
    }
    Ok(())
}

/// Names of the bundled cases that are quickly solved.
pub fn small_cases() -> impl Iterator<Item = &'static str> {
    CASES.iter().map(|(name, _)| *name).filter(|name| !LARGE.contains(name))
}

/// The bundled reference of a case.
pub fn bundled_reference(case: &str) -> Option<&'static str> {
    REFERENCES.iter().find(|(name, _)| *name == case).map(|(_, text)| *text)
}
