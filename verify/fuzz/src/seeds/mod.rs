//! Valid inputs: those in `seeds/`, the bundled cases on coarse clouds, and small binary
//! files that are made here.

mod binary;

use crate::mutate::Input;
use crate::target::Target;
use anyhow::{Context, Result};
use mtled_case::bundled::{CASES, LARGE, bundled_reference};
use mtled_case::scene::{Knob, Setting, edited};
use std::path::{Path, PathBuf};

/// The folder of this crate.
pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Names and contents of the files beside every input.
pub(crate) fn companions() -> Result<Vec<(String, Vec<u8>)>> {
    let mut all = files(&folder().join("seeds/companions"))?;
    all.push(("slice.nrrd".into(), read(&folder().join("../../reference/brain/slice.nrrd"))?));
    all.push(("voxels.raw".into(), binary::VOXELS.to_vec()));
    all.push(("results.json".into(), read(&folder().join("seeds/report/sample.json"))?));
    Ok(all)
}

/// Valid inputs of a target.
pub fn inputs(target: Target) -> Result<Vec<Input>> {
    let mut all = Vec::new();
    for (name, bytes) in files(&folder().join("seeds").join(target.seeds()))? {
        all.push(Input::new(bytes, name.split_once('.').map_or("", |(_, extension)| extension)));
    }
    match target {
        Target::Case | Target::Inspect | Target::Solve => all.extend(bundled()?),
        Target::LabelMap => all.extend(binary::label_maps()),
        Target::Surface => all.extend(binary::surfaces(&companions()?)),
        Target::Points => all.extend(binary::points()?),
        Target::Reference => {
            let text = bundled_reference("cook_membrane").context("no such reference")?;
            all.push(Input::new(text, "json"));
        }
        Target::Trap => all.push(Input::new("a trap", "txt")),
        Target::Store
        | Target::Report
        | Target::Baseline
        | Target::Plan
        | Target::Job
        | Target::Answer
        | Target::Scene => {}
    }
    Ok(all)
}

/// The bundled cases on clouds of twice their spacing, without those that take seconds to read.
fn bundled() -> Result<Vec<Input>> {
    let coarse = [Setting::word(Knob::Spacing, "x2")];
    let case = |(_, text): &(&str, &str)| {
        Ok(Input::new(edited(text, &coarse)?.replace("../brain/", ""), "toml"))
    };
    CASES.iter().filter(|(name, _)| !LARGE.contains(name)).map(case).collect()
}

/// Names and contents of the files in a folder, by name; none where it is not there.
fn files(folder: &Path) -> Result<Vec<(String, Vec<u8>)>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        all.push((entry.file_name().to_string_lossy().into_owned(), read(&entry.path())?));
    }
    all.sort();
    Ok(all)
}

fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))
}
