//! `mtled contest race`.

use super::hold::held;
use super::problems::{cases, laddered};
use crate::cli::common::Common;
use crate::cli::python::{checkout, with_module};
use anyhow::{Context, Result, bail};
use clap::Args;
use mtled_lab::contests::{Contest, RaceList};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct RaceArgs {
    /// Problems [default: all of the list].
    problems: Vec<String>,
    /// How often every run is made; that with the median time counts.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    repeat: u16,
    /// The folder `reference` of a checkout, for the finite-element codes [default: searched from
    /// the working directory upward].
    #[arg(long, value_name = "DIR")]
    reference: Option<PathBuf>,
    /// Folder for the pages, tables.md and results/SOLVER/PROBLEM.json.
    #[arg(long, default_value = "reports/race", value_name = "DIR")]
    out: PathBuf,
}

/// The contest of the list, with the finite-element codes that are installed.
pub(crate) fn race(arguments: &RaceArgs, common: &Common) -> Result<u8> {
    let folder = tempfile::tempdir().context("cannot make a folder for the bundled cases")?;
    let list = RaceList::bundled()?;
    let chosen = |name: &String| list.problems.contains(name);
    if let Some(unknown) = arguments.problems.iter().find(|name| !chosen(name)) {
        bail!("{unknown} is not in the race; its problems are {}", list.problems.join(", "));
    }
    let none = arguments.problems.is_empty();
    let names = if none { &list.problems } else { &arguments.problems };
    let program = std::env::current_exe().context("the path of this program is not known")?;
    let reference = arguments.reference.clone().map_or_else(checkout, Ok);
    let mut entrants = Vec::new();
    for racer in &list.racers {
        let Some(adapter) = &racer.adapter else {
            entrants.push(racer.entrant(&program, &[], Path::new("")));
            continue;
        };
        let reference = reference.as_ref().ok();
        let python = reference.and_then(|folder| with_module(&adapter.imports, folder));
        match reference.zip(python) {
            Some((folder, python)) => {
                entrants.push(racer.entrant(&program, &python.program_and_flags(), folder));
            }
            None => common.note(&format!("no Python here imports {}: left out", adapter.imports)),
        }
    }
    let contest = Contest {
        entrants,
        cases: laddered(cases(names, &[], folder.path())?, &list.spacings()?)?,
        time_limit_s: list.time_limit_s,
        repetitions: arguments.repeat.into(),
    };
    held(contest, &arguments.out, common)
}
