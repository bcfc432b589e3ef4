//! `mtled man` and `mtled completions`: what a system shows of the program without running it.

use super::streams::print_data;
use anyhow::{Context, Result};
use clap::{Args, Command};
use clap_complete::Shell;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// Folder for a page of the program and one of each command, in place of printing the first.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Prints the page of the program for `man`, or writes all pages.
pub(crate) fn man(arguments: &ManArgs, program: Command) -> Result<u8> {
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder)
            .and_then(|()| clap_mangen::generate_to(program, folder))
            .with_context(|| format!("cannot write pages to {}", folder.display()))?;
        return Ok(0);
    }
    let mut page = Vec::new();
    clap_mangen::Man::new(program).render(&mut page)?;
    print_data(&String::from_utf8_lossy(&page))?;
    Ok(0)
}

/// Prints the completion script of a shell.
pub(crate) fn completions(shell: Shell, mut program: Command) -> Result<u8> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut program, "mtled", &mut script);
    print_data(&String::from_utf8_lossy(&script))?;
    Ok(0)
}
