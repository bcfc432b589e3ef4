//! `mtled unload`.

use crate::cli::common::{Common, INCONCLUSIVE, STOPPED};
use crate::cli::load::{SetArgs, located};
use crate::cli::progress::progress_bar;
use anyhow::Result;
use clap::Args;
use mtled::unloaded::Unloading;
use mtled_lab::unloaded::{find_unloaded, unloaded_json, unloaded_text, write_unloaded_of};
use mtled_run::run::load;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct UnloadArgs {
    /// Case file (TOML), or name of a bundled case, whose shape is that under its pressures and
    /// uniform body forces.
    case: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    /// Largest distance to the known shape, when the body is loaded again, over the largest displacement.
    #[arg(long, value_name = "NUMBER", default_value_t = Unloading::default().tolerance, value_parser = tolerance)]
    tolerance: f64,
    /// Solutions under the whole of the loads, at most.
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u16).range(1..=1000))]
    most: u16,
    /// Folder for unloaded.json, body_unloaded.vtu, nodes_unloaded.vtu and, in space, unloaded.stl.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number < 1.0 => Ok(number),
        _ => Err("it must lie in (0, 1)".into()),
    }
}

pub(crate) fn unload(arguments: &UnloadArgs, common: &Common) -> Result<u8> {
    let case = load(&arguments.case, &arguments.set.overrides)?;
    let bar = progress_bar(common);
    let notify = |fraction: f64, count: usize| {
        bar.set_position((1000.0 * fraction) as u64);
        bar.set_message(format!("{count}"));
    };
    let settings = Unloading { tolerance: arguments.tolerance, most: arguments.most.into() };
    let found = find_unloaded(&case, settings, &notify);
    bar.finish_and_clear();
    let found = found.map_err(|error| located(&case, &error))?;
    if found.stopped {
        return Ok(STOPPED);
    }
    case.notes.iter().for_each(|note| common.warn(note));
    if let Some(folder) = &arguments.out {
        write_unloaded_of(&found, folder)?;
    }
    common
        .print_result(&|| Ok(format!("{}\n", unloaded_json(&found))), &|| unloaded_text(&found))?;
    if found.found {
        return Ok(0);
    }
    common.complain(format!(
        "after {} solutions the body loaded again is still farther from the known shape than the tolerance: allow \
         more with --most, or a larger --tolerance",
        arguments.most
    ));
    Ok(INCONCLUSIVE)
}
