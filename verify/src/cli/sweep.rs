//! `mtled study consistency|patch|timestep|convergence|stability`.

use crate::accuracy::Group;
use crate::cli::progress::ManyRuns;
use crate::cli::{Common, Format, STOPPED, print_data};
use crate::explore::store::{Source, Stopped, Store};
use crate::explore::sweep::{Axis, Plan, Subject, Sweep, TruthWanted};
use crate::machine::provenance;
use crate::scene::Knob;
use anyhow::{Context, Result, bail};
use clap::Args;
use mtled_checks::report::{json, markdown_tables, write_report};
use mtled_checks::study::Report;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Where records are kept where nobody says.
pub const STORE: &str = "reports/runs";

#[derive(Debug, Args)]
#[command(after_help = RANGES)]
pub struct SweepArgs {
    /// Case files, or names of carried cases.
    cases: Vec<String>,
    /// A study stated in a TOML file: cases, clouds, [ranges]. What stands on the
    /// command line goes before it.
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    #[command(flatten)]
    ranges: Ranges,
    /// Clouds per combination [default: 1; of convergence 3].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    clouds: Option<u16>,
    /// What is judged [default: the first that the case has].
    #[arg(long, value_enum)]
    quantity: Option<Group>,
    /// Where the truth comes from: "any" (a carried reference of the problem, else own
    /// finer runs), "own", or a reference file.
    #[arg(long, default_value = "any", value_name = "any|own|FILE")]
    truth: String,
    /// Folder of the records; what is there is not run again.
    #[arg(long, default_value = STORE, value_name = "DIR", help_heading = "Files")]
    store: PathBuf,
    /// Folder for index.html, results.json and figures
    /// [default: reports/<study>].
    #[arg(long, value_name = "DIR", help_heading = "Files")]
    out: Option<PathBuf>,
    /// Run part i of n only and report nothing; `mtled merge` brings the stores
    /// of all parts together, and the same command without this reports.
    #[arg(long, value_name = "i/n", value_parser = part, help_heading = "Files")]
    shard: Option<(usize, usize)>,
}

const RANGES: &str =
    "A range is a list (1.4,1.8 or linear,quadratic) or first..last:step (1.4..2.6:0.2), both ends
included; spacings are in metres, or factors of the case's own such as x0.8. Every combination is
run once and kept on record: a study that was stopped or killed goes on where it was.

Examples:
  mtled study convergence my_case.toml
  mtled study convergence my_case.toml --spacing x1.5,x1.2,x1,x0.8 --dilation 1.6,2.0 --clouds 5
  mtled study timestep cube_compression --dilation 1.4..2.6:0.2
  mtled study stability my_case.toml --load 0.5..3:0.5";

/// One option per knob.
#[derive(Debug, Args)]
#[command(next_help_heading = "Ranges")]
pub struct Ranges {
    /// Node spacings [m], or factors such as x0.8.
    #[arg(long, value_name = "RANGE")]
    spacing: Option<String>,
    /// Influence radius over node spacing [–].
    #[arg(long, value_name = "RANGE")]
    dilation: Option<String>,
    /// Cells along a node spacing [–].
    #[arg(long, value_name = "RANGE")]
    cells_per_spacing: Option<String>,
    /// Gauss points per cell and direction.
    #[arg(long, value_name = "RANGE")]
    gauss_points: Option<String>,
    /// linear, quadratic, modified_quadratic.
    #[arg(long, value_name = "LIST")]
    basis: Option<String>,
    /// quartic_spline, cubic_spline, exponential.
    #[arg(long, value_name = "LIST")]
    weight_function: Option<String>,
    /// row_sum, even_split.
    #[arg(long, value_name = "LIST")]
    mass: Option<String>,
    /// collocation, direct.
    #[arg(long, value_name = "LIST")]
    enforcement: Option<String>,
    /// consistent, plain.
    #[arg(long, value_name = "LIST")]
    gradients: Option<String>,
    /// Of consistent gradients, over the defect of plain ones [–].
    #[arg(long, value_name = "RANGE")]
    gradient_tolerance: Option<String>,
    /// projected, pointwise.
    #[arg(long, value_name = "LIST")]
    volumetric_projection: Option<String>,
    /// Largest random move of nodes over their spacing [–].
    #[arg(long, value_name = "RANGE")]
    jitter: Option<String>,
    /// Step over the critical one [–].
    #[arg(long, value_name = "RANGE")]
    safety_factor: Option<String>,
    /// relaxation, newton: how a static solution is found.
    #[arg(long, value_name = "LIST")]
    solver: Option<String>,
    /// Of a static solution [–].
    #[arg(long, value_name = "RANGE")]
    tolerance: Option<String>,
    /// Everything that moves the body, over what the case says [–].
    #[arg(long, value_name = "RANGE")]
    load: Option<String>,
}

impl Ranges {
    /// The axes that were given.
    pub fn axes(&self) -> Result<Vec<Axis>> {
        let given = [
            (Knob::Spacing, &self.spacing),
            (Knob::Dilation, &self.dilation),
            (Knob::CellsPerSpacing, &self.cells_per_spacing),
            (Knob::GaussPoints, &self.gauss_points),
            (Knob::Basis, &self.basis),
            (Knob::WeightFunction, &self.weight_function),
            (Knob::Mass, &self.mass),
            (Knob::Enforcement, &self.enforcement),
            (Knob::Gradients, &self.gradients),
            (Knob::GradientTolerance, &self.gradient_tolerance),
            (Knob::VolumetricProjection, &self.volumetric_projection),
            (Knob::Jitter, &self.jitter),
            (Knob::SafetyFactor, &self.safety_factor),
            (Knob::Solver, &self.solver),
            (Knob::Tolerance, &self.tolerance),
            (Knob::Load, &self.load),
        ];
        let named = given.iter().filter_map(|(knob, text)| Some((*knob, text.as_deref()?)));
        Ok(named.map(|(knob, text)| Axis::parse(knob, text)).collect::<Result<_, _>>()?)
    }
}

/// `2/4` as part 2 of 4.
fn part(text: &str) -> Result<(usize, usize), String> {
    let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match numbers {
        Some((i, n)) if 1 <= i && i <= n => Ok((i, n)),
        _ => Err(format!("{text} is no part such as 2/4")),
    }
}

/// The truth that is asked for by a word or a file.
pub fn truth(word: &str) -> TruthWanted {
    match word {
        "any" => TruthWanted::Any,
        "own" => TruthWanted::Own,
        file => TruthWanted::File(PathBuf::from(file)),
    }
}

pub fn sweep(subject: Subject, arguments: &SweepArgs, common: &Common) -> Result<u8> {
    let start = Instant::now();
    let store = Store::new(&arguments.store);
    let sweep = pose(subject, arguments, &store)?;
    let runs = ManyRuns::new(common);
    if let Some((part, parts)) = arguments.shard {
        let done = sweep.run_part(&store, (part, parts), &|progress| runs.show(progress));
        return finish_part(done, &runs, common);
    }
    let study = match sweep.run(&store, &|progress| runs.show(progress)) {
        Ok(study) => study,
        Err(error) => return runs.give_up(error),
    };
    runs.finish();
    let out =
        arguments.out.clone().unwrap_or_else(|| PathBuf::from("reports").join(subject.name()));
    let report = Report {
        schema_version: json::SCHEMA_VERSION,
        suite: subject.name().into(),
        provenance: provenance(),
        studies: vec![study],
        wall_seconds: start.elapsed().as_secs_f64(),
        comparison: None,
    };
    publish(&report, &out, common)
}

/// Writes the report of one study and shows its tables.
pub fn publish(report: &Report, out: &Path, common: &Common) -> Result<u8> {
    write_report(report, out)?;
    match common.format {
        Format::Json => print_data(&json::to_json(report))?,
        Format::Human if !common.quiet => {
            let tables = markdown_tables(&report.studies[0], &report.provenance);
            let page = out.join("index.html");
            print_data(&format!("{tables}\nreport: {}\n", page.display()))?;
        }
        Format::Human => {}
    }
    Ok(if report.passed() { 0 } else { 1 })
}

fn finish_part(done: Result<usize>, runs: &ManyRuns, common: &Common) -> Result<u8> {
    match done {
        Ok(count) => {
            runs.finish();
            if !common.quiet {
                eprintln!("{count} runs are on record");
            }
            Ok(0)
        }
        Err(error) => runs.give_up(error),
    }
}

fn pose(subject: Subject, arguments: &SweepArgs, store: &Store) -> Result<Sweep> {
    let plan = arguments.plan.as_deref().map(Plan::read).transpose()?.unwrap_or_default();
    let names = if arguments.cases.is_empty() { &plan.cases } else { &arguments.cases };
    if names.is_empty() {
        bail!("no case is named; give a case file, or a name of `mtled case list`");
    }
    let sources = names.iter().map(|name| Source::find(name, store.folder()));
    let sources = sources.collect::<Result<Vec<_>>>().context("the case cannot be used")?;
    let mut axes = arguments.ranges.axes()?;
    for axis in plan.axes("plan")? {
        if axes.iter().all(|given| given.knob != axis.knob) {
            axes.push(axis);
        }
    }
    if axes.is_empty() {
        let preset = subject.preset().iter().map(|(knob, text)| Axis::parse(*knob, text));
        axes = preset.collect::<Result<_, _>>()?;
    }
    let clouds = arguments.clouds.map(usize::from).or(plan.clouds);
    Ok(Sweep {
        subject,
        sources,
        axes,
        clouds: clouds.unwrap_or(if subject == Subject::Convergence { 3 } else { 1 }),
        truth: truth(&arguments.truth),
        group: arguments.quantity,
        command: command_line(),
    })
}

/// The command as it was typed.
pub fn command_line() -> String {
    let words = std::env::args().skip(1).map(|word| match word.contains(' ') {
        true => format!("\"{word}\""),
        false => word,
    });
    format!("mtled {}", words.collect::<Vec<_>>().join(" "))
}

/// The exit code of a study that was stopped, or the error.
pub fn stopped(error: anyhow::Error) -> Result<u8> {
    match error.downcast_ref::<Stopped>() {
        Some(stopped) => {
            eprintln!("{stopped}");
            Ok(STOPPED)
        }
        None => Err(error),
    }
}
