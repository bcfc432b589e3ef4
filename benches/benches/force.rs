//! The internal force by size and support, the plain loop on the same bodies,
//! and the limits of the machine.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mtled::discretisation::Discretisation;
use mtled_benches::{Limit, Size, Unit, note, settings, smoke};
use mtled_verify::machine::caches;
use mtled_verify::speed::bench::limits::{Triad, multiply_adds, operations};
use mtled_verify::speed::bench::plain::PlainLoop;
use mtled_verify::speed::bench::pose::{Place, Subject, cube};
use rayon::ThreadPoolBuilder;

const TMP: &str = env!("CARGO_TARGET_TMPDIR");
/// Multiply-adds per chain and call.
const ROUNDS: usize = 100_000;

fn limits(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("limits");
    let mut triad = Triad::new(4 * caches().1);
    let bytes = Limit { amount: triad.bytes() as f64, unit: Unit::Bytes };
    for name in ["triad", "triad_all_threads"] {
        note(TMP, ["limits", name], "limit.json", &bytes);
    }
    group.throughput(Throughput::Bytes(triad.bytes() as u64));
    group.bench_function("triad", |bencher| bencher.iter(|| triad.pass()));
    group.bench_function("triad_all_threads", |bencher| bencher.iter(|| triad.parallel_pass()));
    let amount = operations(ROUNDS, multiply_adds(1));
    note(TMP, ["limits", "multiply_adds"], "limit.json", &Limit { amount, unit: Unit::Operations });
    group.throughput(Throughput::Elements(amount as u64));
    group.bench_function("multiply_adds", |bencher| bencher.iter(|| multiply_adds(ROUNDS)));
    group.finish();
}

/// Every body on one thread by the solver and by the plain loop, and on all
/// threads by the solver.
fn force(criterion: &mut Criterion) {
    let one = ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be had");
    for place in [Place::SecondCache, Place::LastCache, Place::Memory] {
        for neighbours in [30.0, 70.0] {
            let problem = cube(place.cells(neighbours, smoke()), neighbours);
            let discretisation = Discretisation::new(&problem).expect("the cube is sound");
            let mut subject = Subject::new(&problem, &discretisation).expect("the cube is sound");
            let mut plain = PlainLoop::new(&problem, &discretisation);
            let (u, mut f) = (subject.u.clone(), subject.f.clone());
            let name = format!("{}_{neighbours}", place.name().to_lowercase());
            let size = Size::of(&discretisation).streamed(&subject.model);
            let mut measure = |group: &str, work: &mut dyn FnMut()| {
                note(TMP, [group, &name], "size.json", &size);
                let mut group = criterion.benchmark_group(group);
                group.throughput(Throughput::Elements(size.points as u64));
                group.bench_function(&name, |bencher| bencher.iter(&mut *work));
                group.finish();
            };
            measure("internal_force", &mut || one.install(|| subject.evaluate()));
            measure("plain_loop", &mut || plain.internal_force(&u, &mut f));
            measure("internal_force_all_threads", &mut || subject.evaluate());
            let sound = subject.f.iter().chain(&f).all(|x| x.is_finite());
            assert!(sound, "{name}: the force is not finite");
        }
    }
}

criterion_group! { name = benches; config = settings(); targets = limits, force }
criterion_main!(benches);
