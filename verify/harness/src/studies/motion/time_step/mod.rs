//! The critical time step against the largest stable one of real runs.

mod families;
mod random_clouds;
mod runs;
mod specimens;

use crate::studies::motion::time_step::random_clouds::random_clouds;
use crate::studies::motion::time_step::runs::runs;
use crate::studies::motion::time_step::specimens::{Specimen, specimens};
use crate::studies::workbench::Workbench;
use mtled::Simulation;
use mtled::force::Workspace;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled_checks::study::{
    Bound, Cell, Check, Figure, Kind, Plot, SeriesStyle, Study, Table, axis, number, styled, text,
};
use mtled_run::specimens::stable_step::{
    BISECTION, GROWTH, TRIAL_STEPS, largest_stable_step, trial_velocity,
};

/// By how much Lanczos may overestimate the step, in one of a hundred cases at most \[–\].
const OVERESTIMATE: f64 = 0.03;

/// Steps \[s\] of one specimen.
#[derive(Debug, Clone, Copy)]
struct Limits {
    nodes: usize,
    points: usize,
    bound: f64,
    lanczos: f64,
    bisected: f64,
    products: usize,
    /// By Lanczos from the stiffest mode at rest, as in runs \[s\].
    followed: Option<f64>,
}

/// Compares the estimates on single specimens, on random clouds and during runs.
pub(crate) fn time_step(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
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
    let simulation = Simulation::with_any_recipe(&specimen.problem)?;
    let model = &simulation.model;
    let mut state = State::new(model);
    let mut workspace = Workspace::new(&model.points);
    let rest = critical_time_step(model, &state.displacement, 0.0, None, &mut workspace);
    if specimen.deformed {
        simulate(model, &specimen.problem.motion, &mut state, &mut Unobserved)?;
    }
    let (u, t) = (&state.displacement, state.time);
    let critical = critical_time_step(model, u, t, None, &mut workspace);
    let followed = || critical_time_step(model, u, t, Some(&rest), &mut workspace).time_step;
    let followed = specimen.deformed.then(followed);
    let velocity = trial_velocity(model, &simulation.discretisation.cloud.spacing);
    Ok(Limits {
        nodes: model.positions.len(),
        points: model.point_positions.len(),
        bound: model.per_point_bound,
        lanczos: critical.time_step,
        bisected: largest_stable_step(model, u, t, &velocity, critical.time_step),
        products: critical.products,
        followed,
    })
}

fn add_checks(study: &mut Study, specimen: &Specimen, limits: &Limits) {
    let source = "2/√λ_max is the stability limit of central differences, and the Ritz value plus \
                  its residual is on the safe side unless a mode is missed: 20 products \
                  miss more than 6 % of λ_max, 3 % of the step, with a probability below 1 % \
                  (Kuczyński, Woźniakowski 1992). Of 360 bodies two were above 1.001, by up to 1.1 %";
    let bound = Bound::Between(0.9, 1.0 + OVERESTIMATE);
    let mut check = |id: &str, label: &str, step: f64, bound: Bound, source: &str| {
        let (id, label) =
            (format!("time_step/{}/{id}", specimen.id), format!("{label}: {}", specimen.label));
        let ratio = step / limits.bisected;
        study.checks.push(Check::new(&id, &label, Kind::Exact, ratio, bound, "1", source));
    };
    check("lanczos", "step by Lanczos over the largest stable one", limits.lanczos, bound, source);
    if let Some(followed) = limits.followed {
        check("followed", "step by Lanczos from the mode at rest", followed, bound, source);
    } else {
        let label = "per-point bound over the largest stable step";
        let source = "No eigenvalue of the body is larger than the largest of a single point with its \
                      part of the masses (Joldes, Wittek, Miller 2012, eq. 28)";
        check("bound", label, limits.bound, Bound::AtMost(1.0), source);
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
    let mut row = vec![Cell::Text(specimen.label.clone())];
    row.extend(numbers.map(Cell::Number));
    row
}
