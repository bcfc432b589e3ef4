//! The set-up before the first step: neighbours, moving least squares,
//! quadrature, consistent gradients, critical step.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mtled::discretisation::Discretisation;
use mtled::discretisation::neighbours::Neighbours;
use mtled::discretisation::quadrature::quadrature;
use mtled::model::Model;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::motion::internal_force::Workspace;
use mtled::problem::{Basis, Gradients, Problem};
use mtled_benches::{BodySize, settings, smoke, write_note};
use mtled_verify::speed::bench::bodies::cube;
use std::hint::black_box;

const TMP: &str = env!("CARGO_TARGET_TMPDIR");

/// A body of about 30 000 points, or few in a smoke test.
fn body(neighbours: f64) -> Problem {
    cube(if smoke() { 10 } else { 31 }, neighbours)
}

fn discretise(problem: &Problem) -> Discretisation {
    Discretisation::new(problem).expect("the cube is valid")
}

fn points(discretisation: &Discretisation) -> Throughput {
    Throughput::Elements(discretisation.supports.len() as u64)
}

/// φ and Grad φ at every quadrature point on one thread.
fn mls(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("mls");
    // A quadratic basis needs wider supports.
    for (name, basis, neighbours) in
        [("linear", Basis::Linear, 32.0), ("quadratic", Basis::Quadratic, 60.0)]
    {
        let mut problem = body(neighbours);
        problem.recipe.basis = basis;
        let discretisation = discretise(&problem);
        write_note(TMP, ["mls", name], "size.json", &BodySize::of(&discretisation));
        group.throughput(points(&discretisation));
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for position in &discretisation.quadrature.positions {
                    let _ = black_box(discretisation.approximation.evaluate(black_box(position)));
                }
            });
        });
    }
    group.finish();
}

/// Nodes within a radius of every quadrature point, with the sorting into cells.
fn neighbours(criterion: &mut Criterion) {
    let problem = body(32.0);
    let discretisation = discretise(&problem);
    let nodes = &discretisation.cloud.positions;
    let radius = problem.recipe.dilation * discretisation.cloud.spacing[0];
    write_note(TMP, ["neighbours", "search"], "size.json", &BodySize::of(&discretisation));
    let mut group = criterion.benchmark_group("neighbours");
    group.throughput(points(&discretisation));
    group.bench_function("search", |bencher| {
        bencher.iter(|| {
            let cells = Neighbours::new(nodes, 0.5 * radius);
            let mut found = 0;
            for position in &discretisation.quadrature.positions {
                cells.for_each_within(position, radius, |_, _| found += 1);
            }
            black_box(found)
        });
    });
    group.finish();
}

/// The quadrature and the whole discretisation on all threads.
fn discretisation(criterion: &mut Criterion) {
    let plain = body(32.0);
    let mut consistent = plain.clone();
    consistent.recipe.gradients = Gradients::Consistent { tolerance: 1e-3 };
    let size = BodySize::of(&discretise(&plain));
    let mut group = criterion.benchmark_group("discretisation");
    group.sample_size(10).throughput(Throughput::Elements(size.points as u64));
    for name in ["quadrature", "plain", "consistent"] {
        write_note(TMP, ["discretisation", name], "size.json", &size);
    }
    group.bench_function("quadrature", |bencher| {
        let grid = &plain.recipe.grid;
        bencher.iter(|| quadrature(&plain.body, &plain.regions, grid, &plain.dimension));
    });
    group.bench_function("plain", |bencher| bencher.iter(|| discretise(&plain)));
    group.bench_function("consistent", |bencher| bencher.iter(|| discretise(&consistent)));
    group.finish();
}

/// The model with its masses, conditions and blocks, and the critical step by Lanczos.
fn critical_step(criterion: &mut Criterion) {
    let problem = body(32.0);
    let discretisation = discretise(&problem);
    let assemble = || Model::new(&problem, &discretisation).expect("the cube is valid");
    let model = assemble();
    let mut group = criterion.benchmark_group("model");
    group.sample_size(10).throughput(points(&discretisation));
    for name in ["bind", "critical_step"] {
        write_note(TMP, ["model", name], "size.json", &BodySize::of(&discretisation));
    }
    group.bench_function("bind", |bencher| bencher.iter(assemble));
    let (rest, mut workspace) = (vec![0.0; model.size()], Workspace::new(&model));
    group.bench_function("critical_step", |bencher| {
        bencher.iter(|| critical_time_step(&model, &rest, 0.0, None, &mut workspace));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = settings();
    targets = mls, neighbours, discretisation, critical_step
}
criterion_main!(benches);
