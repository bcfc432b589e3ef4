//! A step allocates nothing.
#![allow(unsafe_code)] // Counting allocations needs a `GlobalAlloc`, which is an unsafe trait.

#[path = "all/common/mod.rs"]
mod common;

use common::*;
use mtled::algebra::tensor::Vector3;
use mtled::motion::state::State;
use mtled::motion::step::{Buffers, Scheme, step};
use mtled::problem::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator; counts the allocations of the observed threads.
struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);
/// One measurement at a time.
static MEASUREMENT: Mutex<()> = Mutex::new(());

thread_local! {
    static OBSERVED: Cell<bool> = const { Cell::new(false) };
}

fn count() {
    if OBSERVED.get() {
        COUNT.fetch_add(1, Ordering::SeqCst);
    }
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Fewest allocations of all threads of a rayon pool, by rayon itself too, in one of ten runs of 50
/// steps after 100 warm-up steps: a thread that gets its first work late, on a busy machine, makes
/// its scratch memory then.
fn allocations(problem: &Problem, threads: usize) -> usize {
    let _guard = MEASUREMENT.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let (_, model) = build(problem);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .start_handler(|_| OBSERVED.set(true))
        .build()
        .unwrap();
    // A thread that is still starting would be counted.
    pool.broadcast(|_| ());
    pool.install(|| {
        let (mut state, mut buffers) = (State::new(&model), Buffers::new(&model, true));
        let time_step = 0.5 * model.per_point_bound;
        let mut run = |steps: usize| {
            for _ in 0..steps {
                let scheme = Scheme::central_difference(time_step, state.time_step, 1.0);
                let then = state.time + time_step;
                step(&model, &scheme, state.time, then, &mut state, &mut buffers);
            }
        };
        run(100);
        let mut allocations = || {
            let before = COUNT.load(Ordering::SeqCst);
            run(50);
            COUNT.load(Ordering::SeqCst) - before
        };
        let mut least = usize::MAX;
        for _ in 0..10 {
            least = least.min(allocations());
            if least == 0 {
                break;
            }
        }
        least
    })
}

/// A cube clamped at its base and pulled at its top by a table.
fn clamped() -> Problem {
    let mut problem = cube(4);
    problem.conditions.push(condition("base", face(2, 0.0), [Some(0.0); 3]));
    let mut pulled = condition("top", face(2, EDGE), [None, None, Some(0.1 * EDGE)]);
    pulled.amplitude = Amplitude::Table(vec![(0.0, 0.0), (0.1, 0.5), (1.0, 1.0)]);
    problem.conditions.push(pulled);
    gravity(&mut problem, Vector3::new(0.0, 1.0, 0.0));
    problem
}

/// More than 1024 points, so that there are several blocks.
fn finer(mut problem: Problem) -> Problem {
    problem.recipe.grid.cell = EDGE / 12.0;
    assert!(build(&problem).1.points.blocks.len() > 1);
    problem
}

fn falling(friction: Friction) -> Problem {
    let mut problem = cube(4);
    gravity(&mut problem, Vector3::new(1.0, 0.0, -9.81));
    problem.obstacles.push(floor(0.0, Vector3::z(), friction));
    problem
}

#[test]
fn a_step_with_direct_conditions_allocates_nothing() {
    assert_eq!(allocations(&clamped(), 1), 0);
}

#[test]
fn a_step_with_collocation_allocates_nothing() {
    assert_eq!(allocations(&collocated(clamped()), 1), 0);
}

#[test]
fn a_step_with_contact_allocates_nothing() {
    assert_eq!(allocations(&falling(Friction::Frictionless), 1), 0);
    assert_eq!(allocations(&falling(Friction::NoSlip), 1), 0);
    let mut pressed = falling(Friction::Coulomb(0.3));
    let way = RigidWay::Translation(Vector3::new(0.1, 0.0, 0.001));
    let amplitude = Amplitude::Linear { duration: 1.0 };
    pressed.obstacles[0].motions.push(RigidMotion { way, amplitude });
    assert_eq!(allocations(&pressed, 1), 0);
}

#[test]
fn a_step_over_several_blocks_allocates_nothing() {
    assert_eq!(allocations(&finer(clamped()), 1), 0);
    assert_eq!(allocations(&finer(collocated(clamped())), 1), 0);
}

#[test]
fn a_step_over_several_blocks_on_several_threads_allocates_nothing() {
    assert_eq!(allocations(&finer(clamped()), 3), 0);
}

/// More than 4096 nodes, which a step takes in chunks.
#[test]
fn a_step_of_many_nodes_on_several_threads_allocates_nothing() {
    let mut problem = clamped();
    problem.recipe.cloud = Cloud::Regular { spacing: EDGE / 17.0 };
    problem.recipe.grid.cell = EDGE / 20.0;
    assert!(build(&problem).1.positions.len() > 4096);
    assert_eq!(allocations(&problem, 3), 0);
}

#[test]
fn an_allocation_of_an_observed_thread_is_counted() {
    let _guard = MEASUREMENT.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    OBSERVED.set(true);
    let before = COUNT.load(Ordering::SeqCst);
    std::hint::black_box(vec![1.0; 10]);
    assert!(COUNT.load(Ordering::SeqCst) > before);
    OBSERVED.set(false);
}
