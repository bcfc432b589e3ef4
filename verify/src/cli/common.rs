//! What every command needs: options, exit codes, results.

use super::streams::{print_coloured, print_json, print_text};
use anyhow::Result;
use clap::{Args, ValueEnum};
use std::ffi::OsString;
use std::io::IsTerminal;
use std::sync::OnceLock;

/// Exit code where something could not be run.
pub(crate) const COULD_NOT_RUN: u8 = 2;
/// Exit code where a question could not be decided, or a run is doubtful.
pub(crate) const INCONCLUSIVE: u8 = 3;
/// Exit code where the user stopped a run.
pub(crate) const STOPPED: u8 = 130;

#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct Common {
    /// Number of threads; results do not depend on it [default: all processors].
    #[arg(long, global = true, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Print errors only: no progress and no summary.
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Format of standard output and of the messages on standard error.
    #[arg(long, global = true, value_enum, default_value_t = Format::Human)]
    pub format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Text for people.
    Human,
    /// One JSON document, and one JSON object per line on standard error.
    Json,
}

impl Common {
    /// Whether progress is drawn on standard error.
    pub(crate) fn draws(&self) -> bool {
        !self.quiet && std::io::stderr().is_terminal()
    }

    /// Whether standard output takes colour.
    pub(crate) fn colours(&self) -> bool {
        std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
    }

    /// Prints a result as a JSON document or as text, also if quiet.
    pub(crate) fn print_result(
        &self,
        json: &dyn Fn() -> Result<String>,
        text: &dyn Fn() -> String,
    ) -> Result<()> {
        match self.format {
            Format::Json => print_json(&json()?)?,
            _ => print_text(&text())?,
        }
        Ok(())
    }

    /// Prints a JSON document or, unless quiet, a summary.
    pub(crate) fn print_summary(
        &self,
        json: &dyn Fn() -> Result<String>,
        text: &dyn Fn() -> String,
    ) -> Result<()> {
        if self.quiet && self.format != Format::Json {
            Ok(())
        } else {
            self.print_result(json, text)
        }
    }

    /// As [`Self::print_summary`], for text with colours, in which texts from files have been
    /// escaped.
    pub(crate) fn print_coloured_summary(
        &self,
        json: &dyn Fn() -> Result<String>,
        text: &dyn Fn() -> String,
    ) -> Result<()> {
        match self.format {
            Format::Json => print_json(&json()?)?,
            _ if self.quiet => {}
            _ => print_coloured(&text())?,
        }
        Ok(())
    }
}

/// What stands behind the name of the program on the command line.
pub(crate) static ARGUMENTS: OnceLock<Vec<OsString>> = OnceLock::new();

/// [`ARGUMENTS`] as text.
pub(crate) fn arguments() -> Vec<String> {
    let arguments = ARGUMENTS.get().into_iter().flatten();
    arguments.map(|argument| argument.to_string_lossy().into_owned()).collect()
}

/// The command as it was typed.
pub(crate) fn command_line() -> String {
    let arguments = arguments()
        .into_iter()
        .map(|argument| if argument.contains(' ') { format!("\"{argument}\"") } else { argument });
    format!("mtled {}", arguments.collect::<Vec<_>>().join(" "))
}
