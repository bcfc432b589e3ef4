//! The command line: parse, dispatch, exit code.

mod bench;
mod budget;
mod case;
mod inspect;
mod progress;
mod python;
mod reference;
mod report;
mod runs;
mod solve;
mod study;
mod sweep;
mod tune;
mod verify;

use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use std::io::{IsTerminal, Write};
use std::process::ExitCode;

/// Meshless soft-tissue solver that can be checked.
///
/// Exit codes: 0 all is well, 1 a check failed, 2 could not run, 130 stopped
/// by Ctrl-C (files are complete up to that moment). Data go to standard
/// output, progress and messages to standard error.
#[derive(Debug, Parser)]
#[command(name = "mtled", version, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: Common,
}

const EXAMPLES: &str = "Examples:
  mtled verify                                  check the solver, write reports/verify/index.html
  mtled verify --only brain --out brain_report  one study
  mtled verify --baseline baseline.json         has anything got worse?
  mtled report last_week reports/verify         compare two runs
  mtled solve reference/cases/brain_slice.toml  solve a case, write VTU, CSV and JSON
  mtled inspect my_case.toml                    are its nodes and supports sound?
  mtled budget my_case.toml                     how wrong is it, why, and at what price?
  mtled tune my_case.toml --target-error 1%     the cheapest recipe that is good enough
  mtled study convergence my_case.toml          errors over spacings, with orders
  mtled case check my_case.toml                 find the mistakes in a case file
  mtled case list                               the cases that the program carries
  mtled bench --quick                           how fast is the solver here?
  mtled reference check                         are the finite-element references sound?";

#[derive(Debug, Args)]
struct Common {
    /// Threads to use; results do not depend on it [default: all processors].
    #[arg(long, global = true, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// No progress and no summary, only errors.
    #[arg(short, long, global = true)]
    quiet: bool,
    /// What is written to standard output.
    #[arg(long, global = true, value_enum, default_value_t = Format::Human)]
    format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Text for people.
    Human,
    /// One JSON document.
    Json,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Solve a case file.
    Solve(solve::SolveArgs),
    /// Tell before any run whether a case's nodes, supports and quadrature are
    /// sound: points per node, conditions, masses, zero-energy modes, step.
    Inspect(inspect::InspectArgs),
    /// Run the verification studies and write their report (the main job).
    Verify(verify::VerifyArgs),
    /// Tell how wrong a case is, where the error comes from, and what each part costs.
    Budget(budget::BudgetArgs),
    /// Find the cheapest recipe that meets a wanted error, or the best for a cost.
    Tune(tune::TuneArgs),
    /// Write a report anew from its results.json, or compare two runs.
    Report(report::ReportArgs),
    /// Study a case over ranges of its recipe, or race against finite elements.
    #[command(subcommand)]
    Study(study::StudyCommand),
    /// List, show or remove the records of runs that studies have made.
    #[command(subcommand)]
    Runs(runs::RunsCommand),
    /// Bring the records of several stores together.
    Merge(runs::MergeArgs),
    /// Check, list or describe case files.
    #[command(subcommand)]
    Case(case::CaseCommand),
    /// Check, show or solve again the finite-element references.
    #[command(subcommand)]
    Reference(reference::ReferenceCommand),
    /// Measure how fast the solver is on this machine, beside the machine's own
    /// limits: tables to be pasted into an issue.
    Bench(bench::BenchArgs),
    /// Print a completion script for a shell.
    Completions { shell: clap_complete::Shell },
}

/// Exit code of something that could not run.
const COULD_NOT_RUN: u8 = 2;
/// Exit code of a run that the user stopped.
const STOPPED: u8 = 130;

/// Runs the command line and returns the exit code.
pub fn run() -> ExitCode {
    let cli = Cli::parse();
    let pool = cli.common.threads.map(|threads| {
        rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build_global()
    });
    // A second Ctrl-C ends the program at once.
    let handler = ctrlc::set_handler(|| {
        if crate::run::interrupted() {
            std::process::exit(STOPPED as i32);
        }
        crate::run::interrupt();
    });
    let result = match (pool, handler) {
        (Some(Err(error)), _) => Err(error.into()),
        (_, Err(error)) => Err(error.into()),
        _ => dispatch(&cli),
    };
    match result {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(COULD_NOT_RUN)
        }
    }
}

fn dispatch(cli: &Cli) -> anyhow::Result<u8> {
    match &cli.command {
        Command::Solve(arguments) => solve::solve(arguments, &cli.common),
        Command::Inspect(arguments) => inspect::inspect(arguments, &cli.common),
        Command::Verify(arguments) => verify::verify(arguments, &cli.common),
        Command::Budget(arguments) => budget::budget_of(arguments, &cli.common),
        Command::Tune(arguments) => tune::tune_cases(arguments, &cli.common),
        Command::Report(arguments) => report::report(arguments, &cli.common),
        Command::Study(command) => study::study(command, &cli.common),
        Command::Runs(command) => runs::runs(command, &cli.common),
        Command::Merge(arguments) => runs::merge(arguments),
        Command::Case(command) => case::case(command),
        Command::Reference(command) => reference::reference(command, &cli.common),
        Command::Bench(arguments) => bench::bench(arguments, &cli.common),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "mtled", &mut script);
            print_data(&String::from_utf8_lossy(&script))?;
            Ok(0)
        }
    }
}

/// Writes data to standard output. A reader that has left, as `head` does, is
/// no failure.
fn print_data(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

impl Common {
    /// Whether progress may be drawn on standard error.
    fn draws(&self) -> bool {
        !self.quiet && std::io::stderr().is_terminal()
    }

    /// Whether standard output takes colour.
    fn colours(&self) -> bool {
        std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
    }
}
