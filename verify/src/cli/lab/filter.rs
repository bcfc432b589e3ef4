//! Which stored runs a command is about.

use super::args::StoreArgs;
use crate::cli::common::{COULD_NOT_RUN, Common};
use anyhow::Result;
use clap::Args;
use mtled_lab::lab::records::{FilterError, RunFilter, Wanted};
use mtled_lab::lab::store::{Contents, Corrupt, Job, RunRecord, Store};
use std::collections::BTreeSet;

/// A store and which of its records are meant.
#[derive(Debug, Args)]
pub(crate) struct FilterArgs {
    /// Runs of this case only: its name or file. May be repeated.
    #[arg(long, value_name = "CASE", help_heading = "Filters")]
    case: Vec<String>,
    /// Runs of this kind only. May be repeated.
    #[arg(long, value_enum, value_name = "KIND", help_heading = "Filters")]
    run: Vec<Job>,
    /// Runs of this day and later only, such as 2026-01-31.
    #[arg(long, value_name = "DAY", value_parser = RunFilter::day, help_heading = "Filters")]
    since: Option<String>,
    /// Runs with this setting only: dilation=1.8, dilation=1.4..2.2:0.2, basis=linear,quadratic,
    /// spacing=x0.8, or a key as it was given to --set. May be repeated. What a run leaves as it
    /// is in its case is not on record as a setting, but for the spacing.
    #[arg(long = "where", value_name = "SETTING=VALUE", value_parser = setting,
        help_heading = "Filters")]
    settings: Vec<Wanted>,
    #[command(flatten)]
    pub store: StoreArgs,
}

fn setting(text: &str) -> Result<Wanted, FilterError> {
    RunFilter::setting(text)
}

/// The records that are meant, and an exit code that says whether all could be read.
pub(crate) struct Chosen {
    pub records: Vec<RunRecord>,
    pub code: u8,
}

impl FilterArgs {
    /// Reads the records that are meant; files that are none are named.
    pub(crate) fn read(&self, common: &Common) -> Result<Chosen> {
        let filter = RunFilter {
            cases: self.case.iter().map(|case| RunFilter::case_name(case)).collect(),
            jobs: self.run.clone(),
            since: self.since.clone(),
            settings: self.settings.clone(),
        };
        let Contents { mut records, corrupt } = Store::new(&self.store.store).contents()?;
        let code = name_corrupt(&corrupt, common);
        let cases: BTreeSet<String> = records.iter().map(|record| record.case.clone()).collect();
        let count = records.len();
        records.retain(|record| filter.accepts(record));
        if records.is_empty() {
            common.warn(nothing(self.store.store.display(), count, cases));
        }
        Ok(Chosen { records, code })
    }
}

/// Why there is nothing.
fn nothing(store: impl std::fmt::Display, count: usize, cases: BTreeSet<String>) -> String {
    const A_FEW: usize = 10;
    if count == 0 {
        return format!(
            "{store} has no records; studies, `mtled tune` and `mtled budget` make them"
        );
    }
    let names: Vec<String> = cases.iter().take(A_FEW).cloned().collect();
    let more = if cases.len() > A_FEW { ", …" } else { "" };
    format!("none of {count} records in {store} fits; they are of {}{more}", names.join(", "))
}

/// Names the files that are no records; the exit code says whether there are any.
pub(crate) fn name_corrupt(corrupt: &[Corrupt], common: &Common) -> u8 {
    corrupt.iter().for_each(|corrupt| common.complain(&corrupt.error));
    if corrupt.is_empty() { 0 } else { COULD_NOT_RUN }
}
