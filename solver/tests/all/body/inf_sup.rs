//! The inf-sup value of the pressures of patches, against dense matrices.

use crate::common::*;
use mtled::force::{OwnPressures, Workspace, linearise, linearised_stiffness_times};
use mtled::geometry::Selector;
use mtled::material::*;
use mtled::model::Model;
use mtled::motion::newton::inf_sup;
use mtled::problem::*;
use nalgebra::DMatrix;

fn constants() -> ElasticConstants {
    ElasticConstants::from_young_poisson(3000.0, 0.49).unwrap()
}

/// Projected, and nearly incompressible.
fn soft(mut problem: Problem) -> Problem {
    let law = NeoHookeanIsochoric::new(constants(), VolumetricTerm::Quadratic);
    problem.recipe.volumetric_projection = VolumetricProjection::Patches;
    collocated(with_law(problem, Law::NeoHookeanIsochoric(law)))
}

fn on_its_base(mut problem: Problem) -> Problem {
    let up = problem.dimension.components() - 1;
    problem.conditions.push(condition("base", face(up, 0.0), [Some(0.0); 3]));
    problem
}

fn held_all_around(mut problem: Problem) -> Problem {
    problem.conditions.push(condition("boundary", Selector::All, [Some(0.0); 3]));
    problem
}

/// All square roots of the eigenvalues of the Schur complement, from small to large, without those
/// of functions that no point of their patch sees.
fn dense(model: &Model) -> Vec<f64> {
    let (size, rest) = (model.size(), vec![0.0; model.size()]);
    let mut workspace = Workspace::new(&model.points);
    linearise(&model.points, &rest, &mut workspace);
    let own = OwnPressures::zero(&model.points, 2.0 / 3.0);
    let mut columns = Vec::new();
    let mut volumes = Vec::new();
    for i in 0..size {
        let (mut direction, mut product) = (rest.clone(), rest.clone());
        direction[i] = 1.0;
        linearised_stiffness_times(
            &model.points,
            &direction,
            Some(&own),
            &mut workspace,
            &mut product,
        );
        columns.extend(product);
        volumes.extend(workspace.patches().flat_map(|patch| patch.volume));
    }
    let stiffness = DMatrix::from_vec(size, size, columns);
    let gradient = DMatrix::from_vec(volumes.len() / size, size, volumes);
    let free = free_motions(model);
    let inner = free.transpose() * stiffness * &free;
    let rows = &gradient * &free;
    let shear = constants().shear_modulus;
    let solved = inner.cholesky().unwrap().solve(&rows.transpose());
    let schur = shear * &rows * solved;
    let seen = |value: &f64| *value > 1e-12;
    let values = schur.symmetric_eigen().eigenvalues;
    let mut values: Vec<f64> = values.iter().copied().filter(seen).map(f64::sqrt).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// An orthonormal basis of what the conditions leave free.
fn free_motions(model: &Model) -> DMatrix<f64> {
    let mut columns = Vec::new();
    for i in 0..model.size() {
        let mut motion = vec![0.0; model.size()];
        motion[i] = 1.0;
        model.constraints.project(0.0, &model.inertia, &mut motion, &mut Default::default());
        columns.extend(motion);
    }
    let images = DMatrix::from_vec(model.size(), model.size(), columns);
    let eigen = (&images * images.transpose()).symmetric_eigen();
    let kept: Vec<usize> = (0..model.size()).filter(|i| eigen.eigenvalues[*i] > 1e-9).collect();
    eigen.eigenvectors.select_columns(&kept)
}

#[test]
fn the_inf_sup_value_is_that_of_dense_matrices() {
    for problem in [
        on_its_base(soft(cube(2))),
        on_its_base(soft(jittered(cube(3), 0.2, 1))),
        on_its_base(soft(square(5))),
    ] {
        let (_, model) = build(&problem);
        let (found, all) = (inf_sup(&model).unwrap(), dense(&model));
        assert!(found.converged && found.pressures == all.len(), "{found:?}, {}", all.len());
        assert!((found.value / all[0] - 1.0).abs() < 0.02, "{found:?}, dense {:?}", &all[..3]);
    }
}

#[test]
fn a_constant_pressure_in_an_enclosed_body_does_not_count() {
    let (_, model) = build(&held_all_around(soft(cube(4))));
    let (found, all) = (inf_sup(&model).unwrap(), dense(&model));
    let first = all.iter().position(|value| *value > 0.02).unwrap();
    assert!(found.converged && (found.value / all[first] - 1.0).abs() < 0.05, "{found:?} {all:?}");
}

#[test]
fn bodies_without_projection_and_bodies_that_float_have_no_inf_sup_value() {
    let (_, model) = build(&soft(cube(2)));
    assert_eq!(inf_sup(&model), None);
    let mut plain = on_its_base(soft(cube(2)));
    plain.recipe.volumetric_projection = VolumetricProjection::None;
    assert_eq!(inf_sup(&build(&plain).1), None);
}

/// On clouds that nobody chose: random ones.
#[test]
fn the_inf_sup_value_does_not_depend_on_the_stiffness_and_is_moderate_on_random_clouds() {
    for seed in 0..10 {
        let problem = on_its_base(soft(jittered(cube(4), 0.3, seed)));
        let value = inf_sup(&build(&problem).1).unwrap().value;
        let stiffer = ElasticConstants::from_young_poisson(3e6, 0.49).unwrap();
        let law = NeoHookeanIsochoric::new(stiffer, VolumetricTerm::Quadratic);
        let other = with_law(problem, Law::NeoHookeanIsochoric(law));
        let other = inf_sup(&build(&other).1).unwrap().value;
        assert!((value / other - 1.0).abs() < 1e-6, "cloud {seed}: {value} and {other}");
        assert!((0.2..0.7).contains(&value), "cloud {seed}: {value}");
    }
}

#[test]
fn a_layer_whose_nodes_are_all_held_answers_no_pressure() {
    let mut problem = on_its_base(soft(cube(1)));
    problem.conditions.push(condition("top", face(2, EDGE), [Some(0.0); 3]));
    let found = inf_sup(&build(&problem).1).unwrap();
    assert!(found.value == 0.0 && found.converged, "{found:?}");
}
