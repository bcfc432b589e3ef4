//! Time steps with and without contact, and small cases from the problem to the result.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mtled::discretisation::Discretisation;
use mtled::problem::Problem;
use mtled_benches::{BodySize, settings, smoke, write_note};
use mtled_verify::bundled::unpack;
use mtled_verify::run::solve_case;
use mtled_verify::scene::Case;
use mtled_verify::speed::bench::bodies::cube;
use mtled_verify::speed::bench::{Stepper, bundled_case};
use std::path::Path;

const TMP: &str = env!("CARGO_TARGET_TMPDIR");

fn case(name: &str) -> Case {
    let cases = unpack(&Path::new(TMP).join("bench")).expect("the temporary folder is writable");
    bundled_case(&cases, name).expect("bundled cases are valid")
}

/// Forces, prediction, conditions and contact. The simulation continues from sample to sample,
/// damped so that it stays bounded.
fn whole_step(criterion: &mut Criterion) {
    let slice = case("brain_slice").problem;
    let free = Problem { obstacles: Vec::new(), ..slice.clone() };
    let mut group = criterion.benchmark_group("step");
    for (name, problem) in [
        ("cube_1k", cube(10, 30.0)),
        ("cube_30k", cube(if smoke() { 12 } else { 31 }, 30.0)),
        ("brain_slice_in_its_skull", slice),
        ("brain_slice_without_obstacles", free),
    ] {
        let discretisation = Discretisation::new(&problem).expect("bundled cases are valid");
        let mut stepper = Stepper::new(&problem, &discretisation).expect("bundled cases are valid");
        let size = BodySize::of(&discretisation).streamed(&stepper.model);
        write_note(TMP, ["step", name], "size.json", &size);
        group.throughput(Throughput::Elements(size.points as u64));
        group.bench_function(name, |bencher| bencher.iter(|| stepper.step()));
        stepper.check().expect("damped steps stay bounded");
    }
    group.finish();
}

/// From the problem to the result.
fn whole_case(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("case");
    group.sample_size(10);
    for name in ["uniaxial_bar", "cube_compression", "cook_membrane"] {
        let case = case(name);
        let discretisation = Discretisation::new(&case.problem).expect("bundled cases are valid");
        write_note(TMP, ["case", name], "size.json", &BodySize::of(&discretisation));
        group.bench_function(name, |bencher| {
            bencher.iter(|| solve_case(&case).expect("bundled cases can be solved"));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = settings(); targets = whole_step, whole_case }
criterion_main!(benches);
