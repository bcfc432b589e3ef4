//! Fills the tables of the README and of the guide from what was measured, so that no figure in
//! them is typed by hand.

mod bench;
mod estimates;
mod markers;
mod pairs;
mod verify;

use anyhow::Context;
use clap::{Args, Parser};
use std::path::{Path, PathBuf};

/// Fill the tables of the README and of the guide from the output of `mtled verify`, `cargo bench`
/// or `mtled contest race`.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    #[command(flatten)]
    source: Source,
    /// The files with the markers between which the tables stand.
    #[arg(long, default_values = ["README.md", "verify/guide/src/results.md"])]
    page: Vec<PathBuf>,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Source {
    /// Fill the table of `mtled verify` from its results.json.
    #[arg(long, value_name = "RESULTS")]
    verify: Option<PathBuf>,
    /// Fill the tables of `cargo bench` from Criterion's folder.
    #[arg(long, value_name = "FOLDER", num_args = 0..=1, default_missing_value = "target/criterion")]
    bench: Option<PathBuf>,
    /// Fill the table of `mtled contest race` from its tables.md.
    #[arg(long, value_name = "TABLES")]
    race: Option<PathBuf>,
}

fn main() -> anyhow::Result<()> {
    let Arguments { source, page } = Arguments::parse();
    if let Some(tables) = &source.race {
        let whole = markers::first_table(&read(tables)?)?;
        fill(&page, "race", &whole)?;
        fill(&page, "race_at_one_per_cent", &markers::rows_with(&whole, "| 1.00 % |"))?;
        print!("{whole}");
        return Ok(());
    }
    let (name, table) = match &source {
        Source { verify: Some(results), .. } => ("verify", verify::table(results)?),
        Source { bench: Some(criterion), .. } => ("bench", bench::tables(criterion)?),
        _ => anyhow::bail!("nothing to fill a table from"),
    };
    fill(&page, name, &table)?;
    print!("{table}");
    Ok(())
}

/// Every page that has the markers of this table; one of them must.
fn fill(pages: &[PathBuf], name: &str, table: &str) -> anyhow::Result<()> {
    let mut filled = 0;
    for page in pages {
        let text = read(page)?;
        if markers::has(&text, name) {
            std::fs::write(page, markers::fill(&text, name, table)?)
                .with_context(|| format!("cannot write {}", page.display()))?;
            filled += 1;
        }
    }
    anyhow::ensure!(filled > 0, "no page has a marker of {name}");
    Ok(())
}

fn read(path: &Path) -> anyhow::Result<String> {
    std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}
