//! `mtled case migrate`.

use super::common::{COULD_NOT_RUN, Common, Format};
use super::messages::chain_text;
use super::streams::{print_json, print_text};
use crate::scene::migrated;
use anyhow::{Context, Result};
use clap::Args;
use mtled_checks::escape::printable;
use mtled_checks::input::read_text;
use mtled_checks::report::write_atomically;
use serde_json::json;
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

pub fn migrate(arguments: &MigrateArgs, common: &Common) -> Result<u8> {
    let (mut code, mut done) = (0, Vec::new());
    for file in &arguments.files {
        match migrate_file(file, arguments.check) {
            Ok(changes) if common.format == Format::Human => print_text(&lines(file, &changes))?,
            Ok(changes) => {
                done.push(json!({ "file": file.display().to_string(), "changes": changes }));
            }
            Err(error) => {
                common.complain(chain_text(&error));
                code = COULD_NOT_RUN;
            }
        }
    }
    if common.format == Format::Json {
        print_json(&format!("{:#}\n", json!({ "schema_version": 1, "files": done })))?;
    }
    Ok(code)
}

/// The changes of a file, which is written unless it is only checked.
fn migrate_file(file: &Path, check: bool) -> Result<Vec<String>> {
    let name = file.display();
    let text = read_text(file).with_context(|| format!("{name}: cannot be read"))?;
    let (new, changes) = migrated(&text).with_context(|| name.to_string())?;
    if !changes.is_empty() && !check {
        write_atomically(file, new.as_bytes())?;
    }
    Ok(changes.iter().map(ToString::to_string).collect())
}

/// One line for each change.
fn lines(file: &Path, changes: &[String]) -> String {
    let name = printable(&file.display().to_string());
    match changes {
        [] => format!("{name}: nothing to change\n"),
        _ => changes.iter().map(|change| format!("{name}: {}\n", printable(change))).collect(),
    }
}
