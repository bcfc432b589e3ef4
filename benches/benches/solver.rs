//! The cost of the three things that a run spends its time on. The problems are
//! those of the carried case files; only sizes are changed here.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mtled::discretisation::Discretisation;
use mtled::internal_force::{Workspace, internal_force};
use mtled::model::Model;
use mtled::problem::{Basis, Cloud, Motion, Problem, StepControl};
use mtled::state::State;
use mtled::step::{Buffers, Scheme, step};
use mtled_verify::cases::unpack;
use mtled_verify::scene::read_case;
use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

const TMP: &str = env!("CARGO_TARGET_TMPDIR");

/// A carried case.
fn problem(name: &str) -> Problem {
    let cases = unpack(&Path::new(TMP).join("bench")).expect("the temporary folder is writable");
    read_case(&cases.join(format!("{name}.toml"))).expect("carried cases are sound").problem
}

/// The bonded cube with nodes and cells `factor` times as close as in its case.
fn cube(factor: f64) -> Problem {
    let mut problem = problem("cube_compression");
    if let Cloud::Regular { spacing } = &mut problem.recipe.cloud {
        *spacing /= factor;
    }
    problem.recipe.grid.cell /= factor;
    problem
}

fn discretise(problem: &Problem) -> Discretisation {
    Discretisation::new(problem).expect("carried cases can be discretised")
}

/// Leaves the size of a benchmark beside Criterion's files, for `bench-table`.
fn note_size(group: &str, name: &str, discretisation: &Discretisation) {
    let dir = Path::new(TMP).with_file_name("criterion").join(group).join(name);
    let text = format!(
        "{{\"nodes\": {}, \"points\": {}, \"neighbours\": {}}}\n",
        discretisation.cloud.positions.len(),
        discretisation.supports.len(),
        discretisation.mean_support()
    );
    let written =
        std::fs::create_dir_all(&dir).and_then(|()| std::fs::write(dir.join("size.json"), text));
    written.expect("the target folder is writable");
}

fn points(discretisation: &Discretisation) -> Throughput {
    Throughput::Elements(discretisation.supports.len() as u64)
}

/// φ and Grad φ at every quadrature point, one after the other.
fn mls(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("mls");
    // A quadratic basis needs wider supports.
    for (name, basis, dilation) in
        [("linear", Basis::Linear, 1.8), ("quadratic", Basis::Quadratic, 2.6)]
    {
        let mut problem = cube(1.0);
        (problem.recipe.basis, problem.recipe.dilation) = (basis, dilation);
        let discretisation = discretise(&problem);
        note_size("mls", name, &discretisation);
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

/// A stretch with some shear and bending, far from rest and from inversion.
fn deformed(model: &Model) -> Vec<f64> {
    let bend = |x: f64, y: f64, z: f64| [0.05 * x + 0.1 * y * z, 0.02 * z, -0.04 * z + 0.1 * x * x];
    model.positions.iter().flat_map(|p| bend(p.x, p.y, p.z)).collect()
}

fn force(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("internal_force");
    for (name, factor) in [("cube_1k", 1.0), ("cube_30k", 3.0)] {
        let problem = cube(factor);
        let discretisation = discretise(&problem);
        note_size("internal_force", name, &discretisation);
        let model = Model::new(&problem, &discretisation).expect("carried cases are sound");
        let (u, mut f) = (deformed(&model), vec![0.0; model.size()]);
        let mut workspace = Workspace::new(&model);
        group.throughput(points(&discretisation));
        group.bench_function(name, |bencher| {
            bencher.iter(|| internal_force(&model, black_box(&u), &mut workspace, &mut f));
        });
        assert!(f.iter().all(|x| x.is_finite()), "{name}: the force is not finite");
    }
    group.finish();
}

/// Whole steps: forces, prediction, conditions, contact. The run goes on from
/// sample to sample, damped, so that it stays bounded.
fn whole_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    for (name, problem) in [("cube_1k", cube(1.0)), ("brain_slice", problem("brain_slice"))] {
        let discretisation = discretise(&problem);
        note_size("step", name, &discretisation);
        let mut problem = problem;
        let damping = match problem.motion {
            Motion::Dynamic { damping, .. } => damping,
            _ => 10.0,
        };
        problem.motion = Motion::Dynamic { end: 1.0, step: StepControl::default(), damping };
        let model = Model::new(&problem, &discretisation).expect("carried cases are sound");
        let time_step = 0.9 * model.bound;
        let scheme = Scheme::central_difference(time_step, time_step, damping);
        let (mut state, mut buffers) = (State::new(&model), Buffers::new(&model, false));
        group.throughput(points(&discretisation));
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let now = state.time;
                step(&model, &scheme, now, now + time_step, &mut state, &mut buffers)
            });
        });
        assert!(state.displacement.iter().all(|x| x.is_finite()), "{name}: the run diverged");
    }
    group.finish();
}

fn settings() -> Criterion {
    Criterion::default()
        .sample_size(30)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(4))
}

criterion_group! { name = benches; config = settings(); targets = mls, force, whole_step }
criterion_main!(benches);
