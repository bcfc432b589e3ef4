//! What every command needs: options, exit codes, output streams.

use anyhow::Result;
use clap::{Args, ValueEnum};
use std::io::{IsTerminal, Write};

/// Exit code where something could not be run.
pub const COULD_NOT_RUN: u8 = 2;
/// Exit code where the user stopped a run.
pub const STOPPED: u8 = 130;

#[derive(Debug, Args)]
pub struct Common {
    /// Number of threads; results do not depend on it [default: all processors].
    #[arg(long, global = true, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Print errors only: no progress and no summary.
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Format of standard output.
    #[arg(long, global = true, value_enum, default_value_t = Format::Human)]
    pub format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Text for people.
    Human,
    /// One JSON document.
    Json,
}

impl Common {
    /// Whether progress is drawn on standard error.
    pub fn draws(&self) -> bool {
        !self.quiet && std::io::stderr().is_terminal()
    }

    /// Whether standard output takes colour.
    pub fn colours(&self) -> bool {
        std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
    }

    /// Writes a line to standard error, unless quiet.
    pub fn say(&self, text: &str) {
        if !self.quiet {
            eprintln!("{text}");
        }
    }

    /// Prints a result as a JSON document or as text, also if quiet.
    pub fn print_result(
        &self,
        json: &dyn Fn() -> Result<String>,
        text: &dyn Fn() -> String,
    ) -> Result<()> {
        let data = match self.format {
            Format::Json => json()?,
            Format::Human => text(),
        };
        Ok(print_data(&data)?)
    }

    /// Prints a JSON document or, unless quiet, a summary.
    pub fn print_summary(
        &self,
        json: &dyn Fn() -> Result<String>,
        text: &dyn Fn() -> String,
    ) -> Result<()> {
        match self.quiet && self.format == Format::Human {
            true => Ok(()),
            false => self.print_result(json, text),
        }
    }
}

/// Writes to standard output. It is no error if the reader ends early, as `head` does.
pub fn print_data(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

/// The command as it was typed.
pub fn command_line() -> String {
    let arguments = std::env::args().skip(1).map(|argument| match argument.contains(' ') {
        true => format!("\"{argument}\""),
        false => argument,
    });
    format!("mtled {}", arguments.collect::<Vec<_>>().join(" "))
}
