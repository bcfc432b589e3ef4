//! Layers between materials with sharp borders, thick and thin, flat, tilted and curved.
#![allow(non_snake_case)]

use crate::common::{material, neo_hookean};
use mtled::algebra::tensor::Matrix3;
use mtled::geometry::LabelMap;
use mtled::material::LinearElastic;
use mtled::problem::{Cloud, Field, MaterialBorders, Prescribed, Region};
use mtled::{
    Amplitude, ElasticConstants, EssentialCondition, Law, Material, Motion, Newton, Problem,
    Recipe, Selector, Shape, Simulation, Unobserved, Vector3,
};
use std::sync::Arc;

const SPACING: f64 = 0.01;
const HEIGHT: f64 = 10.0 * SPACING;
const WIDTH: f64 = 3.0 * SPACING;
const YOUNG_MODULUS: f64 = 1000.0;
const STRETCH: f64 = 1e-4;
/// Parts of the cube over which energies are summed, along each edge.
const PARTS: usize = 120;
/// Thickness over spacing, and stiffness over that around it.
const LAYERS: [(f64, f64); 10] = [
    (3.0, 0.001),
    (2.0, 0.1),
    (2.0, 0.001),
    (1.0, 0.001),
    (0.5, 0.1),
    (0.5, 0.001),
    (0.25, 0.001),
    (0.25, 1000.0),
    (1.0, 10.0),
    (2.0, 1000.0),
];

fn lattice() -> Cloud {
    Cloud::Regular { spacing: SPACING }
}

fn jittered() -> Cloud {
    Cloud::Jittered { spacing: SPACING, jitter: 0.3, seed: 4 }
}

fn layer(centre: Vector3, normal: Vector3, thickness: f64) -> Selector {
    Selector::Plane { point: centre, normal, tolerance: 0.5 * thickness }
}

fn with_layers(body: Shape, cloud: Cloud, rest: Material, layers: Vec<Region>) -> Problem {
    let material_borders = MaterialBorders::Sharp;
    let recipe = Recipe { cloud, material_borders, ..Recipe::with_spacing(SPACING) };
    let mut problem = Problem::new(body, rest, recipe);
    problem.regions.splice(0..0, layers);
    problem.motion = Motion::Newton(Newton::default());
    problem
}

/// Force of a column that is stretched, in which nothing contracts sideways, over that of springs in
/// series.
fn column(cloud: Cloud, part: Selector, thickness: f64, ratio: f64) -> f64 {
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::new(WIDTH, WIDTH, HEIGHT) };
    let of = |ratio: f64| material(neo_hookean(ratio * YOUNG_MODULUS, 0.0));
    let own = Region::new("layer", part, of(ratio));
    let mut problem = with_layers(body, cloud, of(1.0), vec![own]);
    let held = |name: &str, axis: usize, at: f64, by: f64| {
        let mut components = [None; 3];
        components[axis] = Some(by);
        let normal = Vector3::ith(axis, 1.0);
        let face = Selector::Plane { point: at * normal, normal, tolerance: 1e-6 };
        let ramp = Amplitude::Linear { duration: 1.0 };
        EssentialCondition {
            prescribed: Prescribed::Displacement(components),
            ..EssentialCondition::on_surface(name, face, Vector3::zeros(), ramp)
        }
    };
    problem.conditions = vec![
        held("bottom", 2, 0.0, 0.0),
        held("top", 2, HEIGHT, STRETCH * HEIGHT),
        held("left", 0, 0.0, 0.0),
        held("front", 1, 0.0, 0.0),
    ];
    let mut simulation = Simulation::new(&problem).unwrap();
    simulation.run(&mut Unobserved).unwrap();
    let force = simulation.reactions(&Vector3::zeros())[1].force.z;
    let compliance = (HEIGHT - thickness + thickness / ratio) / YOUNG_MODULUS;
    force / (WIDTH * WIDTH * STRETCH * HEIGHT / compliance)
}

#[test]
fn flat_layers_carry_their_force_however_thin_they_are() {
    for (cloud, height) in [(lattice(), 0.05), (lattice(), 0.0513), (jittered(), 0.05)] {
        let centre = Vector3::new(0.5 * WIDTH, 0.5 * WIDTH, height);
        for (spacings, ratio) in LAYERS {
            let thickness = spacings * SPACING;
            let part = layer(centre, Vector3::z(), thickness);
            let found = column(cloud.clone(), part, thickness, ratio);
            assert!(
                (found - 1.0).abs() < 0.02,
                "{cloud:?}, centre {height}, {spacings} spacings, ratio {ratio}: {found}"
            );
        }
    }
}

/// The voxels of a layer across the column, each an eighth of a spacing.
fn voxels(centre: Vector3, normal: Vector3, thickness: f64) -> Selector {
    let voxel = 0.125 * SPACING;
    let size = [WIDTH, WIDTH, HEIGHT].map(|length| (length / voxel).round() as usize);
    let label = |n: usize| {
        let index = [n % size[0], n / size[0] % size[1], n / (size[0] * size[1])];
        let X = voxel * Vector3::from(index.map(|i| i as f64 + 0.5));
        if (X - centre).dot(&normal).abs() <= 0.5 * thickness { 2 } else { 1 }
    };
    let labels = (0..size.iter().product()).map(label).collect();
    let directions = voxel * Matrix3::identity();
    let map = LabelMap::new(size, Vector3::repeat(0.5 * voxel), directions, labels).unwrap();
    Selector::Label { map: Arc::new(map), label: 2 }
}

#[test]
fn layers_of_voxels_carry_what_layers_between_planes_do() {
    let centre = Vector3::new(0.5 * WIDTH, 0.5 * WIDTH, 0.05);
    let tilted = Vector3::new(-0.342_020_143, 0.0, 0.939_692_621);
    for (normal, bound) in [(Vector3::z(), 1e-3), (tilted, 0.03)] {
        for (spacings, ratio) in [(2.0, 0.001), (1.0, 0.1), (0.5, 0.001), (1.0, 10.0)] {
            let thickness = spacings * SPACING;
            let [exact, found] = [layer, voxels]
                .map(|part| column(lattice(), part(centre, normal, thickness), thickness, ratio));
            assert!(
                (found / exact - 1.0).abs() < bound,
                "{normal:?}, {spacings} spacings, ratio {ratio}: {found} for {exact}"
            );
        }
    }
}

const POISSON_RATIO: f64 = 0.3;

/// μ and λ \[Pa\].
fn constants(ratio: f64) -> (f64, f64) {
    let shear = 0.5 * ratio * YOUNG_MODULUS / (1.0 + POISSON_RATIO);
    (shear, 2.0 * shear * POISSON_RATIO / (1.0 - 2.0 * POISSON_RATIO))
}

fn elastic(ratio: f64) -> Material {
    let young = ratio * YOUNG_MODULUS;
    let constants = ElasticConstants::from_young_poisson(young, POISSON_RATIO).unwrap();
    material(Law::LinearElastic(LinearElastic::new(constants)))
}

/// Energy of a cube with layers whose surface moves as in an exact solution, over the exact one.
fn energy(
    (cloud, edge, layers): (Cloud, f64, Vec<Region>),
    displacement: impl Fn(&Vector3) -> Vector3 + Send + Sync + 'static,
    density: impl Fn(&Vector3) -> f64,
) -> f64 {
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(edge) };
    let mut problem = with_layers(body, cloud, elastic(1.0), layers);
    let ramp = Amplitude::Linear { duration: 1.0 };
    problem.conditions = vec![EssentialCondition {
        prescribed: Prescribed::Field(Field::of(displacement)),
        ..EssentialCondition::on_surface("surface", Selector::All, Vector3::zeros(), ramp)
    }];
    let mut simulation = Simulation::new(&problem).unwrap();
    simulation.run(&mut Unobserved).unwrap();
    let part = edge / PARTS as f64;
    let at = |n: usize| {
        let index = [n % PARTS, n / PARTS % PARTS, n / (PARTS * PARTS)];
        part * Vector3::from(index.map(|i| i as f64 + 0.5))
    };
    let exact: f64 = (0..PARTS.pow(3)).map(|n| density(&at(n))).sum();
    simulation.energies().strain / (exact * part.powi(3))
}

/// Of a laminate under a pull along its normal and a shear.
fn laminate(cloud: Cloud, normal: Vector3, thickness: f64, ratio: f64) -> f64 {
    let edge = 8.0 * SPACING;
    let centre = Vector3::new(0.5 * edge, 0.5 * edge, 0.5 * edge + 0.13 * SPACING);
    let along = Vector3::new(0.3, 0.9, -0.2);
    let along = (along - along.dot(&normal) * normal).normalize();
    let (pull, shear) = (1e-2, 4e-3);
    let slope =
        move |(mu, lambda): (f64, f64)| pull / (lambda + 2.0 * mu) * normal + shear / mu * along;
    let (outer, inner) = (slope(constants(1.0)), slope(constants(ratio)));
    let height = move |X: &Vector3| (X - centre).dot(&normal);
    let displacement = move |X: &Vector3| {
        let within = height(X).clamp(-0.5 * thickness, 0.5 * thickness);
        (height(X) - within) * outer + within * inner
    };
    let traction = pull * normal + shear * along;
    let density = move |X: &Vector3| {
        let slope = if height(X).abs() <= 0.5 * thickness { inner } else { outer };
        0.5 * traction.dot(&slope)
    };
    let own = Region::new("layer", layer(centre, normal, thickness), elastic(ratio));
    energy((cloud, edge, vec![own]), displacement, density)
}

#[test]
fn tilted_layers_take_the_energy_of_a_laminate() {
    let tilted = Vector3::new(-0.342_020_143, 0.0, 0.939_692_621).normalize();
    let skew = Vector3::new(1.0, 2.0, 3.0).normalize();
    for (cloud, normal) in [(lattice(), tilted), (jittered(), tilted), (lattice(), skew)] {
        for (spacings, ratio) in LAYERS {
            let found = laminate(cloud.clone(), normal, spacings * SPACING, ratio);
            assert!(
                (found - 1.0).abs() < 0.035,
                "{cloud:?}, {normal:?}, {spacings} spacings, ratio {ratio}: {found}"
            );
        }
    }
}

/// u = a X + b X/r³ of a part of a body that swells evenly in all directions.
#[derive(Clone, Copy)]
struct Swelling {
    a: f64,
    b: f64,
    mu: f64,
    lambda: f64,
}

impl Swelling {
    fn bulk(&self) -> f64 {
        3.0 * self.lambda + 2.0 * self.mu
    }

    /// What goes on beyond a radius in another material, with the same displacement and pressure.
    fn beyond(&self, r: f64, (mu, lambda): (f64, f64)) -> Swelling {
        let far = Swelling { a: 0.0, b: 0.0, mu, lambda };
        let stretch = self.a + self.b / r.powi(3);
        let stress = self.bulk() * self.a - 4.0 * self.mu * self.b / r.powi(3);
        let a = (stress + 4.0 * mu * stretch) / (far.bulk() + 4.0 * mu);
        Swelling { a, b: (stretch - a) * r.powi(3), ..far }
    }

    fn density(&self, r: f64) -> f64 {
        let (along, around) = (self.a - 2.0 * self.b / r.powi(3), self.a + self.b / r.powi(3));
        let squares = along * along + 2.0 * around * around;
        0.5 * self.lambda * (along + 2.0 * around).powi(2) + self.mu * squares
    }
}

/// Of a shell about a core, in a cube of the material of the core.
fn shell(cloud: Cloud, thickness: f64, ratio: f64) -> f64 {
    let edge = 10.0 * SPACING;
    let centre = Vector3::repeat(0.5 * edge);
    let (inner, outer) = (2.3 * SPACING, 2.3 * SPACING + thickness);
    let (mu, lambda) = constants(1.0);
    let core = Swelling { a: 1e-4, b: 0.0, mu, lambda };
    let around = core.beyond(inner, constants(ratio));
    let rest = around.beyond(outer, constants(1.0));
    let at = move |r: f64| match r {
        r if r < inner => core,
        r if r < outer => around,
        _ => rest,
    };
    let displacement = move |X: &Vector3| {
        let (x, r) = (X - centre, (X - centre).norm().max(1e-9));
        (at(r).a + at(r).b / r.powi(3)) * x
    };
    let density = move |X: &Vector3| at((X - centre).norm()).density((X - centre).norm());
    let ball =
        |radius: f64| Selector::Inside { shape: Shape::Sphere { centre, radius }, tolerance: 0.0 };
    let layers = vec![
        Region::new("core", ball(inner), elastic(1.0)),
        Region::new("shell", ball(outer), elastic(ratio)),
    ];
    energy((cloud, edge, layers), displacement, density)
}

#[test]
fn shells_about_a_core_take_the_energy_of_theirs() {
    for cloud in [lattice(), jittered()] {
        for (spacings, ratio) in LAYERS {
            let found = shell(cloud.clone(), spacings * SPACING, ratio);
            assert!(
                (found - 1.0).abs() < 0.03,
                "{cloud:?}, {spacings} spacings, ratio {ratio}: {found}"
            );
        }
    }
}
