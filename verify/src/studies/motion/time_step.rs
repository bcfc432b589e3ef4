//! The critical time step against the largest stable one of real runs.

use crate::run::prepare;
use crate::specimens::stable_step::{
    BISECTION, GROWTH, TRIAL_STEPS, largest_stable_step, trial_velocity,
};
use crate::studies::motion::specimens::{Specimen, specimens};
use crate::studies::motion::time_step_clouds::random_clouds;
use crate::studies::motion::time_step_runs::runs;
use crate::studies::workbench::Workbench;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::internal_force::Workspace;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;

use mtled_checks::study::shorthand::{axis, number, styled, text};
use mtled_checks::study::{Bound, Cell, Check, Figure, Kind, Plot, SeriesStyle, Study, Table};

/// By how much Lanczos may overrate the step, in one of a hundred cases at most \[–\].
const OUT_OF_SIGHT: f64 = 0.03;

/// Steps \[s\] of one specimen.
#[derive(Debug, Clone, Copy)]
struct Limits {
    nodes: usize,
    points: usize,
    bound: f64,
    lanczos: f64,
    bisected: f64,
    products: usize,
    /// By Lanczos from the stiffest mode at rest, as runs do it \[s\].
    followed: Option<f64>,
}

pub fn time_step(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let specimens = specimens(bench)?;
    let mut rows = Vec::new();
    let (mut lanczos, mut bound) = (Vec::new(), Vec::new());
    for (index, specimen) in specimens.iter().enumerate() {
        let limits = measure(specimen)
            .map_err(|error| error.context(format!("specimen \"{}\"", specimen.id)))?;
        add_checks(study, specimen, &limits);
        rows.push(row(specimen, &limits));
        lanczos.push((index as f64 + 1.0, limits.lanczos / limits.bisected));
        bound.push((index as f64 + 1.0, limits.bound / limits.bisected));
    }
    study.tables.push(Table {
        title: "Critical steps by bound, by Lanczos and by bisection".into(),
        columns: vec![
            text("specimen"),
            number("nodes", "1"),
            number("points", "1"),
            number("largest stable step", "s"),
            number("Lanczos", "s"),
            number("Lanczos over stable", "1"),
            number("bound over stable", "1"),
            number("products", "1"),
        ],
        rows,
    });
    study.figures.push(Figure::Plot(Plot {
        title: "Estimates over the largest stable step".into(),
        caption: "Specimens in the order of the table. Above 1 a run diverges.".into(),
        x: axis("specimen", "1", false),
        y: axis("estimate over stable step", "1", false),
        series: vec![
            styled("Lanczos", lanczos, SeriesStyle::Points),
            styled("per-point bound", bound, SeriesStyle::Points),
        ],
        slopes: Vec::new(),
    }));
    study.notes.push(format!(
        "The largest stable step is found by bisection to a relative width of {BISECTION} on undamped runs of \
         {TRIAL_STEPS} steps from a random velocity too small to deform the body; a run is unstable \
         if its kinetic energy grows by {GROWTH:e}. The per-point bound belongs to the body at \
         rest; for the compressed block it is listed only."
    ));
    random_clouds(bench, study)?;
    runs(bench, study)
}

fn measure(specimen: &Specimen) -> anyhow::Result<Limits> {
    let prepared = prepare(&specimen.problem)?;
    let model = &prepared.model;
    let mut state = State::new(model);
    let mut workspace = Workspace::new(model);
    let rest = critical_time_step(model, &state.displacement, 0.0, None, &mut workspace);
    if specimen.deformed {
        simulate(model, &specimen.problem.motion, &mut state, &mut Unobserved)?;
    }
    let (u, t) = (&state.displacement, state.time);
    let critical = critical_time_step(model, u, t, None, &mut workspace);
    let followed = || critical_time_step(model, u, t, Some(&rest), &mut workspace).time_step;
    let followed = specimen.deformed.then(followed);
    let velocity = trial_velocity(model, &prepared.discretisation.cloud.spacing);
    Ok(Limits {
        nodes: model.positions.len(),
        points: model.point_positions.len(),
        bound: model.bound,
        lanczos: critical.time_step,
        bisected: largest_stable_step(model, u, t, &velocity, critical.time_step),
        products: critical.products,
        followed,
    })
}

fn add_checks(study: &mut Study, specimen: &Specimen, limits: &Limits) {
    let id = format!("time_step/{}/lanczos", specimen.id);
    let words = format!("step by Lanczos over the largest stable one: {}", specimen.words);
    let source = "2/√λ_max is the stability limit of central differences, and the Ritz value plus \
                  its residual is on the safe side unless a mode stays out of sight: 20 products \
                  miss more than 6 % of λ_max, 3 % of the step, with a probability below 1 % \
                  (Kuczyński, Woźniakowski 1992). Of 360 bodies two were above 1.001, by up to 1.1 %";
    let ratio = limits.lanczos / limits.bisected;
    let bound = Bound::Between(0.9, 1.0 + OUT_OF_SIGHT);
    study.checks.push(Check::new(&id, &words, Kind::Exact, ratio, bound, "1", source));
    if let Some(followed) = limits.followed {
        let id = format!("time_step/{}/followed", specimen.id);
        let words = format!("step by Lanczos from the mode at rest: {}", specimen.words);
        let ratio = followed / limits.bisected;
        study.checks.push(Check::new(&id, &words, Kind::Exact, ratio, bound, "1", source));
    } else {
        let id = format!("time_step/{}/bound", specimen.id);
        let words = format!("per-point bound over the largest stable step: {}", specimen.words);
        let source = "No eigenvalue of the body is larger than the largest of a single point with \
                      its share of the masses (Joldes, Wittek, Miller 2012)";
        let ratio = limits.bound / limits.bisected;
        let bound = Bound::AtMost(1.0);
        study.checks.push(Check::new(&id, &words, Kind::Exact, ratio, bound, "1", source));
    }
}

fn row(specimen: &Specimen, limits: &Limits) -> Vec<Cell> {
    let numbers = [
        limits.nodes as f64,
        limits.points as f64,
        limits.bisected,
        limits.lanczos,
        limits.lanczos / limits.bisected,
        limits.bound / limits.bisected,
        limits.products as f64,
    ];
    let mut row = vec![Cell::Text(specimen.words.clone())];
    row.extend(numbers.map(Cell::Number));
    row
}
