//! `mtled bench`.

use super::common::Common;
use crate::speed::bench::{measure, to_markdown};
use clap::Args;

#[derive(Debug, Args)]
pub struct BenchArgs {
    /// Smaller bodies and fewer repetitions: about a minute instead of several.
    #[arg(long)]
    quick: bool,
}

pub fn bench(arguments: &BenchArgs, common: &Common) -> anyhow::Result<u8> {
    let figures = measure(arguments.quick, &|name| common.note(&format!("measuring: {name}")))?;
    let json = || Ok(serde_json::to_string_pretty(&figures)? + "\n");
    // The tables are the result, so that --quiet does not suppress them.
    common.print_result(&json, &|| to_markdown(&figures))?;
    Ok(0)
}
