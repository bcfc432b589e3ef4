//! `mtled runs` and `mtled merge`.

use crate::cli::sweep::STORE;
use crate::cli::{Common, Format, print_data};
use crate::explore::store::{Outcome, Record, Store, solver_identity};
use anyhow::{Result, bail};
use clap::{Args, Subcommand};
use comfy_table::{Table, presets};
use std::path::PathBuf;

#[derive(Debug, Subcommand)]
pub enum RunsCommand {
    /// List the records of a store, a line each.
    List(StoreArgs),
    /// Print one record as JSON.
    Show {
        /// Key, or its first digits.
        key: String,
        #[command(flatten)]
        store: StoreArgs,
    },
    /// Remove records that other sources of the solver made, and what killed
    /// programs have left.
    Prune {
        /// Remove every record.
        #[arg(long)]
        all: bool,
        #[command(flatten)]
        store: StoreArgs,
    },
}

#[derive(Debug, Args)]
pub struct StoreArgs {
    /// Folder of the records.
    #[arg(long, default_value = STORE, value_name = "DIR")]
    store: PathBuf,
}

#[derive(Debug, Args)]
pub struct MergeArgs {
    /// Stores that are read.
    #[arg(required = true)]
    from: Vec<PathBuf>,
    /// The store that receives their records.
    #[arg(long, default_value = STORE, value_name = "DIR")]
    into: PathBuf,
}

pub fn runs(command: &RunsCommand, common: &Common) -> Result<u8> {
    match command {
        RunsCommand::List(from) => list(&Store::new(&from.store), common),
        RunsCommand::Show { key, store } => show(&Store::new(&store.store), key),
        RunsCommand::Prune { all, store } => prune(&Store::new(&store.store), *all),
    }
}

fn list(store: &Store, common: &Common) -> Result<u8> {
    let records = store.all()?;
    if common.format == Format::Json {
        print_data(&(serde_json::to_string(&records)? + "\n"))?;
        return Ok(0);
    }
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(["key", "run", "case", "settings", "CPU s", "ended", "solver"]);
    for record in &records {
        let settings: Vec<String> = record.settings.iter().map(|s| s.to_string()).collect();
        let ended = match &record.outcome {
            Outcome::Done { .. } => "done".to_string(),
            Outcome::Failed { reason, .. } => reason.chars().take(60).collect(),
        };
        let solver = if record.solver == solver_identity() { "this one" } else { "another" };
        table.add_row([
            record.key[..12.min(record.key.len())].to_string(),
            format!("{:?}", record.job).to_lowercase(),
            record.case.clone(),
            settings.join(", "),
            format!("{:.2}", record.cpu_s()),
            ended,
            solver.into(),
        ]);
    }
    print_data(&format!("{table}\n{} records in {}\n", records.len(), store.folder().display()))?;
    Ok(0)
}

fn show(store: &Store, key: &str) -> Result<u8> {
    let found: Vec<Record> =
        store.all()?.into_iter().filter(|record| record.key.starts_with(key)).collect();
    match found.as_slice() {
        [one] => {
            print_data(&(serde_json::to_string_pretty(one)? + "\n"))?;
            Ok(0)
        }
        [] => bail!("no record in {} has the key {key}", store.folder().display()),
        many => bail!("{} records have keys that begin with {key}; give more digits", many.len()),
    }
}

fn prune(store: &Store, all: bool) -> Result<u8> {
    let mut removed = 0;
    for record in store.all()? {
        if all || record.solver != solver_identity() {
            store.remove(&record.key)?;
            removed += 1;
        }
    }
    let leftovers = store.leftovers()?;
    leftovers.iter().try_for_each(std::fs::remove_file)?;
    print_data(&format!(
        "{removed} records removed, {} files that killed programs had left\n",
        leftovers.len()
    ))?;
    Ok(0)
}

pub fn merge(arguments: &MergeArgs) -> Result<u8> {
    let into = Store::new(&arguments.into);
    let (mut taken, mut known) = (0, 0);
    for folder in &arguments.from {
        if !folder.is_dir() {
            bail!("there is no store {}", folder.display());
        }
        for record in Store::new(folder).all()? {
            match into.find(&record.key)? {
                // Runs are deterministic; only their times may differ.
                Some(old) if old.outcome != record.outcome => bail!(
                    "the record {} differs between {} and {}: they were made by programs that \
                     do not give the same bits",
                    record.key,
                    folder.display(),
                    arguments.into.display()
                ),
                Some(_) => known += 1,
                None => {
                    into.keep(&record)?;
                    taken += 1;
                }
            }
        }
    }
    print_data(&format!("{taken} records taken, {known} were there\n"))?;
    Ok(0)
}
