//! What is held as a volume: a body that ends at its border, and the weight of the rest.
#![allow(non_snake_case)]

use crate::common::*;
use mtled::algebra::tensor::Vector3;
use mtled::audit::Kind;
use mtled::geometry::{Extent, Selector, Shape};
use mtled::model::essential::Reaction;
use mtled::motion::observe::Unobserved;
use mtled::problem::*;
use mtled::simulation::Simulation;

const RADIUS: f64 = 0.05;
const SPACING: f64 = 0.01;

fn below(z: f64) -> Shape {
    Shape::HalfSpace { point: Vector3::z() * z, normal: Vector3::z() }
}

fn inside(shape: Shape) -> Selector {
    Selector::Inside { shape, tolerance: 1e-3 * SPACING }
}

fn held_volume(name: &str, part: Selector, by: Vector3) -> EssentialCondition {
    let values = [Some(by.x), Some(by.y), Some(by.z)];
    let amplitude = Amplitude::Linear { duration: 1.0 };
    EssentialCondition { extent: Extent::Volume, amplitude, ..condition(name, part, values) }
}

fn weighed(body: Shape, conditions: Vec<EssentialCondition>) -> Problem {
    let recipe = Recipe::with_spacing(SPACING);
    let mut problem = Problem::new(body, material(neo_hookean(6000.0, 0.4)), recipe);
    problem.conditions = conditions;
    problem.loads.body_forces = vec![BodyForce {
        part: Selector::All,
        acceleration: (Vector3::z() * -10.0).into(),
        amplitude: Amplitude::Linear { duration: 1.0 },
    }];
    problem.motion = Motion::Newton(Newton { tolerance: 1e-5, ..Newton::default() });
    problem
}

fn solved(problem: &Problem) -> Simulation {
    let mut simulation = Simulation::new(problem).unwrap();
    simulation.run(&mut Unobserved).unwrap();
    simulation
}

fn reaction(simulation: &Simulation, condition: usize) -> Reaction {
    simulation.reactions(&Vector3::zeros())[condition]
}

/// A ball held below a height, and the ball without what is there, held on the cut.
fn held_and_cut(height: f64) -> [Problem; 2] {
    let ball = Shape::Sphere { centre: Vector3::zeros(), radius: RADIUS };
    let hole = Box::new(below(height));
    let cut = Shape::Difference(Box::new(ball.clone()), hole);
    let cap = held_volume("cap", inside(below(height)), Vector3::zeros());
    let face = condition("cut", face(2, height), [Some(0.0); 3]);
    [weighed(ball, vec![cap]), weighed(cut, vec![face])]
}

#[test]
fn a_held_cap_acts_as_the_body_cut_there_and_carries_its_own_weight_besides() {
    for height in [-0.7 * RADIUS, -0.37 * RADIUS] {
        let [held, cut] = held_and_cut(height).map(|problem| solved(&problem));
        let top = [Vector3::z() * (0.99 * RADIUS)];
        let [u, v] = [&held, &cut].map(|run| run.displacements_at(&top).unwrap()[0]);
        assert!((u - v).norm() < 0.01 * v.norm(), "{u} and {v}");
        let energies = [&held, &cut].map(|run| run.energies().strain);
        assert!((energies[0] / energies[1] - 1.0).abs() < 0.01, "{energies:?}");
        // Of the cap that is cut off.
        let depth = RADIUS + height;
        let volume = std::f64::consts::PI * depth * depth * (RADIUS - depth / 3.0);
        let more = reaction(&held, 0).force.z - reaction(&cut, 0).force.z;
        assert!((more / (10.0 * 1000.0 * volume) - 1.0).abs() < 0.01, "{more}");
    }
}

#[test]
fn what_is_held_has_no_strain_energy_and_all_of_the_mass() {
    let [held, _] = held_and_cut(-0.5 * RADIUS);
    let simulation = solved(&held);
    let border = -0.5 * RADIUS;
    let points = &simulation.discretisation.quadrature.positions;
    assert!(points.iter().all(|X| X.z > border), "a point below the border");
    let mass: f64 = simulation.model.lumped_mass.iter().sum();
    let exact = 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) * 1000.0;
    assert!((mass / exact - 1.0).abs() < 2e-3, "{mass}");
    let audit = simulation.audit().unwrap();
    assert!(!audit.is_doubtful(), "{:?}", audit.doubts().collect::<Vec<_>>());
    assert!(audit.rows.iter().any(|row| row.kind == Kind::Mass));
}

#[test]
fn every_place_within_moves_as_prescribed() {
    let angle = 0.3;
    let [mut problem, _] = held_and_cut(-0.3 * RADIUS);
    let axis = Vector3::y();
    let point = Vector3::new(0.0, 0.0, -RADIUS);
    problem.conditions[0].prescribed = Prescribed::Rotation { point, axis, angle };
    let simulation = solved(&problem);
    let places: Vec<Vector3> =
        (0..20).map(|n| Vector3::new(0.02 - 0.002 * n as f64, 0.01, -0.03)).collect();
    let turn = mtled::algebra::tensor::rotation(&axis, angle);
    for (X, u) in places.iter().zip(simulation.displacements_at(&places).unwrap()) {
        let exact = turn * (X - point) - (X - point);
        assert!((u - exact).norm() < 2e-3 * exact.norm(), "{u} for {exact} at {X}");
    }
}

#[test]
fn slabs_thinner_than_a_spacing_and_volumes_that_are_released_keep_their_points() {
    let body = || Shape::Box { min: Vector3::zeros(), max: Vector3::new(0.05, 0.05, 0.08) };
    let points = |condition: EssentialCondition| {
        let problem = weighed(body(), vec![condition]);
        build(&problem).0.quadrature.positions.len()
    };
    let slab = |z: f64| held_volume("foot", inside(below(z)), Vector3::zeros());
    let all = points(condition("foot", face(2, 0.0), [Some(0.0); 3]));
    assert_eq!(points(slab(0.01 * SPACING)), all);
    assert_eq!(points(slab(0.9 * SPACING)), all);
    assert!(points(slab(1.5 * SPACING)) < all);
    assert_eq!(points(EssentialCondition { release: Some(0.5), ..slab(0.03) }), all);
    let rollers = Prescribed::Displacement([None, Some(0.0), Some(0.0)]);
    assert_eq!(points(EssentialCondition { prescribed: rollers, ..slab(0.03) }), all);
}

#[test]
fn the_words_of_a_selection_do_not_matter() {
    let upper = Vector3::new(0.05, 0.05, 0.08);
    let body = || Shape::Box { min: Vector3::zeros(), max: upper };
    let z = 0.023;
    let above = Shape::HalfSpace { point: Vector3::z() * z, normal: -Vector3::z() };
    let exact = Shape::Box { min: Vector3::zeros(), max: Vector3::new(0.05, 0.05, z) };
    let wide = Shape::Box { min: -upper, max: Vector3::new(1.0, 1.0, z) };
    let parts = [
        inside(below(z)),
        inside(exact),
        inside(wide.clone()),
        Selector::Not(Box::new(inside(above))),
        Selector::Intersection(vec![inside(wide), inside(below(z))]),
    ];
    let top = [Vector3::new(0.025, 0.025, 0.08)];
    let found = parts.map(|part| {
        let problem = weighed(body(), vec![held_volume("foot", part, Vector3::zeros())]);
        let simulation = solved(&problem);
        let u = simulation.displacements_at(&top).unwrap()[0];
        (u.z, reaction(&simulation, 0).force.z)
    });
    // 2 N of weight; sides in other places give 0.3 %.
    for (u, force) in found {
        assert!((u / found[0].0 - 1.0).abs() < 5e-3, "{found:?}");
        assert!((force / 2.0 - 1.0).abs() < 1e-3, "{found:?}");
    }
}

#[test]
fn two_held_ends_pull_with_the_same_force() {
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::new(0.03, 0.03, 0.1) };
    let above = Shape::HalfSpace { point: Vector3::z() * 0.08, normal: -Vector3::z() };
    let ends = vec![
        held_volume("foot", inside(below(0.02)), Vector3::zeros()),
        held_volume("head", inside(above), Vector3::z() * 0.003),
    ];
    let mut problem = weighed(body, ends);
    problem.regions[0].material = material(neo_hookean(6000.0, 0.0));
    problem.loads.body_forces.clear();
    let simulation = solved(&problem);
    // 0.06 m between the ends are pulled by 5 %: P = E/2 (λ − 1/λ) for ν = 0.
    let exact = 6000.0 * 0.5 * (1.05 - 1.0 / 1.05) * 0.03 * 0.03;
    let [foot, head] = [0, 1].map(|end| reaction(&simulation, end).force.z);
    assert!((head / exact - 1.0).abs() < 2e-3, "{head} for {exact}");
    assert!((foot + head).abs() < 1e-3 * head);
}

#[test]
fn loads_on_what_is_held_are_in_its_reaction_whole() {
    let [mut problem, _] = held_and_cut(-0.2 * RADIUS);
    problem.loads.body_forces.clear();
    problem.loads.pressures = vec![Pressure {
        name: "all around".into(),
        part: Selector::All,
        pressure: 50.0,
        amplitude: Amplitude::Linear { duration: 1.0 },
    }];
    let all = solved(&problem);
    let size = 50.0 * std::f64::consts::PI * RADIUS * RADIUS;
    assert!(reaction(&all, 0).force.norm() < 2e-3 * size, "{:?}", reaction(&all, 0));
    problem.loads.pressures.clear();
    problem.loads.tractions = vec![Traction {
        name: "cap".into(),
        part: inside(below(-0.2 * RADIUS)),
        traction: (Vector3::x() * 30.0).into(),
        amplitude: Amplitude::Linear { duration: 1.0 },
    }];
    let force = reaction(&solved(&problem), 0).force;
    let area = std::f64::consts::TAU * RADIUS * 0.8 * RADIUS;
    assert!((force.x / (30.0 * area) + 1.0).abs() < 5e-3, "{force}");
}

#[test]
fn a_held_volume_that_moves_drags_the_rest_along_with_its_inertia() {
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::new(0.03, 0.03, 0.06) };
    let velocity = Vector3::x() * 0.5;
    let mut problem = weighed(body, vec![held_volume("foot", inside(below(0.023)), velocity)]);
    problem.loads.body_forces.clear();
    problem.loads.initial_velocities = vec![(Selector::All, velocity.into())];
    problem.motion = Motion::dynamic(0.02, 0.0);
    let simulation = solved(&problem);
    for node in 0..simulation.model.positions.len() {
        let u = simulation.state.displacement_of(node, 3);
        assert!((u - velocity * 0.02).norm() < 1e-6, "{u:?}");
    }
    assert!(reaction(&simulation, 0).force.norm() < 1e-4, "{:?}", reaction(&simulation, 0));
}

#[test]
fn what_deforms_sees_nothing_of_a_held_ball_of_any_size() {
    for radius in (20..60).map(|n| 0.01 * f64::from(n) * 0.983) {
        let block = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(1.0) };
        let ball = Shape::Sphere { centre: Vector3::new(0.5, 0.5, 1.0), radius };
        let mut problem = weighed(block, vec![held_volume("ball", inside(ball), Vector3::zeros())]);
        problem.recipe = Recipe::with_spacing(0.2);
        let body = Simulation::new(&problem).unwrap().discretisation;
        let deforming = body.deforming_nodes() as u32;
        assert!(body.supports.nodes.iter().all(|&node| node < deforming), "{radius}");
    }
}
