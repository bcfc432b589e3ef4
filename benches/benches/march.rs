//! Whole steps with and without contact, and whole small cases.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mtled::discretisation::Discretisation;
use mtled::problem::Problem;
use mtled_benches::{Size, note, settings, smoke};
use mtled_verify::bundled::unpack;
use mtled_verify::run::solve_case;
use mtled_verify::scene::Case;
use mtled_verify::speed::bench::pose::cube;
use mtled_verify::speed::bench::{Marcher, carried};
use std::path::Path;

const TMP: &str = env!("CARGO_TARGET_TMPDIR");

fn case(name: &str) -> Case {
    let cases = unpack(&Path::new(TMP).join("bench")).expect("the temporary folder is writable");
    carried(&cases, name).expect("carried cases are sound")
}

/// Forces, prediction, conditions, contact. The run goes on from sample to
/// sample, damped, so that it stays bounded.
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
        let discretisation = Discretisation::new(&problem).expect("carried cases are sound");
        let mut marcher = Marcher::new(&problem, &discretisation).expect("carried cases are sound");
        let size = Size::of(&discretisation).streamed(&marcher.model);
        note(TMP, ["step", name], "size.json", &size);
        group.throughput(Throughput::Elements(size.points as u64));
        group.bench_function(name, |bencher| bencher.iter(|| marcher.step()));
        marcher.check().expect("damped steps stay bounded");
    }
    group.finish();
}

/// From the problem to the result.
fn whole_case(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("case");
    group.sample_size(10);
    for name in ["uniaxial_bar", "cube_compression", "cook_membrane"] {
        let case = case(name);
        let discretisation = Discretisation::new(&case.problem).expect("carried cases are sound");
        note(TMP, ["case", name], "size.json", &Size::of(&discretisation));
        group.bench_function(name, |bencher| {
            bencher.iter(|| solve_case(&case).expect("carried cases can be solved"));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = settings(); targets = whole_step, whole_case }
criterion_main!(benches);
