//! Cases and references that the program has with it.

use anyhow::Context;
use mtled_checks::report::write_atomically;
use mtled_reference::LABEL_MAPS;
use std::path::{Path, PathBuf};

pub use mtled_reference::{CASES, REFERENCES};

/// Cases that take seconds rather than parts of one: studies that solve every case many times
/// leave them out.
pub const LARGE: [&str; 2] = ["brain_gravity", "brain_shift"];

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
