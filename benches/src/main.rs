//! Fills the tables of the README and of the guide from the output of the commands, so that no figure in it is
//! typed by hand.

mod bench;
mod markers;
mod verify;

use anyhow::Context;
use clap::Parser;
use std::path::{Path, PathBuf};

/// Fill the tables of the README and of the guide from the output of `mtled verify`, `mtled bench`
/// and `mtled study race`, or print the table of `cargo bench`.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// Criterion's folder, whose table is printed.
    #[arg(long, default_value = "target/criterion")]
    criterion: PathBuf,
    /// Fill the table of `mtled verify` from its results.json.
    #[arg(long, value_name = "RESULTS", conflicts_with_all = ["bench", "race"])]
    verify: Option<PathBuf>,
    /// Fill the tables of `mtled bench` from its output.
    #[arg(long, value_name = "TABLES", conflicts_with = "race")]
    bench: Option<PathBuf>,
    /// Fill the table of `mtled study race` from its race.md.
    #[arg(long, value_name = "RACE")]
    race: Option<PathBuf>,
    /// The files with the markers between which the tables stand.
    #[arg(long, default_values = ["README.md", "verify/guide/src/results.md"])]
    page: Vec<PathBuf>,
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let (name, table) = match &arguments {
        Arguments { verify: Some(results), .. } => ("verify", verify::table(results)?),
        Arguments { bench: Some(tables), .. } => ("bench", without_title(&read(tables)?)),
        Arguments { race: Some(page), .. } => ("race", markers::first_table(&read(page)?)?),
        _ => {
            print!("{}", bench::table(&arguments.criterion)?);
            return Ok(());
        }
    };
    fill(&arguments.page, name, &table)?;
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

/// The pages have titles of their own.
fn without_title(page: &str) -> String {
    page.lines()
        .filter(|line| !line.starts_with('#'))
        .fold(String::new(), |text, line| text + line + "\n")
}
