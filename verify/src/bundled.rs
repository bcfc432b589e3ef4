//! Case files and references inside the binary, which needs no checkout.

use anyhow::Context;
use mtled_checks::report::write_atomically;
use std::path::{Path, PathBuf};

/// Includes the files of cases by name.
macro_rules! bundled {
    ($($name:literal)*) => {
        /// (name, text) of every case in `reference/cases`.
        pub const CASES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../reference/cases/", $name, ".toml")))),*];

        /// (case, text) of every reference in `reference/data`.
        pub const REFERENCES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../reference/data/", $name, ".json")))),*];
    };
}

bundled! {
    "bonded_block"
    "brain_cube_compression"
    "brain_cube_shear"
    "brain_gravity"
    "brain_shift"
    "brain_slice"
    "cook_membrane"
    "cube_compression"
    "cube_shear"
    "falling_beam"
    "indented_block"
    "soft_inclusion"
    "sphere_gravity"
    "turek_hron_csm1"
    "turek_hron_csm2"
    "turek_hron_csm3"
    "twisted_cylinder"
    "uniaxial_bar"
}

/// Cases that take seconds rather than parts of one: studies that solve every case many times
/// leave them out.
pub const LARGE: [&str; 2] = ["brain_gravity", "brain_shift"];

/// (file, bytes) of the label maps in `reference/brain`.
const LABEL_MAPS: [(&str, &[u8]); 2] = [
    ("brain.nrrd", include_bytes!("../../reference/brain/brain.nrrd")),
    ("slice.nrrd", include_bytes!("../../reference/brain/slice.nrrd")),
];

/// Writes the bundled cases to `dir/cases` and the label maps to `dir/brain`,
/// where the cases look for them; returns the folder of the cases.
pub fn unpack(dir: &Path) -> anyhow::Result<PathBuf> {
    let cases = dir.join("cases");
    for (name, text) in CASES {
        write_atomically(&cases.join(format!("{name}.toml")), text.as_bytes())?;
    }
    for (name, bytes) in LABEL_MAPS {
        write_atomically(&dir.join("brain").join(name), bytes)
            .with_context(|| format!("cannot write the label map {name}"))?;
    }
    Ok(cases)
}

/// Names of the bundled cases that are quickly solved.
pub fn small_cases() -> impl Iterator<Item = &'static str> {
    CASES.iter().map(|(name, _)| *name).filter(|name| !LARGE.contains(name))
}

/// The bundled reference of a case.
pub fn bundled_reference(case: &str) -> Option<&'static str> {
    REFERENCES.iter().find(|(name, _)| *name == case).map(|(_, text)| *text)
}
