//! The problems of a contest, and the files of results about them.

use anyhow::{Context, Result, bail};
use clap::Args;
use mtled_case::bundled::REFERENCES;
use mtled_checks::input::read_text;
use mtled_lab::contests::{
    ContestCase, Results, ResultsFault, Spacing, benchmark, problem_of, result_files,
};
use mtled_lab::lab::store::Source;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct OwnProblems {
    /// A case of your own that there are results of; may be repeated.
    #[arg(long = "case", value_name = "FILE")]
    pub cases: Vec<String>,
    /// A reference file in the layout of `reference/data` for it; may be repeated.
    #[arg(long = "reference", value_name = "FILE")]
    pub references: Vec<PathBuf>,
}

pub(crate) fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for path in paths {
        all.extend(result_files(path).with_context(|| format!("cannot read {}", path.display()))?);
    }
    if all.is_empty() {
        bail!("there are no results (*.json) in {}", paths[0].display());
    }
    Ok(all)
}

pub(crate) fn bundled() -> Vec<String> {
    REFERENCES.iter().map(|(name, _)| name.to_string()).collect()
}

/// The benchmark and the problems of the user; bundled cases are unpacked into a folder.
pub(crate) fn problems(own: &OwnProblems, folder: &Path) -> Result<Vec<ContestCase>> {
    cases(&[own.cases.clone(), bundled()].concat(), &own.references, folder)
}

pub(crate) fn cases(
    names: &[String],
    references: &[PathBuf],
    folder: &Path,
) -> Result<Vec<ContestCase>> {
    let read = |file: &PathBuf| {
        let name = file.display().to_string();
        let text = read_text(file);
        Ok((name.clone(), text.with_context(|| format!("cannot read the reference {name}"))?))
    };
    let references: Vec<(String, String)> = references.iter().map(read).collect::<Result<_>>()?;
    let known = benchmark();
    let case = |name: &String| {
        let problem = known.iter().find(|problem| problem.id == *name);
        let name = problem.map_or(name, |problem| &problem.case);
        let source = Source::find(name, folder, &[]).context("the case cannot be used")?;
        ContestCase::new(source, &references)
    };
    names.iter().map(case).collect()
}

/// Cases with their distances of nodes \[m\].
pub(crate) fn laddered(
    cases: Vec<ContestCase>,
    spacings: &[Spacing],
) -> Result<Vec<(ContestCase, Vec<f64>)>> {
    let laddered = cases.into_iter().map(|case| {
        let spacings_m = case.ladder(spacings)?;
        Ok((case, spacings_m))
    });
    laddered.collect()
}

pub(crate) fn believed<'a>(
    file: &Path,
    cases: &'a [ContestCase],
) -> Result<(Results, &'a ContestCase), ResultsFault> {
    let results = Results::read(file)?;
    let case = problem_of(&results, cases)?;
    Ok((results, case))
}
