//! `mtled frequencies`.

use crate::cli::common::{Common, INCONCLUSIVE, STOPPED};
use crate::cli::load::{SetArgs, located};
use crate::cli::progress::progress_bar;
use anyhow::Result;
use clap::{Args, ValueEnum};
use mtled::frequencies::{CONVERGED, MassKind};
use mtled_run::frequencies::{Unfound, find_modes, to_json, to_text, write_modes_of};
use mtled_run::run::load;
use std::path::PathBuf;

/// Most frequencies of a search: their vectors must fit into the memory.
const MOST: i64 = 1000;

#[derive(Debug, Args)]
pub(crate) struct FrequenciesArgs {
    /// Case file (TOML), or name of a bundled case. What its conditions prescribe counts as held; its
    /// loads and obstacles are left out; springs and fluids count with their stiffness.
    case: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    /// How many, beside those of rigid motions.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=MOST))]
    modes: u16,
    /// Masses: "consistent" ones follow the displacement within the body; "lumped" ones at the
    /// nodes are those of motions, and make frequencies lower.
    #[arg(long, value_enum, default_value_t = Masses::Consistent)]
    mass: Masses,
    /// Folder for frequencies.json and the modes: body_modes.vtu, nodes_modes.vtu.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Masses {
    Consistent,
    Lumped,
}

pub(crate) fn frequencies(arguments: &FrequenciesArgs, common: &Common) -> Result<u8> {
    let case = load(&arguments.case, &arguments.set.overrides)?;
    let masses = match arguments.mass {
        Masses::Consistent => MassKind::Consistent,
        Masses::Lumped => MassKind::Lumped,
    };
    let count = usize::from(arguments.modes);
    let bar = progress_bar(common);
    let notify = |found: usize| {
        bar.set_position((1000 * found / count) as u64);
        bar.set_message(format!("{found} of {count} found"));
    };
    let found = find_modes(&case, count, masses, &notify);
    bar.finish_and_clear();
    let found = match found {
        Ok(found) => found,
        Err(Unfound::Stopped) => return Ok(STOPPED),
        Err(Unfound::Solver(error)) => return Err(located(&case, &error)),
    };
    case.notes.iter().chain(&found.doubts).for_each(|doubt| common.warn(doubt));
    if let Some(folder) = &arguments.out {
        write_modes_of(&found, folder)?;
    }
    common.print_result(&|| Ok(format!("{}\n", to_json(&found))), &|| to_text(&found))?;
    if found.modes.converged() {
        return Ok(0);
    }
    let open = found.modes.modes.iter().filter(|mode| !mode.converged).count();
    common.complain(format!(
        "{open} of {count} frequencies have residuals above {CONVERGED:.0e}, and others may lie between them: \
         ask for fewer, or look with `mtled inspect` whether motions without strain energy are left"
    ));
    Ok(INCONCLUSIVE)
}
