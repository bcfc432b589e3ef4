//! `mtled inspect`.

mod inspection;
mod text;

use super::common::{COULD_NOT_RUN, Common, Format, print_data};
use super::load::{diagnose, load};
use crate::run::prepare;
use clap::Args;
use inspection::{Search, examine};
use std::path::PathBuf;
use text::{advice, to_json, to_text};

#[derive(Debug, Args)]
pub struct InspectArgs {
    /// Case file (TOML).
    case: PathBuf,
    /// Whether to search for zero-energy modes: "auto" does so up to 20 000 nodes, which takes
    /// seconds.
    #[arg(long, value_enum, default_value_t = Search::Auto)]
    modes: Search,
}

pub fn inspect(arguments: &InspectArgs, common: &Common) -> anyhow::Result<u8> {
    let Some(case) = load(&arguments.case) else { return Ok(COULD_NOT_RUN) };
    let shown = prepare(&case.problem).and_then(|prepared| {
        let inspection = examine(&case, &prepared, arguments.modes)?;
        Ok(match common.format {
            Format::Json => format!("{}\n", to_json(&inspection)),
            Format::Human if common.quiet => advice(&inspection).join("\n") + "\n",
            Format::Human => to_text(&inspection),
        })
    });
    match shown {
        Ok(text) => {
            print_data(&text)?;
            Ok(0)
        }
        Err(error) => {
            eprintln!("{}", diagnose(&case, &error));
            Ok(COULD_NOT_RUN)
        }
    }
}
