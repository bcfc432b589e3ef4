#![allow(non_snake_case)]

use super::super::node_fields::NodeFields;
use super::BodyFrames;
use crate::run::record::Frame;
use crate::specimens::simple::{free_body, recipe, sphere_shape, tissue};
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::{Selector, Shape};
use mtled::material::{ElasticConstants, Law, Material, NeoHookeanLogJ};
use mtled::problem::{Dimension, Region};

const H: [[f64; 3]; 3] = [[0.1, 0.05, 0.0], [-0.02, -0.1, 0.0], [0.0, 0.0, 0.2]];

fn gradient(dimension: &Dimension) -> Matrix3 {
    let mut gradient = Matrix3::from_fn(|i, j| H[i][j]);
    if dimension.components() == 2 {
        gradient[(2, 2)] = 0.0;
    }
    gradient
}

/// A ball or a disc with the nodal parameters of an affine displacement, with parts of other
/// materials first.
fn stretched(dimension: Dimension, parts: Vec<Region>) -> (Simulation, Frame) {
    let recipe = recipe(0.02, 0.2, 7);
    let mut problem = free_body(dimension, sphere_shape(), tissue(0.3).unwrap(), recipe);
    problem.regions.splice(0..0, parts);
    let simulation = Simulation::with_any_recipe(&problem).unwrap();
    let components = dimension.components();
    let moved = |X: &Vector3| <[f64; 3]>::from(gradient(&dimension) * X);
    let positions = simulation.discretisation.cloud.positions.iter();
    let displacement =
        positions.flat_map(|X| moved(X).into_iter().take(components)).collect::<Vec<_>>();
    let frame =
        Frame { step: 0, time: 0.0, displacement, contact: Vec::new(), extra_stress: Vec::new() };
    (simulation, frame)
}

#[test]
fn an_affine_displacement_and_its_strains_are_exact_at_the_vertices() {
    for dimension in [Dimension::Three, Dimension::PlaneStrain { thickness: 1.0, z: 0.05 }] {
        let (simulation, frame) = stretched(dimension, Vec::new());
        let fields = NodeFields::new(&simulation, &frame, None).unwrap();
        let body = BodyFrames::new(&simulation).unwrap().unwrap();
        let written = body.frame(&simulation, &frame, &fields, None, Vec::new());
        let of = |name: &str| {
            let array = written.point_data.iter().find(|array| array.name == name);
            array.unwrap_or_else(|| panic!("no {name}")).values.clone()
        };
        let gradient = gradient(&dimension);
        for (X, u) in written.points.iter().zip(of("displacement").chunks(3)) {
            let exact = gradient * Vector3::from(*X);
            assert!((Vector3::new(u[0], u[1], u[2]) - exact).norm() < 1e-12);
        }
        let F = gradient + Matrix3::identity();
        assert!(of("J").iter().all(|J| (J - F.determinant()).abs() < 1e-9));
        let strain = 0.5 * (F.transpose() * F - Matrix3::identity());
        let mut exact: [f64; 3] = strain.symmetric_eigenvalues().into();
        exact.sort_by(|a, b| b.total_cmp(a));
        for values in of("principal_green_lagrange_strain").chunks(3) {
            assert!(values.iter().zip(exact).all(|(value, exact)| (value - exact).abs() < 1e-9));
        }
        let stresses = of("von_mises_stress");
        assert!(stresses.iter().all(|s| (s / stresses[0] - 1.0).abs() < 1e-9 && *s > 0.0));
    }
}

#[test]
fn stress_at_each_vertex_is_that_of_the_region_that_it_is_written_for() {
    let gradient = gradient(&Dimension::Three);
    let core = |young_modulus: f64, radius: f64| {
        let constants = ElasticConstants::from_young_poisson(young_modulus, 0.3).unwrap();
        let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
        let Shape::Sphere { centre, .. } = sphere_shape() else { panic!("no ball") };
        let part = Selector::Inside { shape: Shape::Sphere { centre, radius }, tolerance: 0.0 };
        Region::new("core", part, Material { density: 1000.0, law })
    };
    for young_modulus in [10.0, 3.0e6] {
        let parts = vec![core(young_modulus, 0.025)];
        let (simulation, frame) = stretched(Dimension::Three, parts);
        let fields = NodeFields::new(&simulation, &frame, None).unwrap();
        let body = BodyFrames::new(&simulation).unwrap().unwrap();
        let written = body.frame(&simulation, &frame, &fields, None, Vec::new());
        let stress = written.point_data.iter().find(|array| array.name == "cauchy_stress").unwrap();
        let mut counts = [0; 2];
        for (values, &owner) in stress.values.chunks(9).zip(&body.owners) {
            let law = simulation.problem.regions[owner as usize].material.law;
            let exact = law.cauchy(&(gradient + Matrix3::identity()));
            let off = exact.iter().zip(values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9 * exact.norm(), "region {owner}: {off} of {}", exact.norm());
            counts[owner as usize] += 1;
        }
        assert!(counts.iter().all(|&count| count > 50), "{counts:?}");
    }
}
