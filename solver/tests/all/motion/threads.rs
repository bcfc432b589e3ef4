//! The same bits on any number of threads.

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::motion::observe::Unobserved;
use mtled::motion::simulate::simulate;
use mtled::motion::state::State;
use mtled::problem::{Cloud, Problem};

const THREADS: [usize; 5] = [1, 2, 3, 4, 8];

/// Two materials, jittered nodes, more than 4096 points in several blocks.
fn large_problem() -> Problem {
    let mut problem = jittered(with_stiff_half(cube(8), neo_hookean(9000.0, 0.4)), 0.2, 3);
    problem.recipe.grid.cell = EDGE / 17.0;
    problem.conditions.push(condition("base", face(2, 0.0), [Some(0.0); 3]));
    gravity(&mut problem, Vector3::new(3.0, 0.0, -9.81));
    problem
}

fn on_each_pool(run: impl Fn() -> Vec<u64> + Sync) {
    let mut first: Option<Vec<u64>> = None;
    for threads in THREADS {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let bits = pool.install(&run);
        let same = first.get_or_insert_with(|| bits.clone()) == &bits;
        assert!(same, "{threads} threads give other bits than {}", THREADS[0]);
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn the_internal_force_has_the_same_bits_on_any_number_of_threads() {
    let (discretisation, model) = build(&large_problem());
    assert!(discretisation.supports.len() > 4096 && model.points.blocks.len() > 2);
    on_each_pool(|| bits(&forces(&model, &noise(&model, 1e-3, 1))));
}

/// More than 4096 nodes, which a step takes in chunks on all threads.
#[test]
fn steps_of_many_nodes_have_the_same_bits_on_any_number_of_threads() {
    let mut problem = large_problem();
    problem.recipe.cloud = Cloud::Jittered { spacing: EDGE / 17.0, jitter: 0.2, seed: 3 };
    problem.recipe.grid.cell = EDGE / 20.0;
    let (_, model) = build(&problem);
    assert!(model.positions.len() > 4096, "{}", model.positions.len());
    on_each_pool(|| {
        let mut state = State::new(&model);
        let motion = dynamic(2e-3, 1e-4, 0.5);
        simulate(&model, &motion, &mut state, &mut Unobserved).unwrap();
        bits(&state.displacement)
    });
}

#[test]
fn a_whole_run_with_its_set_up_has_the_same_bits_on_any_number_of_threads() {
    let problem = collocated(large_problem());
    on_each_pool(|| {
        let (_, model) = build(&problem);
        let mut state = State::new(&model);
        let motion = dynamic(0.02, 1e-3, 0.5);
        simulate(&model, &motion, &mut state, &mut Unobserved).unwrap();
        bits(&state.displacement)
    });
}
