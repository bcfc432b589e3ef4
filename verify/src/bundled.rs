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

const SLICE: &[u8] = include_bytes!("../../reference/brain/slice.nrrd");

/// Writes the bundled cases to `dir/cases` and the label map to `dir/brain`,
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

/// The bundled reference of a case.
pub fn bundled_reference(case: &str) -> Option<&'static str> {
    REFERENCES.iter().find(|(name, _)| *name == case).map(|(_, text)| *text)
}
