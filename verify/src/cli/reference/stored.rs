//! Stored references and their mistakes.

use anyhow::{Context, Result, bail};
use clap::Args;
use mtled_case::bundled::{CASES, bundled_reference, unpack};
use mtled_case::reference::{Agreement, ReferenceError, ReferenceFile, agreements, read_reference};
use mtled_case::scene::{Case, one_error, read_case};
use std::path::{Path, PathBuf};

/// Where cases and references are read from.
#[derive(Debug, Args)]
pub(crate) struct ReferenceArgs {
    /// Folder with a JSON file per case [default: the bundled references].
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Folder with the case files [default: the bundled cases].
    #[arg(long = "cases", id = "cases_dir", value_name = "DIR")]
    cases_dir: Option<PathBuf>,
}

/// A case with its reference.
pub(crate) struct Referenced {
    pub case: Case,
    pub file: ReferenceFile,
    pub agreements: Vec<Agreement>,
}

/// The reference of a case, or what is wrong with it.
pub(crate) struct StoredReference {
    pub case: String,
    pub reference: Result<Referenced, String>,
}

impl StoredReference {
    /// What is wrong, with the name of the case.
    pub(crate) fn mistake(&self) -> Option<String> {
        let reference = match &self.reference {
            Ok(reference) => reference,
            Err(reason) => return Some(reason.clone()),
        };
        let differences: Vec<String> = (reference.agreements.iter().filter(|a| !a.agrees()))
            .map(|a| format!("{} by {:.2} times the error bars", a.quantity.name, a.ratio()))
            .collect();
        (!differences.is_empty())
            .then(|| format!("{}: the codes differ in {}", self.case, differences.join(", ")))
    }
}

/// Reads cases, all if none is named, with their references.
pub(crate) fn read(names: &[String], from: &ReferenceArgs) -> Result<Vec<StoredReference>> {
    let unpacked = tempfile::tempdir().context("cannot create a folder for the bundled cases")?;
    let folder = match &from.cases_dir {
        Some(folder) => folder.clone(),
        None => unpack(unpacked.path())?,
    };
    let known = case_names(&folder)?;
    if let Some(name) = names.iter().find(|name| !known.contains(name)) {
        bail!("there is no case \"{name}\"; there are {}", known.join(", "));
    }
    let names = if names.is_empty() { &known } else { names };
    let one = |name: &String| StoredReference {
        case: name.clone(),
        reference: read_one(name, &folder, from.data.as_deref()),
    };
    Ok(names.iter().map(one).collect())
}

fn read_one(name: &str, cases: &Path, data: Option<&Path>) -> Result<Referenced, String> {
    let case = read_case(&cases.join(format!("{name}.toml")))
        .map_err(|mistakes| format!("{name}: {}", one_error(mistakes)))?;
    let absent = || ReferenceError::Absent { case: name.to_string() }.to_string();
    let text = match data {
        None => bundled_reference(name).ok_or_else(absent)?.to_string(),
        Some(folder) => {
            std::fs::read_to_string(folder.join(format!("{name}.json"))).map_err(|_| absent())?
        }
    };
    let file = read_reference(&case, &text).map_err(|error| error.to_string())?;
    let agreements = agreements(&case, &file);
    Ok(Referenced { case, file, agreements })
}

/// Names of the case files in a folder, the bundled ones first.
pub(crate) fn case_names(folder: &Path) -> Result<Vec<String>> {
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
        (CASES.iter().position(|(bundled, _)| bundled == name).unwrap_or(CASES.len()), name.clone())
    });
    Ok(names)
}
