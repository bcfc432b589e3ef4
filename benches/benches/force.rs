//! The internal force by size and support, the plain loop on the same bodies, variants of the
//! force in pairs, and the limits of the machine.

use criterion::{Criterion, criterion_group, criterion_main};
use mtled::discretisation::Discretisation;
use mtled::problem::Problem;
use mtled_benches::bodies::{
    DeformedModel, MemoryLevel, cube, in_order, in_single_precision, pointwise, same_force,
    shuffled, with_given_nodes,
};
use mtled_benches::limits::{Triad, caches, multiply_adds, operations};
use mtled_benches::measure::{Group, all_threads, one_thread, settings, smoke};
use mtled_benches::notes::{BodySize, Limit, Unit, VARIANTS};
use mtled_benches::plain_loop::PlainLoop;
use rayon::ThreadPool;

const TMP: &str = env!("CARGO_TARGET_TMPDIR");
/// Multiply-adds per chain and call.
const ROUNDS: usize = 100_000;
/// Largest difference of two forces that round-off explains, over the largest force.
const ROUND_OFF: f64 = 1e-9;

fn limits(criterion: &mut Criterion) {
    let mut group = Group::new(criterion, TMP, "limits");
    let (one, all) = (one_thread(), all_threads());
    let mut triad = Triad::new(4 * caches().1);
    let bytes = Limit { amount: triad.bytes() as f64, unit: Unit::Bytes };
    group.measure("triad", &bytes, &one, || triad.pass());
    group.measure("triad_all_threads", &bytes, &all, || triad.parallel_pass());
    let amount = operations(ROUNDS, multiply_adds(1));
    let operations = Limit { amount, unit: Unit::Operations };
    group.measure("multiply_adds", &operations, &one, || {
        multiply_adds(ROUNDS);
    });
    group.finish();
}

fn body(level: MemoryLevel, neighbours: f64) -> Problem {
    cube(level.cells(neighbours, smoke()), neighbours)
}

fn discretise(problem: &Problem) -> Discretisation {
    Discretisation::new(problem).expect("the cube is valid")
}

fn deform(problem: &Problem, discretisation: &Discretisation) -> DeformedModel {
    DeformedModel::new(problem, discretisation).expect("the cube is valid")
}

fn name(level: MemoryLevel, neighbours: f64) -> String {
    format!("{}_{neighbours}", level.name().to_lowercase())
}

/// A problem by the plain loop and by the solver, on one thread.
fn beside_the_plain_loop(group: &mut Group, one: &ThreadPool, name: &str, problem: &Problem) {
    let discretisation = discretise(problem);
    let mut model = deform(problem, &discretisation);
    let mut plain = PlainLoop::new(problem, &discretisation);
    let (u, mut f) = (model.u.clone(), model.f.clone());
    model.evaluate();
    plain.internal_force(&u, &mut f);
    same_force(&model.f, &f, ROUND_OFF).expect("the plain loop is the same mathematics");
    let size = BodySize::of(&discretisation);
    let plain_name = format!("{name}_plain_loop");
    group.measure(&plain_name, &size, one, || plain.internal_force(&u, &mut f));
    // Bodies in the caches are not limited by the bandwidth of the memory.
    let in_memory = name.starts_with("dram");
    let size = if in_memory { size.streamed(&model.model) } else { size };
    group.measure(name, &size, one, || model.evaluate());
    group.pair("plain loop over solver", &plain_name, name);
}

/// Every body, and two of them with J at each point in place of its projection.
fn force(criterion: &mut Criterion) {
    let mut group = Group::new(criterion, TMP, "internal_force");
    let one = one_thread();
    for level in [MemoryLevel::SecondCache, MemoryLevel::LastCache, MemoryLevel::Memory] {
        for neighbours in [30.0, 70.0] {
            let (name, problem) = (name(level, neighbours), body(level, neighbours));
            beside_the_plain_loop(&mut group, &one, &name, &problem);
            if neighbours == 30.0 && level != MemoryLevel::LastCache {
                let name = format!("{name}_pointwise");
                beside_the_plain_loop(&mut group, &one, &name, &pointwise(problem));
            }
        }
    }
    group.finish();
}

/// A model that is compared with another one.
struct Variant<'a> {
    name: &'static str,
    model: DeformedModel,
    pool: &'a ThreadPool,
}

/// Measures two variants of the force on one body.
fn compare(group: &mut Group, label: &str, body: &str, size: &BodySize, pair: [Variant; 2]) {
    let names = pair.each_ref().map(|variant| format!("{body}_{}", variant.name));
    for (name, Variant { mut model, pool, .. }) in names.iter().zip(pair) {
        group.measure(name, size, pool, || model.evaluate());
    }
    group.pair(label, &names[0], &names[1]);
}

fn variants(criterion: &mut Criterion) {
    let mut group = Group::new(criterion, TMP, VARIANTS);
    let (one, all) = (one_thread(), all_threads());
    for neighbours in [30.0, 70.0] {
        precision(&mut group, &one, MemoryLevel::Memory, neighbours);
    }
    for level in [MemoryLevel::LastCache, MemoryLevel::Memory] {
        order(&mut group, &one, level, 30.0);
    }
    for level in [MemoryLevel::LastCache, MemoryLevel::Memory] {
        threads(&mut group, [&one, &all], level, 30.0);
    }
    group.finish();
}

/// Gradients stored in double over single precision.
fn precision(group: &mut Group, pool: &ThreadPool, level: MemoryLevel, neighbours: f64) {
    let problem = body(level, neighbours);
    let discretisation = discretise(&problem);
    let mut double = deform(&problem, &discretisation);
    let mut single = deform(&in_single_precision(problem), &discretisation);
    double.evaluate();
    single.evaluate();
    same_force(&single.f, &double.f, 1e-5).expect("single precision suffices");
    let pair = [
        Variant { name: "double", model: double, pool },
        Variant { name: "single", model: single, pool },
    ];
    let (body, size) = (name(level, neighbours), BodySize::of(&discretisation));
    compare(group, "double over single precision", &body, &size, pair);
}

/// Nodes given in random order over the same nodes sorted.
fn order(group: &mut Group, pool: &ThreadPool, level: MemoryLevel, neighbours: f64) {
    let sorted = with_given_nodes(body(level, neighbours)).expect("the cube is valid");
    let in_disorder = shuffled(sorted.clone());
    let discretisation = discretise(&in_disorder);
    let mut first = deform(&in_disorder, &discretisation);
    let mut second = deform(&sorted, &discretise(&sorted));
    first.evaluate();
    second.evaluate();
    same_force(&in_order(&first.f), &in_order(&second.f), ROUND_OFF)
        .expect("the order of the nodes does not matter");
    let pair = [
        Variant { name: "shuffled", model: first, pool },
        Variant { name: "sorted", model: second, pool },
    ];
    let (body, size) = (name(level, neighbours), BodySize::of(&discretisation));
    compare(group, "shuffled over sorted nodes", &body, &size, pair);
}

/// One thread over all threads.
fn threads(group: &mut Group, pools: [&ThreadPool; 2], level: MemoryLevel, neighbours: f64) {
    let problem = body(level, neighbours);
    let discretisation = discretise(&problem);
    let [first, second] = pools.map(|pool| {
        let mut model = deform(&problem, &discretisation);
        pool.install(|| model.evaluate());
        model
    });
    assert!(first.f == second.f, "the internal force depends on the number of threads");
    let pair = [
        Variant { name: "one_thread", model: first, pool: pools[0] },
        Variant { name: "all_threads", model: second, pool: pools[1] },
    ];
    let (body, size) = (name(level, neighbours), BodySize::of(&discretisation));
    compare(group, "one thread over all threads", &body, &size, pair);
}

criterion_group! { name = benches; config = settings(); targets = limits, force, variants }
criterion_main!(benches);
