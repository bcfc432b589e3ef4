//! `mtled runs` and `mtled merge`.

use super::args::StoreArgs;
use crate::cli::common::{Common, print_data};
use crate::explore::store::{RunOutcome, RunRecord, Store, solver_identity};
use anyhow::{Result, bail};
use clap::{Args, Subcommand};
use comfy_table::{Table, presets};
use std::path::PathBuf;

#[derive(Debug, Subcommand)]
pub enum RunsCommand {
    /// List the records of a store, one per line.
    List(StoreArgs),
    /// Print one record as JSON.
    Show {
        /// Key of the record, or its first digits.
        key: String,
        #[command(flatten)]
        store: StoreArgs,
    },
    /// Remove records of other versions of the solver and temporary files of killed
    /// programs.
    Prune {
        /// Remove every record.
        #[arg(long)]
        all: bool,
        #[command(flatten)]
        store: StoreArgs,
    },
}

#[derive(Debug, Args)]
pub struct MergeArgs {
    /// Folders of the stores that are read.
    #[arg(required = true)]
    from: Vec<PathBuf>,
    /// Folder of the store that receives their records.
    #[arg(long, default_value = "reports/runs", value_name = "DIR")]
    into: PathBuf,
}

pub fn runs(command: &RunsCommand, common: &Common) -> Result<u8> {
    match command {
        RunsCommand::List(store) => list(&Store::new(&store.store), common),
        RunsCommand::Show { key, store } => show(&Store::new(&store.store), key),
        RunsCommand::Prune { all, store } => prune(&Store::new(&store.store), *all),
    }
}

fn list(store: &Store, common: &Common) -> Result<u8> {
    let records = store.all()?;
    let json = || Ok(serde_json::to_string(&records)? + "\n");
    let count = records.len();
    common.print_result(&json, &|| {
        format!("{}\n{count} records in {}\n", table(&records), store.folder().display())
    })?;
    Ok(0)
}

fn table(records: &[RunRecord]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(["key", "run", "case", "settings", "CPU s", "outcome", "solver"]);
    for record in records {
        let settings: Vec<String> = record.settings.iter().map(|s| s.to_string()).collect();
        let outcome = match &record.outcome {
            RunOutcome::Done { .. } => "done".to_string(),
            RunOutcome::Failed { reason, .. } => reason.chars().take(60).collect(),
        };
        let this = record.solver == solver_identity();
        table.add_row([
            record.key[..12.min(record.key.len())].to_string(),
            format!("{:?}", record.job).to_lowercase(),
            record.case.clone(),
            settings.join(", "),
            format!("{:.2}", record.cpu_s()),
            outcome,
            if this { "this version" } else { "another" }.into(),
        ]);
    }
    table
}

fn show(store: &Store, key: &str) -> Result<u8> {
    let found: Vec<RunRecord> =
        store.all()?.into_iter().filter(|record| record.key.starts_with(key)).collect();
    match found.as_slice() {
        [one] => {
            print_data(&(serde_json::to_string_pretty(one)? + "\n"))?;
            Ok(0)
        }
        [] => bail!("{} has no record with the key {key}", store.folder().display()),
        many => bail!("{} keys begin with {key}; give more digits", many.len()),
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
        "{removed} records removed, {} temporary files removed\n",
        leftovers.len()
    ))?;
    Ok(0)
}

pub fn merge(arguments: &MergeArgs) -> Result<u8> {
    let into = Store::new(&arguments.into);
    let (mut added, mut known) = (0, 0);
    for folder in &arguments.from {
        if !folder.is_dir() {
            bail!("there is no store {}", folder.display());
        }
        for record in Store::new(folder).all()? {
            match into.find(&record.key)? {
                // Runs are deterministic; only their timings may differ.
                Some(old) if old.outcome != record.outcome => bail!(
                    "the record {} differs between {} and {}: the programs that made \
                     them do not give the same results",
                    record.key,
                    folder.display(),
                    arguments.into.display()
                ),
                Some(_) => known += 1,
                None => {
                    into.write(&record)?;
                    added += 1;
                }
            }
        }
    }
    print_data(&format!("{added} records added, {known} were there already\n"))?;
    Ok(0)
}
