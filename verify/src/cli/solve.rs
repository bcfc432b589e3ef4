//! `mtled solve`.

use super::common::{Common, STOPPED};
use super::load::{SetArgs, load, located};
use super::progress::progress_bar;
use crate::run::{
    Estimated, PAGE_FILE, Prepared, Recorder, Recording, Solved, contact_results, error_bars,
    integrate_prepared, prepare_to_run, summary_text, write_failed, write_outputs,
};
use crate::scene::Case;
use clap::Args;
use mtled::error::Error;
use mtled_checks::escape::file_name;
use mtled_checks::report::ensure_writable;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct SolveArgs {
    /// Case file (TOML), or name of a bundled case.
    case: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    /// Folder for a page (index.html), VTU frames of the body and of the nodes, history.csv,
    /// displacement_field.json (see `mtled warp`) and result.json, which replace those of an
    /// earlier run [default: reports/<case>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Leave out the error bars, which take coarser clouds and up to a third of the time of the
    /// run.
    #[arg(long)]
    no_error_bar: bool,
}

pub fn solve(arguments: &SolveArgs, common: &Common) -> anyhow::Result<u8> {
    let case = load(&arguments.case, &arguments.set.overrides)?;
    let preset = || PathBuf::from("reports").join(file_name(&case.name));
    let out = arguments.out.clone().unwrap_or_else(preset);
    ensure_writable(&out)?;
    match solve_to(&case, &out, !arguments.no_error_bar, common) {
        Ok(code) => code,
        Err(error) => Err(located(&case, &error)),
    }
}

fn solve_to(
    case: &Case,
    out: &Path,
    with_bars: bool,
    common: &Common,
) -> Result<anyhow::Result<u8>, Error> {
    let prepared = prepare_to_run(&case.problem)?;
    for doubt in prepared.doubts(&case.problem) {
        common.warn(doubt);
    }
    let bar = progress_bar(common);
    let show = |progress: f64, step: usize| {
        let position = (1000.0 * progress) as u64;
        if position != bar.position() {
            bar.set_position(position);
            bar.set_message(format!("step {step}"));
        }
    };
    let mut recorder = Recorder::new(case, &prepared, case.outputs.frames)?.with_progress(&show);
    let solution = integrate_prepared(&case.problem, &prepared, &mut recorder);
    bar.finish_and_clear();
    let mut record = recorder.finish();
    record.unstable_mode = match &solution {
        Ok(solution) => solution.summary.instability.as_ref(),
        Err(error) => error.instability(),
    }
    .map(|found| found.mode.clone());
    match solution {
        Ok(solution) => {
            let solved = Solved::new(prepared, solution);
            let bars =
                with_bars.then(|| error_bars(case, &solved, &record, !record.frames.is_empty()));
            Ok(finish(case, &solved, &record, bars.as_ref(), out, common))
        }
        Err(error) => match write_partial(case, &prepared, &record, &error, out, common) {
            Ok(()) => Err(error),
            Err(unwritable) => Ok(Err(unwritable)),
        },
    }
}

/// Writes what a failed run has recorded.
fn write_partial(
    case: &Case,
    prepared: &Prepared,
    record: &Recording,
    error: &Error,
    out: &Path,
    common: &Common,
) -> anyhow::Result<()> {
    let result = write_failed(case, prepared, record, error, out)?;
    common.print_summary(&|| Ok(result.clone()), &|| String::new())?;
    if let Some(last) = record.samples.last() {
        common.complain(format!(
            "{} contains the run up to step {}, t = {:.6} s, and result.json says that it failed",
            out.display(),
            last.step,
            last.time
        ));
    }
    Ok(())
}

fn finish(
    case: &Case,
    solved: &Solved,
    record: &Recording,
    bars: Option<&Estimated>,
    out: &Path,
    common: &Common,
) -> anyhow::Result<u8> {
    let contacts = contact_results(&case.problem, &solved.prepared, &solved.state)?;
    let result = write_outputs(case, solved, record, &contacts, bars, out)?;
    common.print_summary(&|| Ok(result.clone()), &|| {
        let summary = summary_text(case, solved, record, &contacts, bars);
        format!("{summary}\n  results in {}, to be looked at in {PAGE_FILE} there\n", out.display())
    })?;
    for doubt in solved.doubts() {
        common.warn(doubt);
    }
    if solved.summary.stopped {
        common.complain(format!(
            "stopped at t = {:.6} s; the files contain the run up to then",
            solved.state.time
        ));
        return Ok(STOPPED);
    }
    Ok(0)
}
