//! `mtled solve`.

use super::common::{COULD_NOT_RUN, Common, STOPPED};
use super::load::{diagnose, load};
use super::progress::progress_bar;
use crate::run::{
    Prepared, Recorder, Recording, Solved, integrate_prepared, prepare_to_run, summary_text,
    write_outputs, write_recorded,
};
use crate::scene::Case;
use anyhow::Context;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct SolveArgs {
    /// Case file (TOML).
    case: PathBuf,
    /// Folder for VTU frames, history.csv and result.json [default: reports/<case>].
    #[arg(long)]
    out: Option<PathBuf>,
}

pub fn solve(arguments: &SolveArgs, common: &Common) -> anyhow::Result<u8> {
    let Some(case) = load(&arguments.case) else { return Ok(COULD_NOT_RUN) };
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from("reports").join(&case.name));
    // A folder that cannot be written must not be discovered after a long run.
    std::fs::create_dir_all(&out)
        .with_context(|| format!("cannot make the folder {}", out.display()))?;
    match solve_to(&case, &out, common) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("{}", diagnose(&case, &error));
            Ok(COULD_NOT_RUN)
        }
    }
}

fn solve_to(
    case: &Case,
    out: &Path,
    common: &Common,
) -> Result<anyhow::Result<u8>, mtled::error::Error> {
    let prepared = prepare_to_run(&case.problem)?;
    if !common.quiet {
        for warning in prepared.discretisation.warnings() {
            eprintln!("warning: {warning}");
        }
    }
    let bar = progress_bar(common);
    let show = |progress: f64, step: usize| {
        if step.is_multiple_of(16) {
            bar.set_position((1000.0 * progress) as u64);
            bar.set_message(format!("step {step}"));
        }
    };
    let mut recorder = Recorder::new(case, &prepared, case.outputs.frames)?.with_progress(&show);
    let solution = integrate_prepared(&case.problem, &prepared, &mut recorder);
    bar.finish_and_clear();
    let record = recorder.finish();
    match solution {
        Ok(solution) => Ok(finish(case, &Solved::new(prepared, solution), &record, out, common)),
        Err(error) => {
            if let Err(error) = write_partial(case, &prepared, &record, out) {
                return Ok(Err(error));
            }
            Err(error)
        }
    }
}

/// Writes what a failed run has recorded.
fn write_partial(
    case: &Case,
    prepared: &Prepared,
    record: &Recording,
    out: &Path,
) -> anyhow::Result<()> {
    write_recorded(case, prepared, record, out)?;
    if let Some(last) = record.samples.last() {
        eprintln!(
            "{} contains the run up to step {}, t = {:.6} s; there is no result.json",
            out.display(),
            last.step,
            last.time
        );
    }
    Ok(())
}

fn finish(
    case: &Case,
    solved: &Solved,
    record: &Recording,
    out: &Path,
    common: &Common,
) -> anyhow::Result<u8> {
    let result = write_outputs(case, solved, record, out)?;
    common.print_summary(&|| Ok(result.clone()), &|| {
        let summary = summary_text(case, solved, record);
        format!("{summary}\n  results in {}\n", out.display())
    })?;
    if let Some(collapsed) =
        solved.summary.collapsed_point(&solved.prepared.model).filter(|_| !common.quiet)
    {
        eprintln!("warning: {collapsed}");
    }
    if solved.summary.stopped {
        eprintln!(
            "stopped at t = {:.6} s; the files contain the run up to then",
            solved.state.time
        );
        return Ok(STOPPED);
    }
    Ok(0)
}
