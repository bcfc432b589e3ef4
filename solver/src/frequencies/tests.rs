use super::*;
use crate::algebra::tensor::Vector3;
use crate::discretisation::Discretisation;
use crate::geometry::{Extent, Selector, Shape};
use crate::material::{ElasticConstants, Law, LinearElastic, Material};
use crate::problem::{Amplitude, Dimension, EssentialCondition, MassRule, Prescribed, Recipe};
use nalgebra::DMatrix;

const EDGE: f64 = 0.1;

/// A free cube of E = 3 kPa and 1000 kg/m³.
fn cube(poisson_ratio: f64, spacing: f64) -> Problem {
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(EDGE) };
    let constants = ElasticConstants::from_young_poisson(3000.0, poisson_ratio).unwrap();
    let law = Law::LinearElastic(LinearElastic::new(constants));
    Problem::new(body, Material { density: 1000.0, law }, Recipe::with_spacing(spacing))
}

fn plane(point: Vector3, normal: Vector3) -> Selector {
    Selector::Plane { point, normal, tolerance: 1e-6 }
}

fn held(part: Selector, components: [Option<f64>; 3]) -> EssentialCondition {
    EssentialCondition {
        name: "foot".into(),
        extent: Extent::Surface,
        part,
        prescribed: Prescribed::Displacement(components),
        amplitude: Amplitude::Constant,
        release: None,
    }
}

fn search(problem: &Problem, count: usize, kind: MassKind) -> Result<NaturalModes, Error> {
    let rest = body_at_rest(problem);
    let discretisation = Discretisation::new(&rest)?;
    let model = Model::new(&rest, &discretisation)?;
    NaturalModes::find(&rest, &discretisation, &model, (count, kind), &mut |_| true)
}

fn found(problem: &Problem, count: usize) -> NaturalModes {
    search(problem, count, MassKind::Consistent).unwrap()
}

fn frequencies(found: &NaturalModes) -> Vec<f64> {
    found.modes.iter().map(|mode| mode.frequency).collect()
}

/// All frequencies other than 0 by dense matrices, in ascending order \[Hz\].
fn dense(problem: &Problem) -> Vec<f64> {
    let rest = body_at_rest(problem);
    let discretisation = Discretisation::new(&rest).unwrap();
    let model = Model::new(&rest, &discretisation).unwrap();
    let masses = masses(&discretisation.quadrature, &[1000.0]).collect();
    let places = vec![MassPlaces { rows: &discretisation.supports, masses }];
    let mut go_on = |_| true;
    let mut vibration = Vibration::new(&model, places, &mut go_on);
    let n = vibration.size();
    let unit = |i: usize| (0..n).map(|k| f64::from(k == i)).collect::<Vec<f64>>();
    let space = |i: usize| {
        let mut vector = unit(i);
        vibration.project(&mut vector);
        vector
    };
    let space = DMatrix::from_vec(n, n, (0..n).flat_map(space).collect());
    let svd = space.svd(true, false);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
    let basis = svd.u.unwrap().select_columns(&order[..vibration.dimension()]);
    let stiffness = (0..n).flat_map(|i| vibration.stiffness(&unit(i))).collect();
    let mass = (0..n).flat_map(|i| vibration.mass(&unit(i))).collect();
    let [stiffness, mass] = [stiffness, mass].map(|values| {
        let inner = basis.transpose() * DMatrix::from_vec(n, n, values) * &basis;
        0.5 * (&inner + inner.transpose())
    });
    let inverse = mass.cholesky().unwrap().l().try_inverse().unwrap();
    let form = &inverse * stiffness * inverse.transpose();
    let form = 0.5 * (&form + form.transpose());
    let mut values: Vec<f64> = form.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values.into_iter().map(|value| value.sqrt() / TAU).collect()
}

/// Bodies of few nodes: free, held, held at an edge, in a plane, in two pieces.
fn bodies() -> Vec<(&'static str, Problem, usize)> {
    let foot = plane(Vector3::zeros(), Vector3::z());
    let mut standing = cube(0.45, EDGE / 4.0);
    standing.conditions = vec![held(foot.clone(), [Some(0.01), Some(0.0), Some(0.0)])];
    let mut sliding = cube(0.3, EDGE / 4.0);
    sliding.conditions = vec![held(foot.clone(), [None, None, Some(0.0)])];
    let mut hinged = cube(0.3, EDGE / 4.0);
    let line = Selector::Intersection(vec![foot, plane(Vector3::zeros(), Vector3::x())]);
    hinged.conditions = vec![held(line, [Some(0.0); 3])];
    let mut flat = cube(0.3, EDGE / 6.0);
    flat.dimension = Dimension::PlaneStrain { thickness: 0.02, z: 0.0 };
    let mut two = cube(0.3, EDGE / 4.0);
    let further = Vector3::x() * (3.0 * EDGE);
    let other = Shape::Box { min: further, max: further + Vector3::new(0.12, EDGE, 0.08) };
    two.body = Shape::Union(vec![two.body.clone(), other]);
    vec![
        ("free", cube(0.3, EDGE / 4.0), 6),
        ("soft in shear", cube(0.49, EDGE / 4.0), 6),
        ("nearly incompressible", cube(0.499, EDGE / 4.0), 6),
        ("standing", standing, 0),
        ("sliding", sliding, 3),
        ("hinged", hinged, 1),
        ("flat", flat, 3),
        ("two pieces", two, 12),
    ]
}

#[test]
fn the_lowest_frequencies_and_the_rigid_motions_are_those_of_dense_matrices() {
    for (name, problem, rigid) in bodies() {
        let found = found(&problem, 12);
        assert_eq!(found.rigid_motions, rigid, "{name}");
        assert!(found.converged(), "{name}");
        for (mode, exact) in found.modes.iter().zip(dense(&problem)) {
            let error = (mode.frequency / exact - 1.0).abs();
            assert!(error <= 0.5 * mode.residual.max(1e-9), "{name}: {error} {}", mode.residual);
        }
    }
}

#[test]
fn frequencies_of_a_cube_that_are_equal_by_its_symmetry_are_all_found() {
    for count in [1, 2, 4, 5, 11] {
        let all = frequencies(&found(&cube(0.3, EDGE / 4.0), count));
        let groups: Vec<usize> =
            all.chunk_by(|a, b| (a / b - 1.0).abs() < 1e-6).map(<[f64]>::len).collect();
        let expected: &[usize] = match count {
            1 => &[1],
            2 => &[2],
            4 => &[2, 2],
            5 => &[2, 3],
            _ => &[2, 3, 3, 1, 2],
        };
        assert_eq!(groups, expected, "{all:?}");
    }
}

#[test]
fn all_frequencies_of_a_body_of_few_nodes_are_found() {
    let mut problem = cube(0.3, EDGE / 3.0);
    problem.conditions = vec![held(plane(Vector3::zeros(), Vector3::z()), [Some(0.0); 3])];
    let exact = dense(&problem);
    let found = found(&problem, exact.len());
    for (mode, exact) in found.modes.iter().zip(&exact) {
        assert!((mode.frequency / exact - 1.0).abs() < 1e-9, "{mode:?} {exact}");
    }
    let error = search(&problem, exact.len() + 1, MassKind::Consistent).unwrap_err().to_string();
    assert!(error.starts_with("145 frequencies are asked for, and the body has 144"), "{error}");
    assert!(matches!(search(&problem, 0, MassKind::Lumped), Err(Error::NoFrequencies)));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let modes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| found(&cube(0.3, EDGE / 5.0), 4));
        found.modes.into_iter().map(|mode| (mode.frequency, mode.residual, mode.motion)).collect()
    };
    let one: Vec<_> = modes(1);
    assert_eq!(one, modes(3));
}

#[test]
fn row_sums_make_frequencies_lower_and_both_masses_come_to_the_same() {
    let part = |spacings: f64, mass: MassRule| {
        let mut problem = cube(0.3, EDGE / spacings);
        problem.recipe.mass = mass;
        let lumped = search(&problem, 1, MassKind::Lumped).unwrap();
        1.0 - lumped.modes[0].frequency / found(&problem, 1).modes[0].frequency
    };
    let (coarse, fine) = (part(4.0, MassRule::RowSum), part(8.0, MassRule::RowSum));
    assert!(coarse > 0.05 && fine > 0.0, "{coarse} {fine}");
    assert!((coarse / fine).log2() > 1.7, "{coarse} {fine}");
    // With the moments of inertia they are a third as far off.
    assert!(part(8.0, MassRule::MomentsOfFreeBodies).abs() < 0.5 * fine);
}

#[test]
fn modes_have_the_mass_of_one_kilogram_and_a_positive_largest_component() {
    let found = found(&cube(0.3, EDGE / 4.0), 3);
    for mode in &found.modes {
        let largest = mode.motion.iter().fold(0.0f64, |a, u| a.max(u.abs()));
        let first = mode.motion.iter().find(|u| u.abs() >= 0.99 * largest).unwrap();
        assert!(*first > 0.0);
        // 1 kg moves by about 1 m.
        assert!(largest > 1.0 && largest < 10.0, "{largest}");
    }
}

#[test]
fn a_search_that_is_ended_has_no_modes() {
    let rest = body_at_rest(&cube(0.3, EDGE / 4.0));
    let discretisation = Discretisation::new(&rest).unwrap();
    let model = Model::new(&rest, &discretisation).unwrap();
    let asked = (4, MassKind::Consistent);
    let found = NaturalModes::find(&rest, &discretisation, &model, asked, &mut |_| false).unwrap();
    assert!(found.stopped && found.modes.is_empty() && !found.converged());
    let relaxed = Model::new(&cube(0.3, EDGE / 4.0), &discretisation).unwrap();
    let refused =
        NaturalModes::find(&rest, &discretisation, &relaxed, asked, &mut |_| true).unwrap_err();
    assert!(matches!(refused, Error::FictitiousMass));
}

/// A box without symmetry, in units of so many to the metre, moved, its axes exchanged, and in two
/// halves of the same material.
fn brick(unit: f64, by: &Vector3, exchanged: bool, halves: bool) -> Problem {
    let turned = |v: Vector3| if exchanged { Vector3::new(v.z, v.x, v.y) } else { v };
    let (min, max) = (Vector3::zeros(), Vector3::new(0.1, 0.08, 0.06));
    let mut problem = cube(0.3, 0.02 * unit);
    problem.body = Shape::Box { min: unit * (turned(min) + by), max: unit * (turned(max) + by) };
    // The same body: Pa = kg/(m s²), and the kilogram and the second stay.
    let constants = ElasticConstants::from_young_poisson(3000.0 / unit, 0.3).unwrap();
    let law = Law::LinearElastic(LinearElastic::new(constants));
    problem.regions[0].material = Material { density: 1000.0 / unit.powi(3), law };
    let foot = plane(unit * by, turned(Vector3::z()));
    problem.conditions = vec![held(foot, [Some(0.0); 3])];
    if halves {
        let mut half = problem.regions[0].clone();
        half.name = "half".into();
        let max = unit * (turned(Vector3::new(0.05, 0.08, 0.06)) + by);
        let shape = Shape::Box { min: unit * (turned(min) + by), max };
        half.part = Selector::Inside { shape, tolerance: 0.0 };
        problem.regions.insert(0, half);
    }
    problem
}

#[test]
fn other_units_places_and_axes_leave_the_frequencies_and_equal_halves_change_quadrature_alone() {
    let here = Vector3::zeros();
    let own = frequencies(&found(&brick(1.0, &here, false, false), 6));
    let away = Vector3::new(0.3, -7.0, 2.0);
    for (what, other) in [
        ("units", brick(1000.0, &here, false, false)),
        ("place", brick(1.0, &away, false, false)),
        ("axes", brick(1.0, &here, true, false)),
    ] {
        let other = frequencies(&found(&other, 6));
        for (own, other) in own.iter().zip(other) {
            assert!((own / other - 1.0).abs() < 1e-9, "{what}: {own} {other}");
        }
    }
    // The border of the halves cuts cells: 192 quadrature points instead of 168.
    let halves = frequencies(&found(&brick(1.0, &here, false, true), 6));
    for (own, other) in own.iter().zip(halves) {
        assert!((own / other - 1.0).abs() < 3e-3, "halves: {own} {other}");
    }
}
