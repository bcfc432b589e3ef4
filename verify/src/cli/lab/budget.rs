//! `mtled budget`.

use super::args::ErrorArgs;
use crate::cli::common::{Common, command_line};
use crate::cli::load::SetArgs;
use crate::cli::progress::ManyRuns;
use crate::cli::publish::{publish, report_of};
use anyhow::Result;
use clap::Args;
use mtled_checks::report::ensure_writable;
use mtled_lab::lab::budget::{BudgetRequest, budget_study, budget_text, measure_budget};
use mtled_lab::lab::store::{Source, TaskRunner};
use std::time::Instant;

#[derive(Debug, Args)]
pub(crate) struct BudgetArgs {
    /// Case file, or name of a bundled case.
    case: String,
    /// Number of other clouds that show the scatter of the error.
    #[arg(long, default_value_t = 2)]
    clouds: u16,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    error: ErrorArgs,
}

pub(crate) fn budget(arguments: &BudgetArgs, common: &Common) -> Result<u8> {
    let start = Instant::now();
    let store = arguments.error.store.open()?;
    let source = Source::find(&arguments.case, store.folder(), &arguments.set.overrides)?;
    let request = BudgetRequest {
        source: source.clone(),
        reference: arguments.error.reference(),
        group: arguments.error.quantity,
        clouds: arguments.clouds.into(),
    };
    let out = arguments.error.out(&["budget", &source.name]);
    ensure_writable(&out)?;
    let runs = ManyRuns::new(common);
    let plan = arguments.error.jobs.plan();
    let runner =
        TaskRunner { store: &store, notify: &|progress| runs.show(progress), plan: plan.as_ref() };
    let budget = match runs.finish(measure_budget(&request, &runner))? {
        Ok(budget) => budget,
        Err(code) => return Ok(code),
    };
    let report = report_of("budget", budget_study(&budget, &command_line()), start);
    publish(&report, &out, common, &|| budget_text(&budget))
}
