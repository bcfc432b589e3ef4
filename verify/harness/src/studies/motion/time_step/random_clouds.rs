//! The default step on many random clouds.

use crate::studies::motion::time_step::families::{FAMILIES, Family};
use crate::studies::workbench::{Workbench, range};
use mtled::Simulation;
use mtled::force::Workspace;
use mtled::model::time_step_bound::comparison_bounds;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::problem::StepControl;
use mtled_checks::study::{
    Bound, Cell, Check, Figure, Kind, Plot, SeriesStyle, Study, Table, axis, number, styled, text,
};
use mtled_run::specimens::stable_step::{largest_stable_step, trial_velocity};
use rayon::prelude::*;

/// One cloud: steps over the largest stable one \[–\].
#[derive(Debug, Clone, Copy)]
struct Ratios {
    default: f64,
    per_point: f64,
    by_shares: f64,
    by_rows: f64,
    products: usize,
}

/// Compares the default step and three bounds with the largest stable step of every member.
pub(crate) fn random_clouds(bench: &Workbench, study: &mut Study) -> anyhow::Result<()> {
    let seeds: u64 = bench.pick(3, 25);
    let mut rows = Vec::new();
    let mut all = Vec::new();
    for family in &FAMILIES {
        let measured: anyhow::Result<Vec<Ratios>> =
            (0..seeds).into_par_iter().map(|seed| measure(family, bench.seed(seed))).collect();
        let measured = measured?;
        rows.push(row(family.label, &measured));
        all.extend(measured);
    }
    rows.push(row("all", &all));
    add_checks(study, &all);
    study.tables.push(Table {
        title: format!("Steps over the largest stable one, {seeds} random clouds of each family"),
        columns: vec![
            text("family"),
            number("default step, least", "1"),
            number("default step, most", "1"),
            number("per-point bound, least", "1"),
            number("per-point bound, most", "1"),
            number("bound by mass fractions, least", "1"),
            number("bound by mass fractions, most", "1"),
            number("bound by rows, least", "1"),
            number("bound by rows, most", "1"),
            number("products of Lanczos, most", "1"),
        ],
        rows,
    });
    let points = |value: fn(&Ratios) -> f64| {
        all.iter().enumerate().map(|(n, r)| (n as f64 + 1.0, value(r))).collect()
    };
    study.figures.push(Figure::Plot(Plot {
        title: "Default step and bounds on random clouds".into(),
        caption: "Families in the order of the table. Above 1 a run diverges.".into(),
        x: axis("cloud", "1", false),
        y: axis("step over largest stable step", "1", false),
        series: vec![
            styled("default step", points(|r| r.default), SeriesStyle::Points),
            styled("bound by mass fractions", points(|r| r.by_shares), SeriesStyle::Points),
            styled("bound by rows", points(|r| r.by_rows), SeriesStyle::Points),
            styled("per-point bound", points(|r| r.per_point), SeriesStyle::Points),
        ],
        slopes: Vec::new(),
    }));
    Ok(())
}

fn measure(family: &Family, seed: u64) -> anyhow::Result<Ratios> {
    let located = |error: anyhow::Error| error.context(format!("{}, seed {seed}", family.label));
    let problem = family.member(seed).map_err(located)?;
    let simulation =
        Simulation::with_any_recipe(&problem).map_err(|error| located(error.into()))?;
    let model = &simulation.model;
    let u = vec![0.0; model.size()];
    let critical = critical_time_step(model, &u, 0.0, None, &mut Workspace::new(&model.points));
    let velocity = trial_velocity(model, &simulation.discretisation.cloud.spacing);
    let largest = largest_stable_step(model, &u, 0.0, &velocity, critical.time_step);
    let bounds = comparison_bounds(&problem, &simulation.discretisation, &model.lumped_mass);
    Ok(Ratios {
        default: StepControl::default().safety_factor * critical.time_step / largest,
        per_point: model.per_point_bound / largest,
        by_shares: bounds.by_fractions / largest,
        by_rows: bounds.by_rows / largest,
        products: critical.products,
    })
}

fn row(label: &str, ratios: &[Ratios]) -> Vec<Cell> {
    let values: [fn(&Ratios) -> f64; 4] =
        [|r| r.default, |r| r.per_point, |r| r.by_shares, |r| r.by_rows];
    let mut row = vec![Cell::Text(label.into())];
    for value in values {
        let (low, high) = range(ratios.iter().map(value));
        row.extend([Cell::Number(low), Cell::Number(high)]);
    }
    let products = ratios.iter().map(|r| r.products).max().unwrap_or(0);
    row.push(Cell::Number(products as f64));
    row
}

fn add_checks(study: &mut Study, all: &[Ratios]) {
    let (least, most) = range(all.iter().map(|r| r.default));
    let limit = "central differences are stable up to 2/√λ_max; the target is to lose at most a tenth \
                 of it";
    let mut check = |id: &str, label: &str, value: f64, bound: Bound, source: &str| {
        study.checks.push(Check::new(id, label, Kind::Exact, value, bound, "1", source));
    };
    let id = "time_step/clouds/default_least";
    let label = "default step over the largest stable one, least of all random clouds";
    check(id, label, least, Bound::AtLeast(0.9), limit);
    let id = "time_step/clouds/default_most";
    let label = "default step over the largest stable one, most of all random clouds";
    check(id, label, most, Bound::AtMost(1.0), limit);
    let id = "time_step/clouds/gain";
    let label = "default step over the per-point bound, least of all random clouds";
    let gain = all.iter().map(|r| r.default / r.per_point).fold(f64::INFINITY, f64::min);
    check(id, label, gain, Bound::AtLeast(2.0), "the loss of the bound of the literature");
    for (id, label, value) in [
        (
            "time_step/clouds/by_shares",
            "bound by mass fractions",
            (|r| r.by_shares) as fn(&Ratios) -> f64,
        ),
        ("time_step/clouds/by_rows", "bound by rows", |r| r.by_rows),
        ("time_step/clouds/per_point", "per-point bound", |r| r.per_point),
    ] {
        let label = format!("{label} over the largest stable step, most of all random clouds");
        let source = "an upper bound on the largest eigenvalue; the bisection has a width of 0.1 %";
        check(id, &label, range(all.iter().map(value)).1, Bound::AtMost(1.001), source);
    }
}
