//! `mtled-fuzz`: see `--help`.

use std::process::ExitCode;

#[cfg(not(unix))]
fn main() -> ExitCode {
    eprintln!("mtled-fuzz limits its child processes as Unix does; there is no other way yet");
    ExitCode::from(2)
}

#[cfg(unix)]
fn main() -> ExitCode {
    if let Some(code) = mtled_fuzz::child::run_task() {
        return code;
    }
    match unix::run_all() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

#[cfg(unix)]
mod unix {
    use anyhow::Result;
    use clap::Parser;
    use mtled_fuzz::campaign::{Options, run};
    use mtled_fuzz::process::Limits;
    use mtled_fuzz::target::Target;
    use mtled_fuzz::{seeds, tally};
    use serde_json::json;
    use std::path::PathBuf;
    use std::process::ExitCode;
    use std::time::Duration;

    /// Gives mutated files to everything of mtled that reads files. Exit codes: 0 nothing was found,
    /// 1 something was found, 2 could not run.
    #[derive(Debug, Parser)]
    #[command(name = "mtled-fuzz", version)]
    struct Arguments {
        /// Time for mutations; 0 tries the corpus only.
        #[arg(long, default_value_t = 20.0, value_name = "S")]
        seconds: f64,
        /// Inputs that are tried at the same time, each on one thread.
        #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
        jobs: u16,
        /// Of the random numbers: the same one gives the same inputs.
        #[arg(long, default_value_t = 1, value_name = "N")]
        seed: u64,
        /// Some targets only.
        #[arg(long, value_enum, value_delimiter = ',', value_name = "TARGETS")]
        only: Vec<Target>,
        /// CPU time of one input; a longer one is a finding.
        #[arg(long, default_value_t = Limits::default().cpu_s, value_name = "S")]
        limit: f64,
        /// Folder of earlier findings, to which new ones are added [default: that of the sources].
        #[arg(long, value_name = "DIR")]
        corpus: Option<PathBuf>,
        /// Writes counts and findings to this JSON file.
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    }

    pub(crate) fn run_all() -> Result<ExitCode> {
        let arguments = Arguments::parse();
        let chosen = arguments.only.clone();
        let options = Options {
            targets: if chosen.is_empty() { Target::ALL.to_vec() } else { chosen },
            time: Duration::from_secs_f64(arguments.seconds.clamp(0.0, 1e7)),
            jobs: arguments.jobs.into(),
            seed: arguments.seed,
            corpus: arguments.corpus.unwrap_or_else(|| seeds::folder().join("corpus")),
            limits: Limits { cpu_s: arguments.limit, ..Limits::default() },
        };
        let results = run(&options, &|text| eprintln!("{text}"))?;
        print!("{}", tally::markdown(&results.tallies));
        println!("\n{} distinct findings", results.findings.len());
        if let Some(path) = arguments.out {
            let findings = results.findings.iter().map(|(target, finding, path)| {
                json!({ "target": target.name(), "kind": finding.kind.name(),
                        "detail": finding.detail, "input": path })
            });
            let document = json!({
                "seconds": arguments.seconds,
                "jobs": arguments.jobs,
                "seed": arguments.seed,
                "targets": tally::json(&results.tallies),
                "findings": findings.collect::<Vec<_>>(),
            });
            std::fs::write(path, format!("{document:#}\n"))?;
        }
        Ok(ExitCode::from(u8::from(!results.findings.is_empty())))
    }
}
