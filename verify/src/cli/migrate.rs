//! `mtled case migrate`.

use super::common::{COULD_NOT_RUN, print_data};
use crate::scene::migrated;
use anyhow::{Context, Result};
use clap::Args;
use mtled_checks::report::write_atomically;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct MigrateArgs {
    /// Case files, which are changed in place.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Print what would be changed and write nothing.
    #[arg(long)]
    check: bool,
}

pub fn migrate(arguments: &MigrateArgs) -> Result<u8> {
    let mut code = 0;
    for file in &arguments.files {
        match migrate_file(file, arguments.check) {
            Ok(text) => print_data(&text)?,
            Err(error) => {
                eprintln!("{error:#}");
                code = COULD_NOT_RUN;
            }
        }
    }
    Ok(code)
}

/// One line for each change.
fn migrate_file(file: &Path, check: bool) -> Result<String> {
    let name = file.display();
    let text = std::fs::read_to_string(file).with_context(|| format!("{name}: cannot be read"))?;
    let (new, changes) = migrated(&text).with_context(|| name.to_string())?;
    if changes.is_empty() {
        return Ok(format!("{name}: nothing to change\n"));
    }
    if !check {
        write_atomically(file, new.as_bytes())?;
    }
    Ok(changes.iter().map(|change| format!("{name}: {change}\n")).collect())
}
