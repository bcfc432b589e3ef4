//! The internal force by size and support, the plain loop on the same bodies, and the
//! limits of the machine.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mtled::discretisation::Discretisation;
use mtled_benches::{BodySize, Limit, Unit, settings, smoke, write_note};
use mtled_verify::machine::caches;
use mtled_verify::speed::bench::bodies::{DeformedModel, MemoryLevel, cube};
use mtled_verify::speed::bench::limits::{Triad, multiply_adds, operations};
use mtled_verify::speed::bench::plain_loop::PlainLoop;
use rayon::ThreadPoolBuilder;

const TMP: &str = env!("CARGO_TARGET_TMPDIR");
/// Multiply-adds per chain and call.
const ROUNDS: usize = 100_000;

fn limits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("limits");
    let mut triad = Triad::new(4 * caches().1);
    let bytes = Limit { amount: triad.bytes() as f64, unit: Unit::Bytes };
    for name in ["triad", "triad_all_threads"] {
        write_note(TMP, ["limits", name], "limit.json", &bytes);
    }
    group.throughput(Throughput::Bytes(triad.bytes() as u64));
    group.bench_function("triad", |bencher| bencher.iter(|| triad.pass()));
    group.bench_function("triad_all_threads", |bencher| bencher.iter(|| triad.parallel_pass()));
    let amount = operations(ROUNDS, multiply_adds(1));
    write_note(
        TMP,
        ["limits", "multiply_adds"],
        "limit.json",
        &Limit { amount, unit: Unit::Operations },
    );
    group.throughput(Throughput::Elements(amount as u64));
    group.bench_function("multiply_adds", |bencher| bencher.iter(|| multiply_adds(ROUNDS)));
    group.finish();
}

/// Every body on one thread by the solver and by the plain loop, and on all
/// threads by the solver.
fn force(criterion: &mut Criterion) {
    let one = ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    for level in [MemoryLevel::SecondCache, MemoryLevel::LastCache, MemoryLevel::Memory] {
        for neighbours in [30.0, 70.0] {
            let problem = cube(level.cells(neighbours, smoke()), neighbours);
            let discretisation = Discretisation::new(&problem).expect("the cube is valid");
            let mut model =
                DeformedModel::new(&problem, &discretisation).expect("the cube is valid");
            let mut plain = PlainLoop::new(&problem, &discretisation);
            let (u, mut f) = (model.u.clone(), model.f.clone());
            let name = format!("{}_{neighbours}", level.name().to_lowercase());
            let size = BodySize::of(&discretisation).streamed(&model.model);
            let mut measure = |group: &str, work: &mut dyn FnMut()| {
                write_note(TMP, [group, &name], "size.json", &size);
                let mut group = criterion.benchmark_group(group);
                group.throughput(Throughput::Elements(size.points as u64));
                group.bench_function(&name, |bencher| bencher.iter(&mut *work));
                group.finish();
            };
            measure("internal_force", &mut || one.install(|| model.evaluate()));
            measure("plain_loop", &mut || plain.internal_force(&u, &mut f));
            measure("internal_force_all_threads", &mut || model.evaluate());
            let finite = model.f.iter().chain(&f).all(|x| x.is_finite());
            assert!(finite, "{name}: the force is not finite");
        }
    }
}

criterion_group! { name = benches; config = settings(); targets = limits, force }
criterion_main!(benches);
