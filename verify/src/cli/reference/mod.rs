//! `mtled reference …`.

pub mod solve;
mod table;

use crate::bundled::{CASES, carried_reference, unpack};
use crate::cli::reference::solve::{SolveReferenceArgs, solve};
use crate::cli::reference::table::{check_table, show_text, to_json};
use crate::cli::{COULD_NOT_RUN, Common, Format, print_data};
use crate::reference::{Agreement, ReferenceError, ReferenceFile, agree, read_reference};
use crate::scene::{Case, one_error, read_case};
use anyhow::{Context, Result, bail};
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};

#[derive(Debug, Subcommand)]
pub enum ReferenceCommand {
    /// Is every case referred to, by both codes, for the problem as it stands,
    /// and do the codes agree within their error bars?
    Check(CheckArgs),
    /// Print the values of a case with error bars, orders, meshes and costs.
    Show {
        case: String,
        #[command(flatten)]
        from: From,
    },
    /// Solve cases with the finite-element codes (needs a checkout and Python).
    Solve(SolveReferenceArgs),
}

#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Names of cases [default: all].
    cases: Vec<String>,
    #[command(flatten)]
    from: From,
}

/// Where cases and references are read from.
#[derive(Debug, Args)]
pub struct From {
    /// Folder with a JSON file per case [default: what the program carries].
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Folder with the case files [default: what the program carries].
    #[arg(long = "cases", id = "cases_dir", value_name = "DIR")]
    cases_dir: Option<PathBuf>,
}

/// A case with a sound reference.
pub struct Referred {
    pub case: Case,
    pub file: ReferenceFile,
    pub agreements: Vec<Agreement>,
}

/// What became of one case.
pub struct Outcome {
    pub case: String,
    pub referred: Result<Referred, String>,
}

impl Outcome {
    /// What is wrong; it names the case.
    pub fn complaint(&self) -> Option<String> {
        let referred = match &self.referred {
            Ok(referred) => referred,
            Err(reason) => return Some(reason.clone()),
        };
        let apart: Vec<String> = (referred.agreements.iter().filter(|a| !a.agrees()))
            .map(|a| format!("{} by {:.2} times the error bars", a.quantity.name, a.ratio()))
            .collect();
        (!apart.is_empty())
            .then(|| format!("{}: the codes differ in {}", self.case, apart.join(", ")))
    }
}

pub fn reference(command: &ReferenceCommand, common: &Common) -> Result<u8> {
    match command {
        ReferenceCommand::Check(arguments) => check(arguments, common),
        ReferenceCommand::Show { case, from } => show(case, from, common),
        ReferenceCommand::Solve(arguments) => solve(arguments, common),
    }
}

fn check(arguments: &CheckArgs, common: &Common) -> Result<u8> {
    let outcomes = read(&arguments.cases, &arguments.from)?;
    match common.format {
        Format::Json => print_data(&format!("{:#}\n", to_json(&outcomes)))?,
        Format::Human if !common.quiet => print_data(&format!("{}\n", check_table(&outcomes)))?,
        Format::Human => {}
    }
    let complaints: Vec<String> = outcomes.iter().filter_map(Outcome::complaint).collect();
    complaints.iter().for_each(|complaint| eprintln!("{complaint}"));
    Ok(u8::from(!complaints.is_empty()))
}

fn show(case: &str, from: &From, common: &Common) -> Result<u8> {
    let outcomes = read(&[case.to_string()], from)?;
    match &outcomes[0].referred {
        Ok(referred) => {
            match common.format {
                Format::Json => print_data(&format!("{:#}\n", to_json(&outcomes)))?,
                Format::Human => print_data(&show_text(referred))?,
            }
            Ok(0)
        }
        Err(reason) => {
            eprintln!("{reason}");
            Ok(COULD_NOT_RUN)
        }
    }
}

/// Reads cases (all if none is named) with their references.
fn read(names: &[String], from: &From) -> Result<Vec<Outcome>> {
    let carried = tempfile::tempdir().context("cannot make a folder for the carried cases")?;
    let folder = match &from.cases_dir {
        Some(folder) => folder.clone(),
        None => unpack(carried.path())?,
    };
    let known = case_names(&folder)?;
    if let Some(name) = names.iter().find(|name| !known.contains(name)) {
        bail!("there is no case \"{name}\"; there are {}", known.join(", "));
    }
    let wanted = if names.is_empty() { &known } else { names };
    let one = |name: &String| Outcome {
        case: name.clone(),
        referred: read_one(name, &folder, from.data.as_deref()),
    };
    Ok(wanted.iter().map(one).collect())
}

fn read_one(name: &str, cases: &Path, data: Option<&Path>) -> Result<Referred, String> {
    let case = read_case(&cases.join(format!("{name}.toml")))
        .map_err(|mistakes| format!("{name}: {}", one_error(mistakes)))?;
    let absent = || ReferenceError::Absent { case: name.to_string() }.to_string();
    let text = match data {
        None => carried_reference(name).ok_or_else(absent)?.to_string(),
        Some(folder) => {
            std::fs::read_to_string(folder.join(format!("{name}.json"))).map_err(|_| absent())?
        }
    };
    let file = read_reference(&case, &text).map_err(|error| error.to_string())?;
    let agreements = agree(&case, &file);
    Ok(Referred { case, file, agreements })
}

/// Names of the case files in a folder, those that the program carries first.
pub fn case_names(folder: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(folder)
        .with_context(|| format!("cannot read the folder {}", folder.display()))?;
    let mut names = Vec::new();
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
        }
    }
    names.sort_by_key(|name| {
        (CASES.iter().position(|(carried, _)| carried == name).unwrap_or(CASES.len()), name.clone())
    });
    Ok(names)
}
