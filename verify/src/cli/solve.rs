//! `mtled solve`.

use super::common::{Common, INCONCLUSIVE, STOPPED};
use super::load::{SetArgs, located};
use super::progress::progress_bar;
use clap::Args;
use mtled::Simulation;
use mtled::error::Error;
use mtled::motion::observe::Continue;
use mtled_case::scene::Case;
use mtled_checks::escape::file_name;
use mtled_checks::report::ensure_writable;
use mtled_run::run::{
    Failed, Finished, PAGE_FILE, SavedState, audit_doubts, load, solve_recorded, warnings,
};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct SolveArgs {
    /// Case file (TOML), or name of a bundled case.
    case: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    /// Folder for a page (index.html), VTU frames of the body and of the nodes, history.csv,
    /// displacement_field.json (see `mtled warp`) and result.json, which replace those of an
    /// earlier run [default: reports/<case>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Go on with a motion from a state that `output.states` of its case has written: the bits are
    /// those of the run that wrote it. Loads and times may be others. There are no error bars then, since
    /// coarser clouds have no such state.
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// Leave out the error bars, which take coarser clouds and up to a third of the time of the
    /// run.
    #[arg(long)]
    no_error_bar: bool,
}

pub(crate) fn solve(arguments: &SolveArgs, common: &Common) -> anyhow::Result<u8> {
    let case = load(&arguments.case, &arguments.set.overrides)?;
    let preset = || PathBuf::from("reports").join(file_name(&case.name));
    let out = arguments.out.clone().unwrap_or_else(preset);
    if let Some(state) = &arguments.from {
        let folder = state.parent().and_then(|folder| folder.canonicalize().ok());
        anyhow::ensure!(
            folder.is_none() || folder != out.canonicalize().ok(),
            "{}: the run would replace the folder of its own state; name another with --out",
            state.display()
        );
    }
    ensure_writable(&out)?;
    match solve_to(&case, &out, arguments, common) {
        Ok(code) => code,
        Err(error) => Err(located(&case, &error)),
    }
}

fn solve_to(
    case: &Case,
    out: &Path,
    arguments: &SolveArgs,
    common: &Common,
) -> Result<anyhow::Result<u8>, Error> {
    let mut simulation = Simulation::new(&case.problem)?;
    if let Some(file) = &arguments.from
        && let Err(error) = SavedState::read(file, &mut simulation)
    {
        return Ok(Err(error));
    }
    for doubt in warnings(case, &simulation) {
        common.warn(doubt);
    }
    let bar = progress_bar(common);
    let show = |progress: f64, step: usize| {
        let position = (1000.0 * progress) as u64;
        if position != bar.position() {
            bar.set_position(position);
            bar.set_message(format!("step {step}"));
        }
        Continue::Yes
    };
    let outcome = solve_recorded(case, simulation, !arguments.no_error_bar, &show);
    bar.finish_and_clear();
    match outcome {
        Ok(finished) => Ok(finish(case, &finished, out, common)),
        // Refused before the first step: there is nothing to keep.
        Err(failed) if failed.has_not_begun() => Err(failed.error),
        Err(failed) => match write_partial(case, &failed, out, common) {
            Ok(()) => Err(failed.error),
            Err(unwritable) => Ok(Err(unwritable)),
        },
    }
}

/// Writes what a failed run has recorded.
fn write_partial(case: &Case, failed: &Failed, out: &Path, common: &Common) -> anyhow::Result<()> {
    let result = failed.write(case, out)?;
    common.print_summary(&|| Ok(result.clone()), &|| String::new())?;
    if let Some(last) = failed.record.samples.last() {
        common.complain(format!(
            "{} contains the run up to step {}, t = {:.6} s, and result.json says that it failed",
            out.display(),
            last.step,
            last.time
        ));
    }
    Ok(())
}

fn finish(case: &Case, finished: &Finished, out: &Path, common: &Common) -> anyhow::Result<u8> {
    let result = finished.write(case, out)?;
    let doubts = finished.audit.iter().flat_map(audit_doubts);
    let doubts: Vec<String> = doubts.inspect(|doubt| common.complain(doubt)).collect();
    common.print_summary(&|| Ok(result.clone()), &|| {
        let summary = finished.text(case);
        format!("{summary}\n  results in {}, to be looked at in {PAGE_FILE} there\n", out.display())
    })?;
    let solved = &finished.solved;
    for doubt in solved.doubts() {
        common.warn(doubt);
    }
    if solved.summary.stopped {
        common.complain(format!(
            "stopped at t = {:.6} s; the files contain the run up to then",
            solved.simulation.state.time
        ));
        return Ok(STOPPED);
    }
    Ok(if doubts.is_empty() { 0 } else { INCONCLUSIVE })
}
