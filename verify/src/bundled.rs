//! The case files and references that the binary carries, so that it needs no checkout.

use anyhow::Context;
use mtled_checks::report::write_atomically;
use std::path::{Path, PathBuf};

macro_rules! carried {
    ($folder:literal, $ending:literal: $($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../reference/", $folder, $name, $ending)))),*]
    };
}

/// (name, text) of every case in `reference/cases`.
pub const CASES: &[(&str, &str)] = carried![
    "cases/", ".toml":
    "bonded_block",
    "brain_cube_compression",
    "brain_cube_shear",
    "brain_slice",
    "cook_membrane",
    "cube_compression",
    "cube_shear",
    "falling_beam",
    "indented_block",
    "soft_inclusion",
    "sphere_gravity",
    "turek_hron_csm1",
    "turek_hron_csm2",
    "turek_hron_csm3",
    "twisted_cylinder",
    "uniaxial_bar",
];

/// (case, text) of every reference in `reference/data`.
pub const REFERENCES: &[(&str, &str)] = carried![
    "data/", ".json":
    "bonded_block",
    "brain_cube_compression",
    "brain_cube_shear",
    "brain_slice",
    "cook_membrane",
    "cube_compression",
    "cube_shear",
    "falling_beam",
    "indented_block",
    "soft_inclusion",
    "sphere_gravity",
    "turek_hron_csm1",
    "turek_hron_csm2",
    "turek_hron_csm3",
    "twisted_cylinder",
    "uniaxial_bar",
];

const SLICE: &[u8] = include_bytes!("../../reference/brain/slice.nrrd");

/// Writes the carried cases to `dir/cases` and the label map to `dir/brain`,
/// where the cases look for it; returns the folder of the cases.
pub fn unpack(dir: &Path) -> anyhow::Result<PathBuf> {
    let cases = dir.join("cases");
    for (name, text) in CASES {
        write_atomically(&cases.join(format!("{name}.toml")), text.as_bytes())?;
    }
    write_atomically(&dir.join("brain").join("slice.nrrd"), SLICE)
        .context("cannot write the label map of the brain slice")?;
    Ok(cases)
}

/// The carried reference of a case.
pub fn carried_reference(case: &str) -> Option<&'static str> {
    REFERENCES.iter().find(|(name, _)| *name == case).map(|(_, text)| *text)
}
