//! `mtled protocol …`.

use super::common::Common;
use super::load::SetArgs;
use super::streams::{print_data, print_text};
use anyhow::{Context, Result, bail};
use clap::{Subcommand, ValueEnum};
use mtled_case::bundled::unpack;
use mtled_case::protocol::{
    Job, Resolution, SoundReply, answer_schema, job_schema, parse_job, read_reply,
};
use mtled_case::scene::{one_error, parse_case};
use mtled_checks::input::read_text;
use mtled_checks::report::{ensure_writable, write_atomically};
use mtled_lab::contests::{Spacing, absolute, solve_job};
use mtled_lab::lab::store::Source;
use mtled_run::accuracy::ReferenceSolution;
use std::path::{Path, PathBuf};

#[derive(Debug, Subcommand)]
pub(crate) enum ProtocolCommand {
    /// Print the JSON Schema of a job or of an answer.
    Schema {
        /// The file that it describes.
        file: ProtocolFile,
    },
    /// Write a job, to try a program with: DIR/job.json.
    Job {
        /// A case file, or the name of a bundled case.
        case: String,
        /// Folder for the files.
        out: PathBuf,
        /// Distance of nodes, in metres or as a factor of the case's own.
        #[arg(long, default_value = "x1")]
        spacing: Spacing,
    },
    /// Say what is wrong with an answer to a job.
    Check {
        /// The job.
        job: PathBuf,
        /// The answer.
        answer: PathBuf,
    },
    /// Solve a job with mtled and write the answer.
    Solve {
        /// The job.
        job: PathBuf,
        /// The answer, a new file.
        answer: PathBuf,
        #[command(flatten)]
        set: SetArgs,
    },
}

/// A file of the protocol.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProtocolFile {
    /// What a program reads.
    Job,
    /// What it writes.
    Answer,
}

/// Time limit of jobs that nobody watches \[s\].
const TIME_LIMIT_S: f64 = 60.0;

pub(crate) fn protocol(command: &ProtocolCommand, common: &Common) -> Result<u8> {
    match command {
        ProtocolCommand::Schema { file } => {
            let schema = match file {
                ProtocolFile::Job => job_schema(),
                ProtocolFile::Answer => answer_schema(),
            };
            print_data(&format!("{schema}\n"))?;
            Ok(0)
        }
        ProtocolCommand::Job { case, out, spacing } => write_job(case, out, *spacing, common),
        ProtocolCommand::Check { job, answer } => check(job, answer, common),
        ProtocolCommand::Solve { job, answer, set } => {
            let solved = solve_job(&read_job(job)?, &set.overrides);
            let reply = solved.with_context(|| format!("cannot solve {}", job.display()))?;
            write_atomically(answer, (serde_json::to_string(&reply)? + "\n").as_bytes())?;
            Ok(0)
        }
    }
}

fn read_job(path: &Path) -> Result<Job> {
    let shown = path.display();
    let text = read_text(path).with_context(|| format!("cannot read {shown}"))?;
    parse_job(&text).with_context(|| format!("{shown} is not a job"))
}

fn write_job(case: &str, out: &Path, spacing: Spacing, common: &Common) -> Result<u8> {
    ensure_writable(out)?;
    let out = std::path::absolute(out)?;
    // The label maps of bundled cases must be where the job says.
    let folder = tempfile::tempdir()?;
    let mut source = Source::find(case, folder.path(), &[]).context("the case cannot be used")?;
    if source.file.starts_with(folder.path()) {
        unpack(&out.join("bundled"))?;
        let file = out.join("bundled/cases").join(format!("{case}.toml"));
        source = Source::find(&file.display().to_string(), folder.path(), &[])?;
    }
    let Some(spacing_m) = spacing.metres(source.case.problem.recipe.spacing()) else {
        bail!("{case} has no spacing; give --spacing in metres");
    };
    std::fs::create_dir_all(&out)?;
    let case = absolute(&source)?;
    let known = ReferenceSolution::bundled(&case);
    let instants = known.map_or_else(|| vec![case.problem.motion.end()], |known| known.times);
    let at = Resolution { spacing_m, level: 0, levels: 1, time_limit_s: TIME_LIMIT_S };
    let job = Job::new(&case, at, &instants);
    let job = job.map_err(|mistake| one_error(vec![mistake]))?;
    let path = out.join("job.json");
    write_atomically(&path, (serde_json::to_string_pretty(&job)? + "\n").as_bytes())?;
    common.note(&format!("written to {}", path.display()));
    Ok(0)
}

/// Exit code 1 says that the answer breaks the protocol.
fn check(job: &Path, answer: &Path, common: &Common) -> Result<u8> {
    let path = job;
    let job = read_job(path)?;
    let named = format!("the problem of {}", path.display());
    let case = parse_case(&job.case_text()?, &named, Path::new(".")).map_err(one_error)?;
    let text = match read_reply(answer, &case, job.instants_s.len()) {
        Err(fault) => {
            common.complain(format!("{}: {fault}", answer.display()));
            return Ok(1);
        }
        Ok(SoundReply::Refused(refusal)) => {
            let refused = refusal.refused;
            format!("a sound refusal, {}: {}", refused.reason.label(), refused.what)
        }
        Ok(SoundReply::Answered(answered)) => {
            let given = answered.values.iter().flatten().count();
            format!(
                "a sound answer of {} {}: {given} quantities, {} unknowns",
                answered.solver.name, answered.solver.version, answered.unknowns
            )
        }
    };
    print_text(&format!("{}: {text}\n", answer.display()))?;
    Ok(0)
}
