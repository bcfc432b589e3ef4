//! `mtled bench`.

use crate::cli::{Common, Format, print_data};
use crate::speed::bench::{measure, to_markdown};
use clap::Args;

#[derive(Debug, Args)]
pub struct BenchArgs {
    /// Smaller bodies and fewer repetitions: about a minute instead of several.
    #[arg(long)]
    quick: bool,
}

pub fn bench(arguments: &BenchArgs, common: &Common) -> anyhow::Result<u8> {
    let tell = |what: &str| {
        if !common.quiet {
            eprintln!("measuring: {what}");
        }
    };
    let figures = measure(arguments.quick, &tell)?;
    match common.format {
        Format::Human => print_data(&to_markdown(&figures))?,
        Format::Json => print_data(&(serde_json::to_string_pretty(&figures)? + "\n"))?,
    }
    Ok(0)
}
