//! Files of an earlier run in the same folder.

use super::frames::{is_frame, lists_frames};
use crate::run::saved_state::is_state;
use crate::run::stored_field::FIELD_FILE;
use anyhow::{Context, Result};
use std::io::ErrorKind;
use std::path::Path;

/// Name of the page in the folder of a run.
pub const PAGE_FILE: &str = "index.html";

/// Removes `result.json`, the page and the collections of frames, then the frames, the histories and the states.
pub(crate) fn remove_earlier_run(dir: &Path) -> Result<()> {
    let mut others = vec![dir.join("history.csv"), dir.join(FIELD_FILE)];
    let mut indices = vec![dir.join("result.json"), dir.join(PAGE_FILE)];
    let unreadable = || format!("cannot read the folder {}", dir.display());
    if dir.exists() {
        for entry in std::fs::read_dir(dir).with_context(unreadable)? {
            let path = entry.with_context(unreadable)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if is_frame(&name) || is_state(&name) {
                others.push(path);
            } else if name.ends_with(".pvd") && lists_frames(&path) {
                indices.push(path);
            }
        }
    }
    for file in indices.iter().chain(&others) {
        match std::fs::remove_file(file) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                let what = format!("cannot remove {} of an earlier run", file.display());
                return Err(error).context(what);
            }
            _ => {}
        }
    }
    Ok(())
}
