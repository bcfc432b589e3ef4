//! Inputs of earlier findings, a file each: `corpus/<target>/<kind>-<hash>.<extension>.input`.

use crate::finding::Kind;
use crate::mutate::Input;
use crate::target::Target;
use anyhow::{Context, Result};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// Ends every name, so that no other tool takes the files for sources.
const ENDING: &str = ".input";

/// The inputs of a target with their paths, by name.
pub(crate) fn read(folder: &Path, target: Target) -> Result<Vec<(PathBuf, Input)>> {
    let folder = folder.join(target.name());
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let entries = std::fs::read_dir(&folder).with_context(|| folder.display().to_string())?;
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<_, _>>()?;
    paths.sort();
    let mut inputs = Vec::new();
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let extension = name.strip_suffix(ENDING).and_then(|name| name.split_once('.'));
        if let Some((_, extension)) = extension {
            let input = Input::new(std::fs::read(&path)?, extension);
            inputs.push((path, input));
        }
    }
    Ok(inputs)
}

/// Writes an input; returns its path.
pub fn save(folder: &Path, target: Target, kind: Kind, input: &Input) -> Result<PathBuf> {
    let mut hasher = DefaultHasher::new();
    input.bytes.hash(&mut hasher);
    let hash = hasher.finish() as u32;
    let name = format!("{}-{hash:08x}.{}{ENDING}", kind.name(), input.extension);
    let folder = folder.join(target.name());
    std::fs::create_dir_all(&folder)?;
    let path = folder.join(name);
    std::fs::write(&path, &input.bytes).with_context(|| path.display().to_string())?;
    Ok(path)
}
