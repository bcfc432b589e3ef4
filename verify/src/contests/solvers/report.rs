//! The contest as a study.

use super::contest::{CaseRuns, Contest};
use super::tables::{bar_of, endings, equal_errors, finest, orders_of, robustness, runs_of};
use crate::machine::{load_average, peak_memory, provenance};
use mtled_checks::escape::{file_name, printable};
use mtled_checks::report::four_digits;
use mtled_checks::study::{
    Bound, Check, Figure, Kind, Panels, Plot, Series, SeriesStyle, Study, axis, curve, styled,
};

const TIMING: &str = "Every run is a process of its own, with one thread asked for. CPU \
    time and peak memory are those that the system counts for the process and the children that it has \
    waited for, from its start to its end: the start of an interpreter, imports, compilation of kernels and \
    writing the answer are included; the shortest run of a program is an upper bound of its start. The \
    programs run in turn, once each.";

const ERRORS: &str = "Errors are root mean square differences from the reference over the largest value \
    of its kind. Differences that are not larger than the error bar of the reference are inconclusive: \
    they are in no fitted order and below no level of cost. References come from FEniCSx and scikit-fem on \
    meshes of their own, graded and halved by symmetry; where adapters of these codes solve on the same \
    meshes, their errors are not independent of the reference, and that of the finest mesh can be 0.";

const COSTS: &str = "CPU times at equal error are interpolated logarithmically between two neighbouring \
    resolutions; \"<\" marks an upper bound, since the coarsest run is more accurate already. Nothing is \
    extrapolated. Programs whose answers on a case are doubtful have no cost there.";

/// The study with its tables, figures, checks and notes.
pub fn study(contest: &Contest, all: &[CaseRuns], load_before: Option<f64>) -> Study {
    let mut study = Study {
        id: "solvers".into(),
        title: "Solvers beside each other".into(),
        claim: "Programs that speak the solver protocol, on the same cases at the same resolutions: \
                errors against stored references, measured CPU time and memory, and how many runs ended \
                with an answer."
            .into(),
        command: contest.command.clone(),
        ..Study::default()
    };
    study.tables.push(robustness(contest, all));
    study.tables.push(equal_errors(contest, all));
    study.tables.push(finest(contest, all));
    for n in 0..contest.entrants.len() {
        study.tables.push(orders_of(contest, all, n));
        study.tables.push(runs_of(contest, all, n));
        study.checks.push(check(contest, all, n));
    }
    study.figures.push(overview(contest, all));
    let plots = all.iter().map(|case| plot(contest, case, SeriesStyle::Line));
    let drawn = plots.filter(|plot| plot.series.iter().any(|series| !series.points.is_empty()));
    study.figures.extend(drawn.map(Figure::Plot));
    study.leading = 1;
    study.notes = notes(contest, all, load_before);
    study
}

/// Programs keep to the protocol; refusals and time limits are no faults.
fn check(contest: &Contest, all: &[CaseRuns], entrant: usize) -> Check {
    let name = printable(&contest.entrants[entrant].name);
    let counts = endings(all, entrant);
    Check::new(
        &format!("solvers/{}", file_name(&name)),
        &format!("{name}: faulty runs, and cases with doubtful answers"),
        Kind::Exact,
        (counts.faulty + counts.doubtful) as f64,
        Bound::AtMost(0.0),
        "1",
        "the solver protocol (reference/adapters/README.md)",
    )
}

fn overview(contest: &Contest, all: &[CaseRuns]) -> Figure {
    let panels = all.iter().map(|case| {
        let plot = plot(contest, case, SeriesStyle::Floor);
        Figure::Plot(Plot { title: case.of.source.name.clone(), ..plot })
    });
    Figure::Panels(Panels {
        title: "Error over CPU time".into(),
        caption:
            "rms error over the CPU time of the whole process, one thread, from coarse to fine; \
                  lower left is better. Below the error bar of the reference nothing is decided."
                .into(),
        panels: panels.collect(),
    })
}

/// Error over CPU time, a curve per program; the error bar of the reference as a line or a floor.
fn plot(contest: &Contest, case: &CaseRuns, bar_style: SeriesStyle) -> Plot {
    let mut series: Vec<Series> = Vec::new();
    let mut range = (f64::INFINITY, 0.0f64);
    for (n, entrant) in contest.entrants.iter().enumerate() {
        let points = case.costs(n);
        range = points.iter().fold(range, |(low, high), p| (low.min(p.0), high.max(p.0)));
        let colour = Some(n);
        series.push(Series { colour, ..curve(&printable(&entrant.name), points) });
    }
    let bar = bar_of(case).filter(|bar| *bar > 0.0 && range.1 > 0.0);
    if let Some(bar) = bar {
        let points = vec![(range.0, bar), (range.1, bar)];
        let name = match bar_style {
            SeriesStyle::Floor => "below the reference's error bar",
            _ => "error bar of the reference",
        };
        let bar = styled(name, points, bar_style);
        series.push(Series { colour: Some(contest.entrants.len()), ..bar });
    }
    Plot {
        title: format!("{}: error of the {}", case.of.source.name, case.of.group.label()),
        caption: "rms error over the CPU time of the whole process; lower left is better.".into(),
        x: axis("CPU time", "s", true),
        y: axis("rms error over the largest value", "1", true),
        series,
        slopes: Vec::new(),
    }
}

fn notes(contest: &Contest, all: &[CaseRuns], load_before: Option<f64>) -> Vec<String> {
    let provenance = provenance();
    let load = |load: Option<f64>| load.map_or("not known".into(), |load| format!("{load:.1}"));
    let mut notes = vec![
        format!(
            "{}, {}; load average {} at the start and {} at the end. Time limit of a run: {} s.",
            provenance.processor,
            provenance.date,
            load(load_before),
            load(load_average()),
            contest.time_limit_s
        ),
        TIMING.to_string(),
        ERRORS.to_string(),
        COSTS.to_string(),
    ];
    if let Some(bytes) = peak_memory() {
        notes.push(format!(
            "The system counts the memory of this program, {} MB at its peak, to a process until it \
             has loaded its own: smaller peaks are not seen, which \"≤\" marks.",
            four_digits(bytes as f64 / 1e6)
        ));
    }
    for (n, entrant) in contest.entrants.iter().enumerate() {
        let answers = || all.iter().flat_map(|case| &case.runs[n]);
        let mut methods: Vec<&str> =
            answers().filter_map(|run| run.outcome.answered()?.method.as_deref()).collect();
        methods.sort_unstable();
        methods.dedup();
        let methods = match methods.len() {
            0 => "no method is stated".to_string(),
            1..=8 => methods.join("; "),
            more => format!("{}; and {} more", methods[..8].join("; "), more - 8),
        };
        notes.push(printable(&format!(
            "{}: {}. Method, in its own words: {methods}.",
            entrant.name, entrant.shown
        )));
    }
    notes
}
