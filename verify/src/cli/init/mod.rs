//! `mtled init`.

use crate::cli::common::Common;
use crate::cli::lab::{StoreArgs, seconds};
use crate::cli::progress::ManyRuns;
use crate::cli::verify::{OTHER_CLOUDS, report};
use anyhow::{Context, Result, bail};
use clap::Args;
use mtled_checks::escape::printable;
use mtled_checks::gate::{Clouds, Reason, update};
use mtled_checks::report::{ensure_writable, write_atomically};
use mtled_lab::lab::store::TaskRunner;
use mtled_lab::suite::{Draft, Limits, Suite, draft, find_cases};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Names of the files that are written.
const SUITE: &str = "suite.toml";
const BASELINE: &str = "baseline.json";
const WORKFLOW: &str = ".github/workflows/accuracy.yml";
const WORKFLOW_TEXT: &str = include_str!("accuracy.yml");

#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct InitArgs {
    /// Folder of the case files, in which the suite is written.
    #[arg(default_value = ".")]
    folder: PathBuf,
    /// Case files, relative to the folder [default: all in it and in folders below].
    #[arg(long, value_name = "FILE", num_args = 1..)]
    cases: Vec<PathBuf>,
    /// CPU time that the finer runs of a case may take that its errors are measured against, such
    /// as 90s or 5min; where it is short they are refined less.
    #[arg(long, value_name = "TIME", value_parser = seconds, default_value = "100s")]
    truth_budget: f64,
    /// Spacing of the case over that of the finest run, instead of a choice by the time it takes.
    #[arg(long, value_name = "FACTOR", value_parser = refinement)]
    refine: Option<f64>,
    /// Make the references of an existing suite again, and nothing else.
    #[arg(long, conflicts_with = "cases")]
    references: bool,
    #[command(flatten)]
    store: StoreArgs,
}

const EXAMPLES: &str = "Writes suite.toml, references/, baseline.json and .github/workflows/accuracy.yml. Bounds of errors
are 1.25 times the largest over five clouds of nodes, and the error of the reference; bands of the
baseline follow from the scatter over these clouds. A file that is there is not written over; what
a run that was stopped has left out is written by the next.

Examples:
  mtled init my_cases                              # then commit what it wrote
  mtled verify --suite my_cases/suite.toml         # in CI: has anything got worse?
  mtled verify --suite my_cases/suite.toml --update-baseline --reason \"softer tissue\"";

/// A factor above 1.
fn refinement(text: &str) -> Result<f64, String> {
    let factor = text.parse::<f64>().ok().filter(|factor| *factor > 1.0 && *factor <= 8.0);
    factor.ok_or_else(|| format!("{text} is not a factor above 1 and at most 8, such as 2"))
}

pub(crate) fn init(arguments: &InitArgs, common: &Common) -> Result<u8> {
    let start = Instant::now();
    let folder = arguments.folder.strip_prefix(".").unwrap_or(&arguments.folder);
    let suite_file = folder.join(SUITE);
    let started = suite_file.exists() && !arguments.references;
    if started {
        refuse_what_is_whole(folder, &suite_file)?;
    }
    let files = if started { Vec::new() } else { cases(arguments, folder, &suite_file)? };
    ensure_writable(&arguments.folder)?;
    let store = arguments.store.open()?;
    let runs = ManyRuns::new(common);
    let runner = TaskRunner { store: &store, notify: &|progress| runs.show(progress), plan: None };
    if started {
        common
            .note(&format!("{} is there already: what is missing is added", suite_file.display()));
        return match rest(folder, &suite_file, start, &runner, &runs)? {
            Ok(written) => report_written(&[], &written, &suite_file, common),
            Err(code) => Ok(code),
        };
    }
    let limits = Limits {
        cpu_s: arguments.truth_budget,
        refinement: arguments.refine,
        clouds: 1 + OTHER_CLOUDS,
    };
    let draft = match runs.finish(draft(folder, &files, &limits, &runner))? {
        Ok(draft) => draft,
        Err(code) => return Ok(code),
    };
    let mut written = references(folder, &draft)?;
    draft.cases.iter().flat_map(|case| &case.notes).for_each(|note| common.note(note));
    if !arguments.references {
        write_atomically(&suite_file, draft.text(Path::new(BASELINE))?.as_bytes())?;
        written.push(suite_file.clone());
        match rest(folder, &suite_file, start, &runner, &runs)? {
            Ok(more) => written.extend(more),
            Err(code) => return Ok(code),
        }
    }
    let cases: Vec<String> = draft.cases.iter().map(|case| case.summary()).collect();
    report_written(&cases, &written, &suite_file, common)
}

fn report_written(
    cases: &[String],
    written: &[PathBuf],
    suite_file: &Path,
    common: &Common,
) -> Result<u8> {
    let shown: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    common.print_summary(&|| Ok(format!("{}\n", json!({ "written": shown }))), &|| {
        let lines = cases.iter().map(|case| printable(case) + "\n").collect::<String>();
        let files: Vec<String> = shown.iter().map(|file| printable(file)).collect();
        format!(
            "{lines}written: {}\nnext: commit them, and run in CI: mtled verify --suite {}\n",
            files.join(", "),
            printable(&suite_file.display().to_string())
        )
    })?;
    Ok(0)
}

/// What stands behind the suite, where it is missing: the baseline and the workflow. The exit
/// code where the user has stopped it.
fn rest(
    folder: &Path,
    suite_file: &Path,
    start: Instant,
    runner: &TaskRunner,
    runs: &ManyRuns,
) -> Result<Result<Vec<PathBuf>, u8>> {
    let mut written = Vec::new();
    let [path, workflow] = [BASELINE, WORKFLOW].map(|name| folder.join(name));
    if !path.exists() {
        match baseline(suite_file, start, runner, runs)? {
            Ok(text) => write_atomically(&path, text.as_bytes())?,
            Err(code) => return Ok(Err(code)),
        }
        written.push(path);
    }
    if !workflow.exists() {
        write_atomically(&workflow, WORKFLOW_TEXT.as_bytes())?;
        written.push(workflow);
    }
    Ok(Ok(written))
}

/// Refuses a suite that has all that belongs to it.
fn refuse_what_is_whole(folder: &Path, suite_file: &Path) -> Result<()> {
    let missing = [BASELINE, WORKFLOW].iter().any(|name| !folder.join(name).exists());
    if missing { Ok(()) } else { is_there(suite_file, suite_file) }
}

fn is_there(file: &Path, suite_file: &Path) -> Result<()> {
    bail!(
        "{} is there already: edit it, or remove it and run this again (`mtled init \
         --references` makes its references again, `mtled verify --suite {} \
         --update-baseline` its baseline)",
        file.display(),
        suite_file.display()
    )
}

/// The case files, relative to the folder.
fn cases(arguments: &InitArgs, folder: &Path, suite_file: &Path) -> Result<Vec<PathBuf>> {
    if arguments.references {
        let suite = Suite::files(suite_file)?;
        return Ok(suite);
    }
    let of_another = folder.join(BASELINE);
    if of_another.exists() {
        is_there(&of_another, suite_file)?;
    }
    if !arguments.cases.is_empty() {
        return Ok(arguments.cases.clone());
    }
    let found = find_cases(&arguments.folder)?;
    if found.is_empty() {
        bail!(
            "there is no case file in {}: `mtled case show cube_compression > {}` writes one to \
             start from",
            arguments.folder.display(),
            folder.join("my_case.toml").display()
        );
    }
    // With slashes, since the suite may be read on another system.
    let relative = |path: &PathBuf| {
        let parts = path.strip_prefix(&arguments.folder)?.components();
        let parts: Vec<_> = parts.map(|part| part.as_os_str().to_string_lossy()).collect();
        Ok(PathBuf::from(parts.join("/")))
    };
    found.iter().map(relative).collect()
}

/// Writes the references and returns their paths.
fn references(folder: &Path, draft: &Draft) -> Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    for case in &draft.cases {
        let (Some(path), Some(text)) = (case.reference_path(), &case.reference) else { continue };
        let path = folder.join(path);
        write_atomically(&path, text.as_bytes())?;
        written.push(path);
    }
    Ok(written)
}

/// The text of the first baseline of a suite, with bands from other clouds; the exit code where
/// the user has stopped it.
fn baseline(
    suite_file: &Path,
    start: Instant,
    runner: &TaskRunner,
    runs: &ManyRuns,
) -> Result<Result<String, u8>> {
    let suite =
        Suite::read(suite_file).with_context(|| format!("the suite {}", suite_file.display()))?;
    let clouds = match runs.finish(suite.studies("", 0..OTHER_CLOUDS + 1, runner))? {
        Ok(clouds) => clouds,
        Err(code) => return Ok(Err(code)),
    };
    let mut reports: Vec<_> =
        clouds.into_iter().map(|studies| report(&suite, studies, start)).collect();
    let own = reports.remove(0);
    reports.retain(|report| report.studies.iter().all(|study| study.failure.is_none()));
    if reports.len() < 2 {
        reports.clear();
    }
    let (clouds, reason) = (Clouds::new(&reports)?, Reason::new("first baseline")?);
    Ok(Ok(update(&own, None, &clouds, &reason, true)?.to_json()))
}
