//! Time steps with and without contact, and small cases from the problem to the result.

use criterion::{Criterion, criterion_group, criterion_main};
use mtled::discretisation::Discretisation;
use mtled::problem::Problem;
use mtled_benches::bodies::{cube, recommended};
use mtled_benches::measure::{Group, all_threads, one_thread, settings, smoke};
use mtled_benches::notes::BodySize;
use mtled_benches::stepper::Stepper;
use mtled_case::bundled::unpack;
use mtled_case::scene::{Case, one_error, read_case};
use mtled_run::run::solve_case;
use rayon::ThreadPool;
use std::path::Path;

const TMP: &str = env!("CARGO_TARGET_TMPDIR");

fn case(name: &str) -> Case {
    let cases = unpack(&Path::new(TMP).join("bench")).expect("the temporary folder is writable");
    read_case(&cases.join(format!("{name}.toml")))
        .map_err(one_error)
        .expect("bundled cases are valid")
}

/// Forces, prediction, conditions and contact. The simulation continues from sample to sample,
/// damped so that it stays bounded.
fn step(group: &mut Group, name: &str, problem: &Problem, pool: &ThreadPool) {
    let discretisation = Discretisation::new(problem).expect("the problem is valid");
    let mut stepper = Stepper::new(problem, &discretisation).expect("the problem is valid");
    group.measure(name, &BodySize::of(&discretisation), pool, || stepper.step());
    stepper.check().expect("damped steps stay bounded");
}

fn whole_step(criterion: &mut Criterion) {
    let (one, all) = (one_thread(), all_threads());
    let slice = case("brain_slice").problem;
    let free = Problem { obstacles: Vec::new(), ..slice.clone() };
    let small = recommended(cube(10, 30.0));
    let large = recommended(cube(if smoke() { 12 } else { 31 }, 30.0));
    let mut group = Group::new(criterion, TMP, "step");
    step(&mut group, "cube_1k", &small, &one);
    step(&mut group, "cube_30k", &large, &one);
    step(&mut group, "cube_30k_all_threads", &large, &all);
    group.pair("step on one thread over all threads", "cube_30k", "cube_30k_all_threads");
    step(&mut group, "brain_slice_in_its_skull", &slice, &one);
    step(&mut group, "brain_slice_without_obstacles", &free, &one);
    group.pair(
        "step with contact over without",
        "brain_slice_in_its_skull",
        "brain_slice_without_obstacles",
    );
    group.finish();
}

/// From the problem to the result, on one thread.
fn whole_case(criterion: &mut Criterion) {
    let one = one_thread();
    let mut group = Group::new(criterion, TMP, "case").of_long_calls();
    for name in ["uniaxial_bar", "cube_compression", "cook_membrane"] {
        let case = case(name);
        let discretisation = Discretisation::new(&case.problem).expect("bundled cases are valid");
        group.measure(name, &BodySize::of(&discretisation), &one, || {
            solve_case(&case).expect("bundled cases can be solved");
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = settings(); targets = whole_step, whole_case }
criterion_main!(benches);
