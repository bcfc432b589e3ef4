//! `mtled solve`.

use crate::cli::case::{diagnose, fits, load};
use crate::cli::{COULD_NOT_RUN, Common, Format, STOPPED, print_data};
use crate::run::{
    Prepared, Record, Recorder, Solved, march_on, prepare_to_run, summary_text, write_outputs,
    write_recorded,
};
use crate::scene::Case;
use anyhow::Context;
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct SolveArgs {
    /// Case file (TOML).
    case: PathBuf,
    /// Folder for VTU frames, history.csv and result.json
    /// [default: reports/<case>].
    #[arg(long)]
    out: Option<PathBuf>,
}

pub fn solve(arguments: &SolveArgs, common: &Common) -> anyhow::Result<u8> {
    let Some(case) = load(&arguments.case) else { return Ok(COULD_NOT_RUN) };
    if !fits(&case) {
        return Ok(COULD_NOT_RUN);
    }
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from("reports").join(&case.name));
    // A folder that cannot be written must not cost a whole run.
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
    let march = march_on(&case.problem, &prepared, &mut recorder);
    bar.finish_and_clear();
    let record = recorder.finish();
    match march {
        Ok(march) => Ok(finish(case, &Solved::new(prepared, march), &record, out, common)),
        Err(error) => {
            if let Err(error) = keep(case, &prepared, &record, out) {
                return Ok(Err(error));
            }
            Err(error)
        }
    }
}

/// Writes what a failed run had, and says so.
fn keep(case: &Case, prepared: &Prepared, record: &Record, out: &Path) -> anyhow::Result<()> {
    write_recorded(case, prepared, record, out)?;
    if let Some(last) = record.samples.last() {
        eprintln!(
            "{} holds what was sound: up to step {}, t = {:.6} s; there is no result.json",
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
    record: &Record,
    out: &Path,
    common: &Common,
) -> anyhow::Result<u8> {
    let result = write_outputs(case, solved, record, out)?;
    match common.format {
        Format::Json => print_data(&result)?,
        Format::Human if !common.quiet => {
            let summary = summary_text(case, solved, record);
            print_data(&format!("{summary}\n  results in {}\n", out.display()))?;
        }
        Format::Human => {}
    }
    if let Some(crushed) = solved.summary.crushed(&solved.prepared.model).filter(|_| !common.quiet)
    {
        eprintln!("warning: {crushed}");
    }
    if solved.summary.stopped {
        eprintln!(
            "stopped at t = {:.6} s; the files hold what was done until then",
            solved.state.time
        );
        return Ok(STOPPED);
    }
    Ok(0)
}

/// A bar of a thousand parts, hidden where nobody looks.
pub fn progress_bar(common: &Common) -> ProgressBar {
    if !common.draws() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(10));
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}  {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}
