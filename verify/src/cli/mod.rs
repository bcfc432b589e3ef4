//! The command line: parse, dispatch, exit code.

mod answers;
mod case;
mod common;
mod contest;
mod init;
mod inspect;
mod lab;
mod load;
mod manual;
mod messages;
mod progress;
mod protocol;
mod publish;
mod python;
mod reference;
mod report;
mod solve;
mod streams;
mod study;
mod verify;
mod view;
mod warp;

use answers::{frequencies, sensitivity, unload};
use clap::{CommandFactory, Parser, Subcommand};
use common::{ARGUMENTS, COULD_NOT_RUN, Common, Format, STOPPED, arguments};
use lab::{budget, runs, tune};
use std::ffi::OsString;
use std::process::ExitCode;
use streams::or_reader_has_ended;

/// Meshless soft-tissue solver with its verification.
///
/// Exit codes: 0 success, 1 a check failed, 2 could not run, 3 inconclusive or doubtful, 130 stopped by Ctrl-C (files are
/// complete up to that moment). Data go to standard output, progress and messages to standard
/// error; with --format json the first is one JSON document, the second one JSON object per line.
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
  mtled verify --only brain --out brain_report  run one study
  mtled verify --baseline baseline.json         has anything got worse?
  mtled init my_cases                           a gate for your own cases: suite, baseline, CI
  mtled verify --suite my_cases/suite.toml      have errors or answers of these got worse?
  mtled report last_week reports/verify         compare two runs
  mtled solve reference/cases/brain_slice.toml  solve a case, write a page, VTU, CSV and JSON files
  mtled view reports/brain_slice -o brain.svg   draw the body before and after
  mtled warp reports/brain_slice --image t1.nii deform an image by the result of a run
  mtled inspect my_case.toml                    are its nodes and supports suitable?
  mtled budget my_case.toml                     how large is the error, why, and at what cost?
  mtled sensitivity my_case.toml                which of its numbers matter most?
  mtled frequencies my_case.toml                how fast does its body vibrate, and how?
  mtled unload my_case.toml                     what shape has it without its loads?
  mtled tune my_case.toml --target-error 1%     the cheapest recipe with this accuracy
  mtled study convergence my_case.toml          errors over spacings, with orders
  mtled case new block -o my_case.toml          a commented case to start from
  mtled case check my_case.toml                 find the mistakes in a case file
  mtled case list                               the bundled cases
  mtled runs export -o runs.csv                 the results of stored runs as a table
  mtled contest run --solver 'mine=python3 mine.py {job} {answer}'
                                                how accurate and fast is my own solver?
  mtled reference check                         do the finite-element references agree?";

#[derive(Debug, Subcommand)]
enum Command {
    /// Solve a case file.
    Solve(solve::SolveArgs),
    /// Draw the body of a solved case, before and after, as SVG.
    View(view::ViewArgs),
    /// Deform images and move landmarks by the displacement field of a solved case.
    Warp(warp::WarpArgs),
    /// Examine the nodes, supports and quadrature of a case without running it: points per node,
    /// condition numbers, masses, zero-energy modes, time step.
    Inspect(inspect::InspectArgs),
    /// Run the verification studies and write their report.
    Verify(verify::VerifyArgs),
    /// Write a suite of your own cases with references, bounds and a baseline, for a gate in CI.
    Init(init::InitArgs),
    /// Estimate the error of a case, its parts, and the cost of reducing each.
    Budget(budget::BudgetArgs),
    /// Find which numbers of a static case matter most for its answers, in per cent per per cent.
    Sensitivity(sensitivity::SensitivityArgs),
    /// Find the lowest natural frequencies of the body of a case at rest, and how it vibrates.
    Frequencies(frequencies::FrequenciesArgs),
    /// Find the body without loads of a case whose shape is that under its loads, such as that of an image.
    Unload(unload::UnloadArgs),
    /// Find the cheapest recipe with at most a given error, or the most accurate one for a given
    /// cost.
    Tune(tune::TuneArgs),
    /// Write a report again from its results.json, or compare two reports.
    Report(report::ReportArgs),
    /// Study a case over ranges of its recipe, or race against finite elements.
    #[command(subcommand)]
    Study(study::StudyCommand),
    /// Put any solvers beside each other on the problems of the benchmark: run them, judge stored
    /// results, write pages.
    #[command(subcommand)]
    Contest(contest::ContestCommand),
    /// List, show or remove the stored records of runs.
    #[command(subcommand)]
    Runs(runs::RunsCommand),
    /// Copy the records of several stores into one.
    Merge(runs::MergeArgs),
    /// Check, update, list or describe case files.
    #[command(subcommand)]
    Case(case::CaseCommand),
    /// Check, show or recompute the finite-element references.
    #[command(subcommand)]
    Reference(reference::ReferenceCommand),
    /// Jobs and answers of the solver protocol, by which `mtled contest` measures any program.
    #[command(subcommand)]
    Protocol(protocol::ProtocolCommand),
    /// Print a completion script for a shell.
    Completions { shell: clap_complete::Shell },
    /// Print the manual page of the program, or write a page for every command.
    Man(manual::ManArgs),
}

/// Runs the command line of this process and returns the exit code.
pub fn run() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os().skip(1).collect()))
}

/// Runs a command with the arguments behind the name of the program, once in a process, and
/// returns the exit code.
pub fn run_with(arguments: Vec<OsString>) -> u8 {
    let arguments = ARGUMENTS.get_or_init(|| arguments);
    let program = OsString::from("mtled");
    let cli = match Cli::try_parse_from(std::iter::once(&program).chain(arguments)) {
        Ok(cli) => cli,
        Err(answer) => return without_a_command(&answer),
    };
    let pool = cli.common.threads.map(|threads| {
        rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build_global()
    });
    // A second Ctrl-C ends the program at once.
    let handler = ctrlc::set_handler(|| {
        if mtled_run::run::interrupted() {
            std::process::exit(STOPPED as i32);
        }
        mtled_run::run::interrupt();
    });
    let result = match (pool, handler) {
        (Some(Err(error)), _) => Err(error.into()),
        (_, Err(error)) => Err(error.into()),
        // In the pool: threads outside it would have to wake those inside for every sum.
        _ => rayon::scope(|_| dispatch(&cli)),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            cli.common.failure(&error);
            COULD_NOT_RUN
        }
    }
}

/// Prints help, the version, or what is wrong with the arguments; returns the exit code.
fn without_a_command(answer: &clap::Error) -> u8 {
    let common = Common { threads: None, quiet: false, format: requested_format() };
    if answer.use_stderr() {
        match common.format {
            Format::Json => common.complain(answer.render().to_string().trim_end()),
            _ => drop(answer.print()),
        }
        return COULD_NOT_RUN;
    }
    match or_reader_has_ended(answer.print()) {
        Ok(()) => 0,
        Err(error) => {
            common.failure(&error.into());
            COULD_NOT_RUN
        }
    }
}

/// The format that is asked for where the arguments as a whole cannot be read.
fn requested_format() -> Format {
    let arguments = arguments();
    let apart = arguments.windows(2).any(|pair| pair[0] == "--format" && pair[1] == "json");
    if apart || arguments.iter().any(|argument| argument == "--format=json") {
        Format::Json
    } else {
        Format::Human
    }
}

fn dispatch(cli: &Cli) -> anyhow::Result<u8> {
    match &cli.command {
        Command::Solve(arguments) => solve::solve(arguments, &cli.common),
        Command::View(arguments) => view::view(arguments, &cli.common),
        Command::Warp(arguments) => warp::warp(arguments, &cli.common),
        Command::Inspect(arguments) => inspect::inspect(arguments, &cli.common),
        Command::Verify(arguments) => verify::verify(arguments, &cli.common),
        Command::Init(arguments) => init::init(arguments, &cli.common),
        Command::Budget(arguments) => budget::budget(arguments, &cli.common),
        Command::Sensitivity(arguments) => sensitivity::sensitivity(arguments, &cli.common),
        Command::Frequencies(arguments) => frequencies::frequencies(arguments, &cli.common),
        Command::Unload(arguments) => unload::unload(arguments, &cli.common),
        Command::Tune(arguments) => tune::tune_cases(arguments, &cli.common),
        Command::Report(arguments) => report::report(arguments, &cli.common),
        Command::Study(command) => study::study(command, &cli.common),
        Command::Contest(command) => contest::contest(command, &cli.common),
        Command::Runs(command) => runs::runs(command, &cli.common),
        Command::Merge(arguments) => runs::merge(arguments, &cli.common),
        Command::Case(command) => case::case(command, &cli.common),
        Command::Reference(command) => reference::reference(command, &cli.common),
        Command::Protocol(command) => protocol::protocol(command, &cli.common),
        Command::Completions { shell } => manual::completions(*shell, Cli::command()),
        Command::Man(arguments) => manual::man(arguments, Cli::command()),
    }
}
