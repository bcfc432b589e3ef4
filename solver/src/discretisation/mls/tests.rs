#![allow(non_snake_case)]

use super::*;
use crate::algebra::tensor::Vector3;
use crate::geometry::{Selector, Shape};
use crate::material::{ElasticConstants, Law, LinearElastic, Material};
use crate::problem::{Basis, Dimension, Region, WeightFunction};
use proptest::prelude::*;

const H: f64 = 0.1;

/// A jittered lattice of 6³ nodes (6² in a plane) whose middle is at `shift`.
fn approximation(
    dimension: Dimension,
    basis: Basis,
    weight_function: WeightFunction,
    jitter: &[f64],
    shift: Vector3,
) -> Approximation {
    let layers = if dimension.components() == 2 { 1 } else { 6 };
    let mut nodes = Vec::new();
    for k in 0..layers {
        for j in 0..6 {
            for i in 0..6 {
                let mut X =
                    Vector3::new(i as f64, j as f64, if layers == 1 { 0.0 } else { k as f64 }) * H;
                for c in 0..dimension.components() {
                    X[c] += H * jitter[(3 * nodes.len() + c) % jitter.len()];
                }
                nodes.push(X + shift);
            }
        }
    }
    let dilation = if basis == Basis::Linear { 1.9 } else { 2.7 };
    let radius = vec![dilation * H; nodes.len()];
    Approximation::new(nodes, radius, basis, weight_function, &dimension)
}

const PLANE: Dimension = Dimension::PlaneStrain { thickness: 1.0, z: 0.0 };

/// Every combination that the scene format offers.
fn kinds() -> Vec<(Dimension, Basis, WeightFunction)> {
    let mut kinds = Vec::new();
    for dimension in [PLANE, Dimension::Three] {
        for basis in [
            Basis::Linear,
            Basis::Quadratic,
            Basis::ModifiedQuadratic { regularisation: 1e-7 },
            Basis::ModifiedQuadratic { regularisation: 1e-2 },
        ] {
            for weight_function in WeightFunction::ALL {
                kinds.push((dimension, basis, weight_function));
            }
        }
    }
    kinds
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn polynomials_of_the_basis_are_reproduced_with_their_gradients(
        jitter in prop::collection::vec(-0.3..0.3f64, 101),
        at in prop::array::uniform3(0.05..0.45f64),
        far in 0.0..10.0f64,
    ) {
        for (dimension, basis, weight_function) in kinds() {
            let shift = Vector3::new(far, -far, 0.5 * far);
            let plane = dimension.components() == 2;
            let shift = if plane { Vector3::new(far, -far, 0.0) } else { shift };
            let a = approximation(dimension, basis, weight_function, &jitter, shift);
            let mut X = Vector3::from(at) + shift;
            if plane { X.z = 0.0; }
            let s = a.evaluate(&X).unwrap();
            let sum: f64 = s.phi.iter().sum();
            prop_assert!((sum - 1.0).abs() < 1e-12);
            let tolerance = if basis == Basis::Quadratic { 1e-11 } else { 1e-12 };
            for k in 0..dimension.components() {
                let value: f64 = s.nodes.iter().zip(&s.phi)
                    .map(|(&n, phi)| (a.nodes[n as usize][k] - X[k]) * phi).sum();
                prop_assert!(value.abs() < tolerance);
                let slope: Vector3 = s.nodes.iter().zip(&s.grad_phi)
                    .map(|(&n, g)| g * (a.nodes[n as usize][k] - X[k])).sum();
                let mut unit = Vector3::zeros();
                unit[k] = 1.0;
                prop_assert!((slope - unit).norm() < tolerance, "{slope}");
                if basis == Basis::Quadratic {
                    let square: Vector3 = s.nodes.iter().zip(&s.grad_phi)
                        .map(|(&n, g)| g * (a.nodes[n as usize][k] - X[k]).powi(2)).sum();
                    prop_assert!(square.norm() < tolerance);
                }
            }
        }
    }

    #[test]
    fn gradients_are_those_of_the_values(
        jitter in prop::collection::vec(-0.3..0.3f64, 101),
        at in prop::array::uniform3(0.1..0.4f64),
    ) {
        for (dimension, basis, weight_function) in kinds() {
            let a = approximation(dimension, basis, weight_function, &jitter, Vector3::zeros());
            let mut X = Vector3::from(at);
            if dimension.components() == 2 { X.z = 0.0; }
            let s = a.evaluate(&X).unwrap();
            let step = 1e-6 * H;
            for k in 0..dimension.components() {
                let (mut plus, mut minus) = (X, X);
                plus[k] += step;
                minus[k] -= step;
                let (plus, minus) = (a.evaluate(&plus).unwrap(), a.evaluate(&minus).unwrap());
                prop_assume!(plus.nodes == s.nodes && minus.nodes == s.nodes);
                prop_assume!(plus.enlargement == 1.0 && minus.enlargement == 1.0);
                for i in 0..s.nodes.len() {
                    let difference = (plus.phi[i] - minus.phi[i]) / (2.0 * step);
                    prop_assert!((difference - s.grad_phi[i][k]).abs() < 1e-5 / H);
                }
            }
        }
    }
}

#[test]
fn a_plane_cloud_does_not_support_a_basis_in_space() {
    let jitter = [0.0];
    let flat = approximation(
        PLANE,
        Basis::Linear,
        WeightFunction::QuarticSpline,
        &jitter,
        Vector3::zeros(),
    );
    let radius = vec![1.9 * H; flat.nodes.len()];
    let solid = Approximation::new(
        flat.nodes,
        radius,
        Basis::Linear,
        WeightFunction::QuarticSpline,
        &Dimension::Three,
    );
    let poor = solid.evaluate(&Vector3::new(0.25, 0.25, 0.0)).unwrap_err();
    assert!(poor.condition > 1e4);
}

#[test]
fn a_far_point_has_no_support() {
    let a = approximation(
        Dimension::Three,
        Basis::Linear,
        WeightFunction::CubicSpline,
        &[0.0],
        Vector3::zeros(),
    );
    assert_eq!(a.evaluate(&Vector3::new(5.0, 0.0, 0.0)).unwrap_err().support_size, 0);
}

/// Σ φ_a (X_a − X)_i (X_a − X)_j /H² over the largest second moment: 0 where
/// quadratic fields are reproduced.
fn quadratic_error(a: &Approximation, X: &Vector3) -> f64 {
    let support = a.evaluate(X).unwrap();
    let mut sum = Vector3::zeros();
    for (&node, phi) in support.nodes.iter().zip(&support.phi) {
        let offset = (a.nodes[node as usize] - X) / H;
        sum += offset.component_mul(&offset) * *phi;
    }
    sum.amax()
}

fn modified(regularisation: f64, dilation: f64, jitter: &[f64]) -> Approximation {
    let basis = Basis::ModifiedQuadratic { regularisation };
    let plain = approximation(
        Dimension::Three,
        Basis::Quadratic,
        WeightFunction::QuarticSpline,
        jitter,
        Vector3::zeros(),
    );
    let radius = vec![dilation * H; plain.nodes.len()];
    Approximation::new(plain.nodes, radius, basis, WeightFunction::QuarticSpline, &Dimension::Three)
}

#[test]
fn the_regularised_quadratic_basis_needs_no_larger_radius_on_a_lattice_at_dilation_two() {
    let mut poor = 0;
    for index in 0..512 {
        let at = Vector3::new((index % 8) as f64, (index / 8 % 8) as f64, (index / 64) as f64);
        let X = (at + Vector3::new(0.13, 0.31, 0.22)) * (5.0 / 8.0 * H);
        let mut basis = modified(1e-7, 2.0, &[0.0]);
        let support = basis.evaluate(&X).unwrap();
        assert!(support.enlargement == 1.0 && support.condition < 1e3, "{X} {support:?}");
        basis.basis = Basis::Quadratic;
        poor += basis.evaluate(&X).map_or(true, |support| support.enlargement > 1.0) as usize;
    }
    assert!(poor > 10, "the plain quadratic basis is poor at {poor} of 512 points only");
}

#[test]
fn the_quadratic_error_of_the_regularised_basis_is_proportional_to_it() {
    let jitter = [0.21, -0.13, 0.3, -0.27, 0.08, 0.17, -0.3, 0.02, -0.19, 0.25, 0.11];
    let X = Vector3::new(0.23, 0.27, 0.24);
    let error = |mu: f64| quadratic_error(&modified(mu, 2.7, &jitter), &X);
    let errors = [1e-2, 1e-4, 1e-6].map(error);
    assert!(errors[0] < 0.1, "{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((50.0..150.0).contains(&ratio), "{errors:?}");
    }
}

/// A lattice that sees all, and one whose half below `border` is ten times stiffer.
fn of_two_halves(border: f64) -> [Approximation; 2] {
    let plain = approximation(
        Dimension::Three,
        Basis::Linear,
        WeightFunction::QuarticSpline,
        &[0.1, -0.2, 0.15, 0.05, -0.1],
        Vector3::zeros(),
    );
    let half = |side: f64| Selector::Inside {
        shape: Shape::HalfSpace { point: Vector3::x() * border, normal: Vector3::x() * side },
        tolerance: 0.0,
    };
    let region = |part: Selector, young_modulus: f64| {
        let constants = ElasticConstants::from_young_poisson(young_modulus, 0.3).unwrap();
        let law = Law::LinearElastic(LinearElastic::new(constants));
        Region::new("half", part, Material { density: 1.0, law })
    };
    let regions = [region(half(1.0), 10.0), region(half(-1.0), 1.0)];
    let stiffness = Stiffness::new(&regions, false).unwrap();
    let all = Shape::Box { min: Vector3::repeat(-1.0), max: Vector3::repeat(2.0) };
    let sided = plain.clone().with_sides(stiffness, &all, 1.9);
    [plain, sided]
}

#[test]
fn points_of_the_stiffer_side_see_their_own_nodes_and_reproduce_linear_fields_as_all_do() {
    let border = 0.26;
    let [plain, sided] = of_two_halves(border);
    let field = |X: &Vector3| 0.3 + X.x - 2.0 * X.y + 0.5 * X.z;
    for x in [0.12, 0.2, 0.25, 0.27, 0.33, 0.4] {
        let X = Vector3::new(x, 0.24, 0.27);
        let (support, all) = (sided.evaluate(&X).unwrap(), plain.evaluate(&X).unwrap());
        let softer = |node: &&u32| plain.nodes[**node as usize].x > border;
        if x < border {
            assert_eq!(support.nodes.iter().filter(softer).count(), 0)
        } else {
            assert_eq!(support.phi, all.phi)
        }
        let values = support.nodes.iter().map(|&node| field(&plain.nodes[node as usize]));
        let value: f64 = values.zip(&support.phi).map(|(value, phi)| value * phi).sum();
        assert!((value - field(&X)).abs() < 1e-12, "{value} at {X}");
    }
}

#[test]
fn a_place_on_a_border_is_of_the_stiffer_side_whatever_round_off_says() {
    let border = 0.26;
    let [_, sided] = of_two_halves(border);
    let at = |x: f64| sided.evaluate(&Vector3::new(x, 0.24, 0.27)).unwrap();
    let [stiff, soft] = [at(border - 1e-15), at(border + 1e-15)];
    assert_eq!(stiff.nodes, soft.nodes);
    assert!(stiff.nodes.len() < at(border + 1e-4).nodes.len());
}
