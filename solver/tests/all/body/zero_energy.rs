//! Zero-energy modes: counted, located and refused.

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Discretisation;
use mtled::error::Error;
use mtled::geometry::Shape;
use mtled::model::Model;
use mtled::model::zero_energy::{
    ZERO_ENERGY_FRACTION, ZeroEnergyModes, refuse_zero_energy_modes, zero_energy_modes,
};
use mtled::problem::*;

/// Cells per spacing, volume fractions, consistent gradients.
fn with_cells(mut problem: Problem, cells: usize, ratio: f64) -> Problem {
    problem.recipe.grid.cell = EDGE / cells as f64 / ratio;
    problem.recipe.grid.inside = InsideRule::VolumeFraction;
    problem.recipe.gradients = Gradients::Consistent { tolerance: 1e-3 };
    problem.recipe.dilation = 1.8;
    problem
}

fn modes(problem: &Problem) -> ZeroEnergyModes {
    let (discretisation, model) = build(problem);
    zero_energy_modes(problem, &discretisation, &model).unwrap()
}

fn refusal(problem: &Problem) -> Error {
    let made = Discretisation::new(problem).and_then(|discretisation| {
        let model = Model::new(problem, &discretisation)?;
        refuse_zero_energy_modes(problem, &discretisation, &model)
    });
    made.expect_err("the recipe was not refused")
}

/// Eigenvalues of the tangent at rest, ascending.
fn tangent_eigenvalues(problem: &Problem) -> Vec<f64> {
    let (_, model) = build(problem);
    let tangent = dense_tangent(&model, &vec![0.0; model.size()], 1e-6 * EDGE);
    let mut eigenvalues = tangent.symmetric_eigenvalues().as_slice().to_vec();
    eigenvalues.sort_by(f64::total_cmp);
    eigenvalues
}

#[test]
fn the_default_recipe_has_no_zero_energy_modes_in_space_and_in_a_plane() {
    for problem in [cube(4), jittered(cube(4), 0.3, 1), square(8), jittered(square(8), 0.3, 2)] {
        let cells = if problem.dimension == Dimension::Three { 4 } else { 8 };
        let result = modes(&with_cells(problem, cells, 1.26));
        assert_eq!((result.count, result.at_least()), (Some(0), 0));
        assert!(result.least_captured[0].fraction > 0.2, "{:?}", result.least_captured);
    }
}

#[test]
fn motions_that_the_tangent_does_not_resist_are_in_the_count() {
    // A lattice with one point in the middle of each cell has enough strains, but
    // does not capture motions that alternate from node to node.
    for (problem, cells) in [(square(8), 8), (cube(4), 4)] {
        let mut problem = with_cells(problem, cells, 1.0);
        problem.recipe.gradients = Gradients::Plain;
        let eigenvalues = tangent_eigenvalues(&problem);
        let largest = eigenvalues[eigenvalues.len() - 1];
        let vanishing = eigenvalues.iter().filter(|&&value| value < 1e-8 * largest).count();
        let result = modes(&problem);
        assert!(vanishing > result.rigid, "{vanishing} vanish");
        assert!(result.count.unwrap() + result.rigid >= vanishing, "{result:?}, {vanishing}");
    }
}

#[test]
fn free_rigid_motions_are_counted() {
    let mut problem = with_cells(cube(4), 4, 1.26);
    assert_eq!(modes(&problem).rigid, 6);
    problem.conditions.push(condition("rollers", face(2, 0.0), [None, None, Some(0.0)]));
    assert_eq!(modes(&problem).rigid, 3);
    problem.conditions.push(condition("bonded", face(2, EDGE), [Some(0.0); 3]));
    for problem in [problem.clone(), collocated(problem)] {
        assert_eq!(modes(&problem).rigid, 0);
    }
    assert_eq!(modes(&with_cells(square(8), 8, 1.26)).rigid, 3);
}

#[test]
fn fewer_strains_than_motions_are_refused_with_the_number_of_modes() {
    let problem = with_cells(cube(5), 5, 0.7);
    let Error::TooFewPoints { points, strains, nodes, constrained, modes } = refusal(&problem)
    else {
        panic!()
    };
    assert_eq!((points, strains, nodes, constrained), (64, 6, 216, 0));
    assert_eq!(modes, 3 * 216 - 6 - 6 * 64);
}

#[test]
fn zero_energy_modes_with_enough_strains_are_refused_with_the_worst_node() {
    let problem = with_cells(cube(5), 5, 1.0);
    let Error::ZeroEnergyModes { points, nodes, modes, fraction, node, position, .. } =
        refusal(&problem)
    else {
        panic!()
    };
    assert_eq!((points, nodes), (125, 216));
    assert!(modes > 20 && fraction < ZERO_ENERGY_FRACTION, "{modes} modes, {fraction}");
    assert_eq!(build(&problem).1.positions[node], position);
}

#[test]
fn conditions_that_constrain_zero_energy_modes_reduce_their_count() {
    let free = with_cells(cube(5), 5, 1.0);
    let mut constrained = free.clone();
    let mut all = condition("all", face(0, 0.0), [Some(0.0); 3]);
    all.part = mtled::geometry::Selector::All;
    constrained.conditions.push(all);
    let (free, direct) = (modes(&free), modes(&constrained));
    let field = modes(&collocated(constrained));
    assert!(direct.count < free.count && field.count < free.count);
    assert_eq!(direct.count, Some(0));
}

#[test]
fn the_least_captured_motions_agree_with_the_count() {
    for (ratio, jitter) in [(0.9, 0.3), (1.0, 0.0), (1.0, 0.3), (1.1, 0.3), (1.26, 0.3)] {
        let mut problem = cube(5);
        if jitter > 0.0 {
            problem = jittered(problem, jitter, 1);
        }
        let result = modes(&with_cells(problem, 5, ratio));
        let below = result
            .least_captured
            .iter()
            .filter(|motion| motion.fraction < ZERO_ENERGY_FRACTION)
            .count();
        assert_eq!(below > 0, result.count.unwrap() > 0, "{result:?}");
        assert!(below <= result.count.unwrap());
    }
}

#[test]
fn a_plate_one_spacing_thick_has_no_zero_energy_modes_and_sound_supports() {
    for jitter in [0.0, 0.3] {
        let mut problem = cube(6);
        if jitter > 0.0 {
            problem = jittered(problem, jitter, 4);
        }
        problem = with_cells(problem, 6, 1.26);
        let top = Vector3::new(EDGE, EDGE, EDGE / 6.0);
        problem.body = Shape::Box { min: Vector3::zeros(), max: top };
        let (discretisation, _) = build(&problem);
        assert!(discretisation.cloud.on_boundary.iter().all(|&on_boundary| on_boundary));
        assert!(discretisation.worst_condition < 100.0, "{}", discretisation.worst_condition);
        assert_eq!(modes(&problem).count, Some(0));
    }
}

/// A cube with nodes at a third of their distance in a ball about its middle.
fn graded() -> Problem {
    let mut problem = with_cells(cube(6), 6, 1.26);
    let middle = Shape::Sphere { centre: Vector3::repeat(0.5 * EDGE), radius: 0.15 * EDGE };
    problem.recipe.cloud = Cloud::Graded {
        spacing: EDGE / 6.0,
        refinements: vec![Refinement {
            part: mtled::geometry::Selector::Inside { shape: middle, tolerance: 0.0 },
            size: EDGE / 14.0,
        }],
        growth: 0.25,
        seed: 0,
    };
    problem
}

#[test]
fn cells_that_do_not_follow_refined_nodes_are_refused_where_the_body_has_points_enough() {
    let mut problem = graded();
    // Many cells, but far from the refined nodes.
    let corner = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.4 * EDGE) };
    problem.recipe.grid.refinements = vec![Refinement {
        part: mtled::geometry::Selector::Inside { shape: corner, tolerance: 0.0 },
        size: EDGE / 30.0,
    }];
    let Error::ZeroEnergyModes { points, nodes, fraction, density, position, .. } =
        refusal(&problem)
    else {
        panic!()
    };
    assert!(points as f64 > 1.1 * nodes as f64, "{points} points, {nodes} nodes");
    assert!(fraction < ZERO_ENERGY_FRACTION && density < 0.5, "{fraction}, {density}");
    assert!((position - Vector3::repeat(0.5 * EDGE)).norm() < 0.3 * EDGE, "{position}");
}

#[test]
fn cells_that_follow_refined_nodes_leave_no_zero_energy_modes() {
    let mut problem = graded();
    problem.recipe.grid = BackgroundGrid::following(1.26);
    let (discretisation, model) = build(&problem);
    refuse_zero_energy_modes(&problem, &discretisation, &model).unwrap();
    let result = zero_energy_modes(&problem, &discretisation, &model).unwrap();
    assert_eq!(result.at_least(), 0);
    assert!(result.least_captured[0].fraction > 0.2, "{:?}", result.least_captured);
    let (points, nodes) = (discretisation.supports.len(), model.positions.len());
    assert!(2 * points < 9 * nodes, "{points} points for {nodes} nodes");
}

#[test]
fn given_nodes_are_followed_without_a_length_of_the_cells() {
    let (cloud, _) = build(&graded());
    let mut problem = graded();
    problem.recipe.cloud = Cloud::Given { nodes: cloud.cloud.positions };
    problem.recipe.grid = BackgroundGrid::following(1.26);
    let (discretisation, model) = build(&problem);
    refuse_zero_energy_modes(&problem, &discretisation, &model).unwrap();
}
