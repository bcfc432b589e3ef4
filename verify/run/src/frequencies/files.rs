//! Files of natural frequencies.

use super::measure::Found;
use super::text::to_json;
use crate::run::write_modes;
use anyhow::Result;
use mtled_checks::report::write_atomically;
use std::path::Path;

/// Writes `frequencies.json` and the modes as VTU files to a folder.
pub fn write_modes_of(found: &Found, folder: &Path) -> Result<()> {
    let motions: Vec<&[f64]> = found.modes.modes.iter().map(|mode| &mode.motion[..]).collect();
    write_modes(&found.simulation, &motions, folder)?;
    write_atomically(&folder.join("frequencies.json"), format!("{}\n", to_json(found)).as_bytes())
}
