//! `mtled runs` and `mtled merge`.

use super::args::StoreArgs;
use super::export::{ExportArgs, export};
use super::filter::{Chosen, FilterArgs, name_corrupt};
use crate::cli::common::{COULD_NOT_RUN, Common};
use crate::cli::progress::ManyRuns;
use crate::cli::streams::print_json;
use anyhow::{Context, Result, bail};
use clap::{Args, Subcommand};
use comfy_table::{Table, presets};
use mtled_checks::escape::printable;
use mtled_lab::lab::store::{
    Contents, Corrupt, Progress, RunOutcome, RunRecord, Store, TaskRunner, read_part,
    solver_identity,
};
use serde_json::json;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

#[derive(Debug, Subcommand)]
pub(crate) enum RunsCommand {
    /// List the records of a store, one per line.
    List(FilterArgs),
    /// Write the results of the records of a store as a table in CSV.
    Export(ExportArgs),
    /// Print one record as JSON.
    Show {
        /// Key of the record, or its first digits.
        key: String,
        #[command(flatten)]
        store: StoreArgs,
    },
    /// Perform planned runs (`--plan-jobs`) that the store does not have.
    Perform {
        /// Parts of a plan, such as jobs/part-0001.json.
        #[arg(required = true)]
        parts: Vec<PathBuf>,
        #[command(flatten)]
        store: StoreArgs,
    },
    /// Remove records of other versions of the solver and temporary files of killed
    /// programs. Programs that use the store may run meanwhile.
    Prune {
        /// Remove every record, corrupt ones too.
        #[arg(long)]
        all: bool,
        /// Remove records that cannot be read or are not what their names say, too.
        #[arg(long)]
        corrupt: bool,
        #[command(flatten)]
        store: StoreArgs,
    },
}

#[derive(Debug, Args)]
pub(crate) struct MergeArgs {
    /// Folders of the stores that are read.
    #[arg(required = true)]
    from: Vec<PathBuf>,
    /// Folder of the store that receives their records.
    #[arg(long, default_value = "reports/runs", value_name = "DIR")]
    into: PathBuf,
}

pub(crate) fn runs(command: &RunsCommand, common: &Common) -> Result<u8> {
    match command {
        RunsCommand::List(filter) => list(filter, common),
        RunsCommand::Export(arguments) => export(arguments, common),
        RunsCommand::Perform { parts, store } => perform(parts, store, common),
        RunsCommand::Show { key, store } => show(&Store::new(&store.store), key),
        RunsCommand::Prune { all, corrupt, store } => {
            prune(&Store::new(&store.store), *all, *corrupt, common)
        }
    }
}

fn perform(parts: &[PathBuf], store: &StoreArgs, common: &Common) -> Result<u8> {
    let store = store.open()?;
    let mut tasks = Vec::new();
    for part in parts {
        tasks.extend(read_part(part)?);
    }
    let runs = ManyRuns::new(common);
    let notify = |progress: Progress| runs.show(progress);
    let runner = TaskRunner { store: &store, notify: &notify, plan: None };
    match runs.finish(runner.records(&tasks))? {
        Ok(records) => {
            let count = records.len();
            let json = || Ok(format!("{}\n", json!({ "stored": count })));
            common.print_summary(&json, &|| format!("{count} runs are stored\n"))?;
            Ok(0)
        }
        Err(code) => Ok(code),
    }
}

fn list(filter: &FilterArgs, common: &Common) -> Result<u8> {
    let Chosen { records, code } = filter.read(common)?;
    let json = || Ok(serde_json::to_string(&records)? + "\n");
    let (count, store) = (records.len(), filter.store.store.display());
    common.print_result(&json, &|| format!("{}\n{count} records in {store}\n", table(&records)))?;
    Ok(code)
}

fn table(records: &[RunRecord]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table.set_header(["key", "run", "case", "settings", "CPU s", "outcome", "solver"]);
    for record in records {
        let overrides = record.overrides.iter().map(ToString::to_string);
        let settings = overrides.chain(record.settings.iter().map(ToString::to_string));
        let settings: Vec<String> = settings.collect();
        let outcome = match &record.outcome {
            RunOutcome::Done { .. } => "done".to_string(),
            RunOutcome::Failed { reason, .. } => printable(reason).chars().take(60).collect(),
        };
        let this = record.solver == solver_identity();
        table.add_row([
            record.key.chars().take(12).collect(),
            record.job.name().into(),
            printable(&record.case),
            printable(&settings.join(", ")),
            format!("{:.2}", record.cpu_s()),
            outcome,
            if this { "this version" } else { "another" }.into(),
        ]);
    }
    table
}

fn show(store: &Store, key: &str) -> Result<u8> {
    let Contents { mut records, corrupt } = store.contents()?;
    records.retain(|record| record.key.starts_with(key));
    match records.as_slice() {
        [one] => {
            print_json(&(serde_json::to_string_pretty(one)? + "\n"))?;
            Ok(0)
        }
        [] => match corrupt
            .into_iter()
            .find(|corrupt| corrupt.key().is_some_and(|k| k.starts_with(key)))
        {
            Some(corrupt) => Err(corrupt.error.into()),
            None => bail!("{} has no record with the key {key}", store.folder().display()),
        },
        many => bail!("{} keys begin with {key}; give more digits", many.len()),
    }
}

/// Removes records of other versions, or all. A file that was meant to be a record but is
/// none is removed on request, any other file never.
fn prune(store: &Store, all: bool, corrupt_too: bool, common: &Common) -> Result<u8> {
    let Contents { records, corrupt } = store.contents()?;
    let old = records.iter().filter(|record| all || record.solver != solver_identity());
    let mut removed = 0;
    for record in old {
        store.remove(&record.key)?;
        removed += 1;
    }
    let (bad, left): (Vec<Corrupt>, Vec<Corrupt>) = corrupt
        .into_iter()
        .partition(|bad| bad.key().is_some() && (all || corrupt_too || bad.is_old()));
    let leftovers = store.leftovers()?;
    for file in bad.iter().map(|bad| &bad.file).chain(&leftovers) {
        match std::fs::remove_file(file) {
            // Another program was faster.
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            other => other.with_context(|| format!("cannot remove {}", file.display()))?,
        }
    }
    removed += bad.iter().filter(|bad| bad.is_old()).count();
    let corrupt = bad.iter().filter(|bad| !bad.is_old()).count();
    let temporary = leftovers.len();
    let counts = json!({ "records": removed, "corrupt": corrupt, "temporary": temporary });
    common.print_result(&|| Ok(format!("{}\n", json!({ "removed": counts }))), &|| {
        let corrupt = if corrupt > 0 {
            format!(", {corrupt} corrupt records removed")
        } else {
            String::new()
        };
        format!("{removed} records removed, {temporary} temporary files removed{corrupt}\n")
    })?;
    Ok(name_corrupt(&left, common))
}

/// What merging has done.
#[derive(Default)]
struct Merged {
    added: usize,
    known: usize,
    code: u8,
}

pub(crate) fn merge(arguments: &MergeArgs, common: &Common) -> Result<u8> {
    if let Some(folder) = arguments.from.iter().find(|folder| !folder.is_dir()) {
        bail!("there is no store {}", folder.display());
    }
    let into = Store::new(&arguments.into);
    let mut merged = Merged::default();
    for folder in &arguments.from {
        let Contents { records, corrupt } = Store::new(folder).contents()?;
        merged.code = merged.code.max(name_corrupt(&corrupt, common));
        for record in &records {
            merged.add(record, folder, &into, common)?;
        }
    }
    let Merged { added, known, code } = merged;
    common.print_result(
        &|| Ok(format!("{}\n", json!({ "added": added, "known": known }))),
        &|| format!("{added} records added, {known} were there already\n"),
    )?;
    Ok(code)
}

impl Merged {
    fn add(
        &mut self,
        record: &RunRecord,
        from: &Path,
        into: &Store,
        common: &Common,
    ) -> Result<()> {
        match into.find(&record.key) {
            // Runs are deterministic; only their timings may differ.
            Ok(Some(old)) if old.outcome != record.outcome => {
                common.complain(format!(
                    "the record {} differs between {} and {}: the programs that made \
                     them do not give the same results",
                    record.key,
                    from.display(),
                    into.folder().display()
                ));
                self.code = COULD_NOT_RUN;
            }
            Ok(Some(_)) => self.known += 1,
            Ok(None) => {
                into.write(record)?;
                self.added += 1;
            }
            Err(corrupt) => {
                common.complain(corrupt);
                self.code = COULD_NOT_RUN;
            }
        }
        Ok(())
    }
}
