//! `mtled reference …`.

mod solve;
mod stored;
mod table;

use super::common::{COULD_NOT_RUN, Common};
use anyhow::Result;
use clap::{Args, Subcommand};
use solve::{SolveReferenceArgs, solve};
use stored::{ReferenceArgs, StoredReference, read};
use table::{check_table, show_text, to_json};

#[derive(Debug, Subcommand)]
pub(crate) enum ReferenceCommand {
    /// Check that every case has a reference of both codes for its current problem, and that
    /// the codes agree within their error bars.
    Check(CheckArgs),
    /// Print the values of a case with error bars, orders, meshes and costs.
    Show {
        /// Name of the case.
        case: String,
        #[command(flatten)]
        from: ReferenceArgs,
    },
    /// Solve cases with the finite-element codes (needs a checkout and Python).
    Solve(SolveReferenceArgs),
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// Names of cases [default: all].
    cases: Vec<String>,
    #[command(flatten)]
    from: ReferenceArgs,
}

pub(crate) fn reference(command: &ReferenceCommand, common: &Common) -> Result<u8> {
    match command {
        ReferenceCommand::Check(arguments) => check(arguments, common),
        ReferenceCommand::Show { case, from } => show(case, from, common),
        ReferenceCommand::Solve(arguments) => solve(arguments, common),
    }
}

fn check(arguments: &CheckArgs, common: &Common) -> Result<u8> {
    let stored = read(&arguments.cases, &arguments.from)?;
    common.print_summary(&|| Ok(format!("{:#}\n", to_json(&stored))), &|| {
        format!("{}\n", check_table(&stored))
    })?;
    let mistakes: Vec<String> = stored.iter().filter_map(StoredReference::mistake).collect();
    mistakes.iter().for_each(|mistake| common.complain(mistake));
    Ok(u8::from(!mistakes.is_empty()))
}

fn show(case: &str, from: &ReferenceArgs, common: &Common) -> Result<u8> {
    let stored = read(&[case.to_string()], from)?;
    match &stored[0].reference {
        Ok(reference) => {
            let json = || Ok(format!("{:#}\n", to_json(&stored)));
            common.print_result(&json, &|| show_text(reference))?;
            Ok(0)
        }
        Err(reason) => {
            common.complain(reason);
            Ok(COULD_NOT_RUN)
        }
    }
}
