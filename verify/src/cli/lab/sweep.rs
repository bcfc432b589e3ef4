//! `mtled study consistency|patch|timestep|convergence|stability`.

use super::args::ErrorArgs;
use super::ranges::Ranges;
use crate::cli::common::{Common, command_line};
use crate::cli::load::SetArgs;
use crate::cli::progress::ManyRuns;
use crate::cli::publish::{publish, report_of, tables};
use anyhow::{Context, Result, bail};
use clap::Args;
use mtled_checks::report::ensure_writable;
use mtled_lab::lab::store::{Source, Store, TaskRunner};
use mtled_lab::lab::sweep::{Axis, Plan, Subject, Sweep};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = RANGES)]
pub(crate) struct SweepArgs {
    /// Case files, or names of bundled cases.
    cases: Vec<String>,
    /// A study defined in a TOML file: cases, clouds, [ranges]. Options on the command line
    /// take precedence.
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    #[command(flatten)]
    ranges: Ranges,
    /// Node clouds per combination [default: 1; for convergence 3].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    clouds: Option<u16>,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    error: ErrorArgs,
    /// Run part i of n only, without a report; `mtled merge` combines the stores of all
    /// parts, and the same command without this option writes the report.
    #[arg(long, value_name = "i/n", value_parser = part, help_heading = "Files")]
    shard: Option<(usize, usize)>,
}

const RANGES: &str =
    "A range is a list (1.4,1.8 or linear,quadratic) or first..last:step (1.4..2.6:0.2) with both ends
included; spacings are in metres, or factors of the case's own such as x0.8. Every combination is
run once and stored, so that a study that was stopped or killed continues where it was.

Examples:
  mtled study convergence my_case.toml
  mtled study convergence my_case.toml --spacing x1.5,x1.2,x1,x0.8 --dilation 1.6,2.0 --clouds 5
  mtled study timestep cube_compression --dilation 1.4..2.6:0.2
  mtled study stability my_case.toml --load 0.5..3:0.5";

/// `2/4` as part 2 of 4.
fn part(text: &str) -> Result<(usize, usize), String> {
    let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match numbers {
        Some((i, n)) if 1 <= i && i <= n => Ok((i, n)),
        _ => Err(format!("{text} is not a part such as 2/4")),
    }
}

pub(crate) fn sweep(subject: Subject, arguments: &SweepArgs, common: &Common) -> Result<u8> {
    let start = Instant::now();
    let store = arguments.error.store.open()?;
    let sweep = definition(subject, arguments, &store)?;
    let runs = ManyRuns::new(common);
    let plan = arguments.error.jobs.plan();
    let runner =
        TaskRunner { store: &store, notify: &|progress| runs.show(progress), plan: plan.as_ref() };
    if let Some(part) = arguments.shard {
        return Ok(match runs.finish(sweep.run_part(&runner, part))? {
            Ok(count) => {
                let json = || Ok(format!("{}\n", json!({ "stored": count })));
                common.print_summary(&json, &|| format!("{count} runs are stored\n"))?;
                0
            }
            Err(code) => code,
        });
    }
    let out = arguments.error.out(&[subject.name()]);
    ensure_writable(&out)?;
    let study = match runs.finish(sweep.run(&runner))? {
        Ok(study) => study,
        Err(code) => return Ok(code),
    };
    let report = report_of(subject.name(), study, start);
    publish(&report, &out, common, &|| tables(&report))
}

fn definition(subject: Subject, arguments: &SweepArgs, store: &Store) -> Result<Sweep> {
    let plan = arguments.plan.as_deref().map(Plan::read).transpose()?.unwrap_or_default();
    let names = if arguments.cases.is_empty() { &plan.cases } else { &arguments.cases };
    if names.is_empty() {
        let plan = arguments.plan.as_deref().map(|plan| format!("{}: ", plan.display()));
        bail!(
            "{}no case is named; give a case file, or a name that `mtled case list` prints",
            plan.unwrap_or_default()
        );
    }
    let sources =
        names.iter().map(|name| Source::find(name, store.folder(), &arguments.set.overrides));
    let sources = sources.collect::<Result<Vec<_>>>().context("the case cannot be used")?;
    let mut axes = arguments.ranges.axes()?;
    for axis in plan.axes("plan")? {
        if axes.iter().all(|given| given.knob != axis.knob) {
            axes.push(axis);
        }
    }
    if axes.is_empty() {
        let ranges = subject.default_ranges().iter();
        axes = ranges.map(|(knob, text)| Axis::parse(*knob, text)).collect::<Result<_, _>>()?;
    }
    let clouds = arguments.clouds.map(usize::from).or(plan.clouds);
    Ok(Sweep {
        subject,
        sources,
        axes,
        clouds: clouds.unwrap_or(if subject == Subject::Convergence { 3 } else { 1 }),
        reference: arguments.error.reference(),
        group: arguments.error.quantity,
        command: command_line(),
    })
}
