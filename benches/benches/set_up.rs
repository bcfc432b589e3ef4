//! The set-up before the first step: neighbours, moving least squares,
//! quadrature, consistent gradients, critical step.

use criterion::{Criterion, criterion_group, criterion_main};
use mtled::discretisation::Discretisation;
use mtled::discretisation::neighbours::Neighbours;
use mtled::discretisation::nodes::node_cloud;
use mtled::discretisation::quadrature::quadrature;
use mtled::force::Workspace;
use mtled::model::Model;
use mtled::motion::critical_time_step::critical_time_step;
use mtled::problem::{Basis, Gradients, Problem};
use mtled_benches::bodies::{cube, recommended};
use mtled_benches::measure::{Group, all_threads, one_thread, settings, smoke};
use mtled_benches::notes::BodySize;
use mtled_run::machine::peak_memory;
use std::hint::black_box;

const TMP: &str = env!("CARGO_TARGET_TMPDIR");

/// A body of about 30 000 points, or few in a smoke test.
fn body(neighbours: f64) -> Problem {
    cube(if smoke() { 10 } else { 31 }, neighbours)
}

fn discretise(problem: &Problem) -> Discretisation {
    Discretisation::new(problem).expect("the cube is valid")
}

fn assemble(problem: &Problem, discretisation: &Discretisation) -> Model {
    Model::new(problem, discretisation).expect("the cube is valid")
}

/// A body of about 100 000 nodes and 200 000 points on all threads. This is measured first,
/// since the peak of the memory is that of the process.
fn large(criterion: &mut Criterion) {
    let problem = recommended(cube(if smoke() { 10 } else { 58 }, 30.0));
    let set_up = || {
        let discretisation = discretise(&problem);
        black_box(assemble(&problem, &discretisation));
        BodySize::of(&discretisation)
    };
    let all = all_threads();
    let size = all.install(set_up);
    let size = BodySize { peak: peak_memory(), ..size };
    let mut group = Group::new(criterion, TMP, "set_up").of_long_calls();
    group.measure("large", &size, &all, || {
        black_box(set_up());
    });
    group.finish();
}

/// φ and Grad φ at every quadrature point on one thread.
fn mls(criterion: &mut Criterion) {
    let one = one_thread();
    let mut group = Group::new(criterion, TMP, "mls");
    // A quadratic basis needs wider supports.
    for (name, basis, neighbours) in
        [("linear", Basis::Linear, 32.0), ("quadratic", Basis::Quadratic, 60.0)]
    {
        let mut problem = body(neighbours);
        problem.recipe.basis = basis;
        let discretisation = discretise(&problem);
        group.measure(name, &BodySize::of(&discretisation), &one, || {
            for position in &discretisation.quadrature.positions {
                let _ = black_box(discretisation.approximation.evaluate(black_box(position)));
            }
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
    let mut group = Group::new(criterion, TMP, "neighbours");
    group.measure("search", &BodySize::of(&discretisation), &one_thread(), || {
        let cells = Neighbours::new(nodes, 0.5 * radius);
        let mut found = 0;
        for position in &discretisation.quadrature.positions {
            cells.for_each_within(position, radius, |_, _| found += 1);
        }
        black_box(found);
    });
    group.finish();
}

/// Nodes, quadrature and the whole discretisation by gradients, on one thread.
fn discretisation(criterion: &mut Criterion) {
    let plain = body(32.0);
    let mut consistent = plain.clone();
    consistent.recipe.gradients = Gradients::Consistent { tolerance: 1e-3 };
    let second_order = recommended(plain.clone());
    let (recipe, size, one) = (&plain.recipe, BodySize::of(&discretise(&plain)), one_thread());
    let mut group = Group::new(criterion, TMP, "discretisation").of_long_calls();
    group.measure("nodes", &size, &one, || {
        let _ = black_box(node_cloud(&plain.body, &recipe.cloud, &plain.dimension));
    });
    group.measure("quadrature", &size, &one, || {
        let _ = black_box(quadrature(&plain.body, &plain.regions, &recipe.grid, &plain.dimension));
    });
    for (name, problem) in
        [("plain", &plain), ("consistent", &consistent), ("second_order", &second_order)]
    {
        group.measure(name, &size, &one, || drop(black_box(discretise(problem))));
    }
    group.finish();
}

/// The model with its masses, conditions and blocks, and the critical step by Lanczos, on one
/// thread.
fn critical_step(criterion: &mut Criterion) {
    let problem = body(32.0);
    let discretisation = discretise(&problem);
    let model = assemble(&problem, &discretisation);
    let (size, one) = (BodySize::of(&discretisation), one_thread());
    let mut group = Group::new(criterion, TMP, "model").of_long_calls();
    group.measure("bind", &size, &one, || drop(black_box(assemble(&problem, &discretisation))));
    let (rest, mut workspace) = (vec![0.0; model.size()], Workspace::new(&model.points));
    group.measure("critical_step", &size, &one, || {
        black_box(critical_time_step(&model, &rest, 0.0, None, &mut workspace));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = settings();
    targets = large, mls, neighbours, discretisation, critical_step
}
criterion_main!(benches);
