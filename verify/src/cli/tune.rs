//! `mtled tune`.

use crate::accuracy::Group;
use crate::bundled::CASES;
use crate::cli::progress::ManyRuns;
use crate::cli::sweep::{Ranges, STORE, command_line, publish, truth};
use crate::cli::{Common, Format, print_data};
use crate::explore::store::{Source, Store};
use crate::explore::tune::{
    Goal, Tuned, Wanted, recommend, recommendation_study, tune, tune_study, tune_text,
};
use crate::machine::provenance;
use crate::scene::{Knob, Setting, movable};
use anyhow::Result;
use clap::Args;
use mtled_checks::report::{json, write_atomically, write_report};
use mtled_checks::study::{Report, Study};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct TuneArgs {
    /// Case files, or names of carried cases. Several: one recipe for all of them is
    /// looked for, at equal error.
    #[arg(required_unless_present = "all_cases")]
    cases: Vec<String>,
    /// The cheapest recipe with at most this error, such as 1% or 0.01.
    #[arg(long, value_name = "SHARE", value_parser = share, conflicts_with = "budget")]
    target_error: Option<f64>,
    /// The best recipe within this CPU time of one run, such as 2s or 500ms.
    #[arg(long, value_name = "TIME", value_parser = seconds)]
    budget: Option<f64>,
    /// One recipe for all carried cases.
    #[arg(long, conflicts_with = "cases")]
    all_cases: bool,
    /// Where the truth comes from: "any" (a carried reference of the problem, else own
    /// finer runs), "own", or a reference file.
    #[arg(long, default_value = "any", value_name = "any|own|FILE")]
    truth: String,
    /// What is judged [default: the first that the case has].
    #[arg(long, value_enum)]
    quantity: Option<Group>,
    /// Clouds of a recipe in the last round; its error is the largest over them.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..))]
    clouds: u16,
    #[command(flatten)]
    ranges: Ranges,
    /// Folder of the records; what is there is not run again.
    #[arg(long, default_value = STORE, value_name = "DIR", help_heading = "Files")]
    store: PathBuf,
    /// Folder for index.html, results.json, figures and the tuned case file
    /// [default: reports/tune/<case>].
    #[arg(long, value_name = "DIR", help_heading = "Files")]
    out: Option<PathBuf>,
}

const EXAMPLES: &str = "The case file with the recipe written in, comments kept, is <case>.tuned.toml in the folder of the
report. Exit code 1: no recipe that was tried meets the goal. Ranges that are given replace the
built-in design; spacings are always found by the search.

Examples:
  mtled tune my_case.toml --target-error 1%
  mtled tune my_case.toml --budget 2s --quantity force
  mtled tune bonded_block --target-error 2% --dilation 1.4..2.6:0.2 --cells-per-spacing 1,1.26,1.6";

/// Clouds on which a winner is confirmed.
const FRESH: usize = 3;

/// `1%` or `0.01`.
fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    let share = number.trim().parse::<f64>().map(|number| number * unit);
    let wrong = || format!("{text} is no share such as 1% or 0.01");
    share.ok().filter(|share| *share > 0.0 && *share < 1.0).ok_or_else(wrong)
}

/// `2s`, `500ms` or `2`.
fn seconds(text: &str) -> Result<f64, String> {
    let (number, unit) = match (text.strip_suffix("ms"), text.strip_suffix('s')) {
        (Some(number), _) => (number, 1e-3),
        (None, Some(number)) => (number, 1.0),
        (None, None) => (text, 1.0),
    };
    let time = number.trim().parse::<f64>().map(|number| number * unit);
    let wrong = || format!("{text} is no time such as 2s or 500ms");
    time.ok().filter(|time| *time > 0.0 && time.is_finite()).ok_or_else(wrong)
}

/// Wanted where nobody says.
const PRESET: Goal = Goal::Error(0.02);

pub fn tune_cases(arguments: &TuneArgs, common: &Common) -> Result<u8> {
    let store = Store::new(&arguments.store);
    let names: Vec<String> = match arguments.all_cases {
        true => CASES.iter().map(|(name, _)| name.to_string()).collect(),
        false => arguments.cases.clone(),
    };
    let goal = match (arguments.target_error, arguments.budget) {
        (Some(error), _) => Goal::Error(error),
        (None, Some(cpu_s)) => Goal::Budget(cpu_s),
        (None, None) => PRESET,
    };
    let axes = arguments.ranges.axes()?;
    for (knob, why) in [
        (Knob::Spacing, "the spacing is what the search finds"),
        (Knob::Load, "the load belongs to the problem, not to the recipe"),
    ] {
        if axes.iter().any(|axis| axis.knob == knob) {
            anyhow::bail!("{why}; name no range of it");
        }
    }
    let wanted = |name: &String| -> Result<Wanted> {
        Ok(Wanted {
            source: Source::find(name, store.folder())?,
            goal,
            truth: truth(&arguments.truth),
            group: arguments.quantity,
            clouds: arguments.clouds.into(),
            fresh: FRESH,
            axes: axes.clone(),
            command: command_line(),
        })
    };
    let wanted = names.iter().map(wanted).collect::<Result<Vec<_>>>()?;
    match wanted.as_slice() {
        [one] => tune_one(one, arguments, &store, common),
        many => tune_many(many, arguments, &store, common),
    }
}

fn tune_one(wanted: &Wanted, arguments: &TuneArgs, store: &Store, common: &Common) -> Result<u8> {
    let start = Instant::now();
    let runs = ManyRuns::new(common);
    let tuned = match tune(wanted, store, &|progress| runs.show(progress)) {
        Ok(tuned) => tuned,
        Err(error) => return runs.give_up(error),
    };
    runs.finish();
    let preset = || PathBuf::from("reports").join("tune").join(&wanted.source.name);
    let out = arguments.out.clone().unwrap_or_else(preset);
    let report = report(tune_study(wanted, &tuned), start);
    write_report(&report, &out)?;
    let file = write_case(wanted, &tuned, &out)?;
    match common.format {
        Format::Json => print_data(&json::to_json(&report))?,
        Format::Human if !common.quiet => {
            let text = tune_text(wanted, &tuned);
            let case =
                file.map_or(String::new(), |file| format!("case with it: {}\n", file.display()));
            let page = out.join("index.html");
            print_data(&format!(
                "{text}\n\n{case}report: {}\n{:.0} s\n",
                page.display(),
                report.wall_seconds
            ))?;
        }
        Format::Human => {}
    }
    Ok(if tuned.winner.is_some() { 0 } else { 1 })
}

/// The case file with the recipe written in.
fn write_case(wanted: &Wanted, tuned: &Tuned, out: &Path) -> Result<Option<PathBuf>> {
    let Some(winner) = &tuned.winner else { return Ok(None) };
    let mut settings = vec![Setting::word(Knob::Spacing, &format!("x{:.4}", winner.factor))];
    settings.extend(tuned.candidates[winner.candidate].settings.iter().cloned());
    let base = wanted.source.file.parent().unwrap_or(Path::new("."));
    let text = movable(&wanted.source.text_with(&settings)?, base)?;
    let file = out.join(format!("{}.tuned.toml", wanted.source.name));
    write_atomically(&file, text.as_bytes())?;
    Ok(Some(file))
}

fn tune_many(
    wanted: &[Wanted],
    arguments: &TuneArgs,
    store: &Store,
    common: &Common,
) -> Result<u8> {
    let start = Instant::now();
    let runs = ManyRuns::new(common);
    let found = match recommend(wanted, store, &|progress| runs.show(progress)) {
        Ok(found) => found,
        Err(error) => return runs.give_up(error),
    };
    runs.finish();
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from("reports/tune"));
    publish(&report(recommendation_study(&found, &command_line()), start), &out, common)
}

fn report(study: Study, start: Instant) -> Report {
    let wall_seconds = start.elapsed().as_secs_f64();
    Report {
        schema_version: json::SCHEMA_VERSION,
        suite: "tune".into(),
        provenance: provenance(),
        studies: vec![Study { wall_seconds, ..study }],
        wall_seconds,
        comparison: None,
    }
}
