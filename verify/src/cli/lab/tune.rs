//! `mtled tune`.

use super::args::{ErrorArgs, fraction, seconds};
use super::ranges::Ranges;
use crate::cli::common::{Common, command_line};
use crate::cli::load::SetArgs;
use crate::cli::progress::ManyRuns;
use crate::cli::publish::{publish, report_of, tables};
use anyhow::{Result, bail};
use clap::Args;
use mtled_case::bundled::small_cases;
use mtled_case::scene::{Knob, Setting, with_paths_from};
use mtled_checks::escape::file_name;
use mtled_checks::report::{ensure_writable, write_atomically};
use mtled_lab::lab::store::{Source, Store, TaskRunner};
use mtled_lab::lab::tune::{
    Goal, TuneRequest, Tuned, recommend, recommendation_study, tune, tune_study, tune_text,
};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct TuneArgs {
    /// Case files, or names of bundled cases. For several cases one recipe for all of them is
    /// searched for, at equal error.
    #[arg(required_unless_present = "all_cases")]
    cases: Vec<String>,
    /// Find the cheapest recipe with at most this error, such as 1% or 0.01.
    #[arg(long, value_name = "FRACTION", value_parser = fraction, conflicts_with = "budget")]
    target_error: Option<f64>,
    /// Find the most accurate recipe within this CPU time of one run, such as 2s or 500ms.
    #[arg(long, value_name = "TIME", value_parser = seconds)]
    budget: Option<f64>,
    /// CPU time that finer runs of the case may take where the reference cannot decide the goal,
    /// such as 90s or 5min; without it the search ends before it begins, as inconclusive.
    #[arg(long, value_name = "TIME", value_parser = seconds, default_value = "60s")]
    truth_budget: f64,
    /// Search for one recipe for all bundled cases.
    #[arg(long, conflicts_with = "cases")]
    all_cases: bool,
    /// Node clouds per recipe in the last round; its error is the largest over them.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    clouds: u16,
    #[command(flatten)]
    ranges: Ranges,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    error: ErrorArgs,
}

const EXAMPLES: &str = "The case file with the recipe written in, comments kept, is <case>.tuned.toml in the folder of the
report. Exit code 1: no recipe that was tried meets the goal; 3: the reference cannot tell. Ranges that are given replace the
built-in design; spacings are always found by the search.

Examples:
  mtled tune my_case.toml --target-error 1%
  mtled tune my_case.toml --budget 2s --quantity force
  mtled tune bonded_block --target-error 2% --dilation 1.4..2.6:0.2 --cells-per-spacing 1,1.26,1.6";

/// Number of clouds on which a winner is confirmed.
const FRESH: usize = 3;

/// The goal where the user gives none.
const DEFAULT_GOAL: Goal = Goal::Error(0.02);

pub(crate) fn tune_cases(arguments: &TuneArgs, common: &Common) -> Result<u8> {
    let store = arguments.error.store.open()?;
    let names: Vec<String> = if arguments.all_cases {
        small_cases().map(String::from).collect()
    } else {
        arguments.cases.clone()
    };
    let requests = names.iter().map(|name| request(name, arguments, &store));
    let requests = requests.collect::<Result<Vec<_>>>()?;
    match requests.as_slice() {
        [one] => tune_one(one, arguments, &store, common),
        many => tune_many(many, arguments, &store, common),
    }
}

fn request(name: &str, arguments: &TuneArgs, store: &Store) -> Result<TuneRequest> {
    let goal = match (arguments.target_error, arguments.budget) {
        (Some(error), _) => Goal::Error(error),
        (None, Some(cpu_s)) => Goal::Budget(cpu_s),
        (None, None) => DEFAULT_GOAL,
    };
    let axes = arguments.ranges.axes()?;
    for (knob, why) in [
        (Knob::Spacing, "the search finds the spacing itself"),
        (Knob::Load, "the load belongs to the problem, not to the recipe"),
    ] {
        if axes.iter().any(|axis| axis.knob == knob) {
            bail!("{why}; it cannot have a range");
        }
    }
    Ok(TuneRequest {
        source: Source::find(name, store.folder(), &arguments.set.overrides)?,
        goal,
        reference: arguments.error.reference(),
        group: arguments.error.quantity,
        clouds: arguments.clouds.into(),
        fresh: FRESH,
        truth_budget_s: arguments.truth_budget,
        axes,
        command: command_line(),
    })
}

fn tune_one(
    request: &TuneRequest,
    arguments: &TuneArgs,
    store: &Store,
    common: &Common,
) -> Result<u8> {
    let start = Instant::now();
    let runs = ManyRuns::new(common);
    let plan = arguments.error.jobs.plan();
    let runner = TaskRunner { store, notify: &|progress| runs.show(progress), plan: plan.as_ref() };
    let out = arguments.error.out(&["tune", &request.source.name]);
    ensure_writable(&out)?;
    let tuned = match runs.finish(tune(request, runner))? {
        Ok(tuned) => tuned,
        Err(code) => return Ok(code),
    };
    let report = report_of("tune", tune_study(request, &tuned), start);
    let file = write_case(request, &tuned, &out)?;
    let code = publish(&report, &out, common, &|| {
        let case = file.iter().map(|file| format!("case with this recipe: {}\n", file.display()));
        let text = tune_text(request, &tuned);
        format!("{text}\n\n{}{:.0} s", case.collect::<String>(), report.wall_seconds)
    })?;
    Ok(code)
}

/// Writes the case file with the recipe of the winner.
fn write_case(request: &TuneRequest, tuned: &Tuned, out: &Path) -> Result<Option<PathBuf>> {
    let Some(winner) = &tuned.winner else { return Ok(None) };
    let mut settings = vec![Setting::word(Knob::Spacing, &format!("x{:.4}", winner.factor))];
    settings.extend(tuned.candidates[winner.candidate].settings.iter().cloned());
    let base = request.source.file.parent().unwrap_or(Path::new("."));
    let text = with_paths_from(&request.source.text_with(&settings)?, base, out)?;
    let file = out.join(file_name(&format!("{}.tuned.toml", request.source.name)));
    write_atomically(&file, text.as_bytes())?;
    Ok(Some(file))
}

fn tune_many(
    requests: &[TuneRequest],
    arguments: &TuneArgs,
    store: &Store,
    common: &Common,
) -> Result<u8> {
    let start = Instant::now();
    let runs = ManyRuns::new(common);
    let plan = arguments.error.jobs.plan();
    let runner = TaskRunner { store, notify: &|progress| runs.show(progress), plan: plan.as_ref() };
    let out = arguments.error.out(&["tune"]);
    ensure_writable(&out)?;
    let recommendation = match runs.finish(recommend(requests, runner))? {
        Ok(recommendation) => recommendation,
        Err(code) => return Ok(code),
    };
    let study = recommendation_study(&recommendation, &command_line());
    let report = report_of("tune", study, start);
    publish(&report, &out, common, &|| tables(&report))
}
