//! Writes the tables of the README from what the commands left behind, so that
//! no figure in it is typed by hand.

mod bench;
mod markers;
mod verify;

use anyhow::Context;
use clap::Parser;
use std::path::PathBuf;

/// Fill the tables of the README from the files of `cargo bench` and of
/// `mtled verify`, and print them.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// Criterion's folder.
    #[arg(long, default_value = "target/criterion")]
    criterion: PathBuf,
    /// A results.json of `mtled verify`; fills that table instead.
    #[arg(long, value_name = "RESULTS")]
    verify: Option<PathBuf>,
    /// The file with the markers.
    #[arg(long, default_value = "README.md")]
    readme: PathBuf,
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let (name, table) = match &arguments.verify {
        Some(results) => ("verify", verify::table(results)?),
        None => ("bench", bench::table(&arguments.criterion)?),
    };
    let readme = &arguments.readme;
    let text = std::fs::read_to_string(readme)
        .with_context(|| format!("cannot read {}", readme.display()))?;
    std::fs::write(readme, markers::fill(&text, name, &table)?)
        .with_context(|| format!("cannot write {}", readme.display()))?;
    print!("{table}");
    Ok(())
}
