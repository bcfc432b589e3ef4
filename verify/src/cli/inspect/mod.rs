//! `mtled inspect`.

mod inspection;
mod text;

use super::common::{Common, Format};
use super::load::{SetArgs, located};
use super::streams::{print_json, print_text};
use clap::Args;
use inspection::{Search, examine};
use mtled::Simulation;
use mtled_run::run::load;
use std::path::PathBuf;
use text::{advice, to_json, to_text};

#[derive(Debug, Args)]
pub(crate) struct InspectArgs {
    /// Case file (TOML), or name of a bundled case.
    case: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    /// Whether to search for zero-energy modes: "auto" does so up to 20 000 nodes, which takes
    /// seconds.
    #[arg(long, value_enum, default_value_t = Search::Auto)]
    modes: Search,
}

pub(crate) fn inspect(arguments: &InspectArgs, common: &Common) -> anyhow::Result<u8> {
    let case = load(&arguments.case, &arguments.set.overrides)?;
    let simulation =
        Simulation::with_any_recipe(&case.problem).map_err(|error| located(&case, &error))?;
    let inspection =
        examine(&case, &simulation, arguments.modes).map_err(|error| located(&case, &error))?;
    match common.format {
        Format::Json => print_json(&format!("{}\n", to_json(&inspection)))?,
        _ if common.quiet => print_text(&(advice(&inspection).join("\n") + "\n"))?,
        _ => print_text(&to_text(&inspection))?,
    }
    Ok(0)
}
