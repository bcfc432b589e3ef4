//! Judged results as a study.

use super::judged::{CaseRuns, Judged, Spent};
use super::programs::programs;
use super::run_tables::{orders_of, runs_of};
use super::tables::{endings, equal_errors, finest, losses, robustness, wins};
use mtled_checks::escape::{file_name, printable};
use mtled_checks::study::{
    Bound, Check, Figure, Kind, Panels, Plot, Series, SeriesStyle, Study, axis, curve, styled,
};

const TIMING: &str = "Every run is a process of its own, with one thread asked for. CPU \
    time and peak memory are those that the system counts for the process and the children that it has \
    waited for, from its start to its end: the start of an interpreter, imports, compilation of kernels and \
    writing the answer are included; the shortest run of a program is an upper bound of its start. The \
    programs run in turn, once each. \"≤\" marks a peak memory that the system cannot tell from that of \
    the program that measures.";

const ERRORS: &str = "Errors are root mean square differences from the reference over the largest value \
    of its kind. Differences that are not larger than the error bar of the reference are inconclusive: \
    they are in no fitted order and below no level of cost. References come from FEniCSx and scikit-fem on \
    meshes of their own, graded and halved by symmetry; where adapters of these codes solve on the same \
    meshes, their errors are not independent of the reference, and that of the finest mesh can be 0.";

const COSTS: &str = "CPU times at equal error are interpolated logarithmically between two neighbouring \
    resolutions; \"<\" marks an upper bound, since the coarsest run is more accurate already, and of \
    ratios \">\" a lower one and brackets that both times are upper bounds. Nothing is extrapolated. \
    Programs whose answers on a case are doubtful have no cost there.";

const APART: &str = "CPU times of solutions are those of the process without what a program itself tells \
    apart, since a longer program would take it once: the start of an interpreter and its imports, the \
    generation of kernels, attempts with larger parts of the load that failed, sampling and writing the answer. \
    mtled tells nothing apart.";

/// The study with its tables, figures, checks and notes.
pub fn study(all: &Judged, command: String) -> Study {
    let mut study = Study {
        id: "solvers".into(),
        title: "Solvers beside each other".into(),
        claim: "Programs that speak the solver protocol, on the same problems at the same resolutions: \
                errors against stored references, measured CPU time and memory, and how many runs ended \
                with an answer."
            .into(),
        command,
        ..Study::default()
    };
    study.tables.extend(programs(all));
    study.tables.extend([robustness(all), wins(all), equal_errors(all, Spent::Process)]);
    if all.spent() == Spent::Solution {
        study.tables.push(equal_errors(all, Spent::Solution));
    }
    study.tables.extend(losses(all));
    study.tables.push(finest(all));
    for (n, solver) in all.solvers.iter().enumerate() {
        study.tables.push(orders_of(&solver.name, &all.cases, n));
        study.tables.push(runs_of(&solver.name, &all.cases, n));
        study.checks.push(check(all, n));
    }
    study.figures.push(overview(all));
    study.leading = 1;
    study.notes = notes(all);
    study
}

/// Programs keep to the protocol; refusals and time limits are no faults.
fn check(all: &Judged, solver: usize) -> Check {
    let name = printable(&all.solvers[solver].name);
    let counts = endings(&all.cases, solver);
    Check::new(
        &format!("solvers/{}", file_name(&name)),
        &format!("{name}: faulty runs, and problems with doubtful answers"),
        Kind::Exact,
        (counts.faulty + counts.doubtful) as f64,
        Bound::AtMost(0.0),
        "1",
        "the solver protocol (reference/adapters/README.md)",
    )
}

/// Error over CPU time, a panel per problem.
pub(crate) fn overview(all: &Judged) -> Figure {
    let names: Vec<String> = all.solvers.iter().map(|solver| printable(&solver.name)).collect();
    let panels = all.cases.iter().map(|case| {
        let plot = plot(&names, case, all.spent(), SeriesStyle::Floor);
        Figure::Plot(Plot { title: case.of.id.clone(), ..plot })
    });
    Figure::Panels(Panels {
        title: "Error over CPU time".into(),
        caption: format!(
            "rms error over the {}, one thread, from coarse to fine; lower left is better. Below the error \
             bar of the reference nothing is decided.",
            all.spent().label()
        ),
        panels: panels.collect(),
    })
}

/// Error over CPU time, a curve per program; the error bar of the reference as a line or a floor.
pub(crate) fn plot(
    names: &[String],
    case: &CaseRuns,
    spent: Spent,
    bar_style: SeriesStyle,
) -> Plot {
    let mut series: Vec<Series> = Vec::new();
    let mut range = (f64::INFINITY, 0.0f64);
    for (n, name) in names.iter().enumerate() {
        let points = spent.points(&case.costs[n]);
        range = points.iter().fold(range, |(low, high), p| (low.min(p.0), high.max(p.0)));
        let colour = Some(n);
        series.push(Series { colour, ..curve(name, points) });
    }
    let bar = Some(case.of.bar()).filter(|bar| *bar > 0.0 && range.1 > 0.0);
    if let Some(bar) = bar {
        let points = vec![(range.0, bar), (range.1, bar)];
        let name = match bar_style {
            SeriesStyle::Floor => "below the reference's error bar",
            _ => "error bar of the reference",
        };
        series.push(Series { colour: Some(names.len()), ..styled(name, points, bar_style) });
    }
    Plot {
        title: format!("{}: error of the {}", case.of.id, case.of.group.label()),
        caption: format!("rms error over the {}; lower left is better.", spent.label()),
        x: axis("CPU time", "s", true),
        y: axis("rms error over the largest value", "1", true),
        series,
        slopes: Vec::new(),
    }
}

/// How it was measured, on which machines, and how each program was started.
pub(crate) fn notes(all: &Judged) -> Vec<String> {
    let machines = all
        .machines
        .iter()
        .map(|machine| format!("{}, {}, {}", machine.processor, machine.system, machine.date));
    let limits: Vec<String> = all.time_limits_s.iter().map(f64::to_string).collect();
    let mut notes = vec![
        printable(&format!(
            "Run on: {}. Time limit of a run: {} s.",
            machines.collect::<Vec<_>>().join("; "),
            limits.join(", ")
        )),
        TIMING.to_string(),
        ERRORS.to_string(),
        COSTS.to_string(),
    ];
    if all.spent() == Spent::Solution {
        notes.push(APART.to_string());
    }
    notes.extend((0..all.solvers.len()).map(|n| about_solver(all, n)));
    notes
}

/// Command and method of a program.
pub(crate) fn about_solver(all: &Judged, n: usize) -> String {
    let solver = &all.solvers[n];
    let answers = all.cases.iter().flat_map(|case| &case.runs[n]);
    let mut methods: Vec<&str> =
        answers.filter_map(|run| run.outcome.answered()?.method.as_deref()).collect();
    methods.sort_unstable();
    methods.dedup();
    let methods = match methods.len() {
        0 => "no method is stated".to_string(),
        1..=8 => methods.join("; "),
        more => format!("{}; and {} more", methods[..8].join("; "), more - 8),
    };
    let commands = solver.commands.join("; ");
    printable(&format!("{}: {commands}. Method, in its own words: {methods}.", solver.name))
}
