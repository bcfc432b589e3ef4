//! A good scene is silent in every row; a row speaks where what it compares is spoilt.
#![allow(non_snake_case)]

use super::*;
use crate::geometry::{Field, Selector};
use crate::material::{ElasticConstants, Law, Material, NeoHookeanLogJ};
use crate::motion::observe::Observer;
use crate::problem::{
    Amplitude, BodyForce, EssentialCondition, MaterialBorders, Motion, Newton, Obstacle,
    Prescribed, Pressure, Recipe, Region, Traction,
};
use crate::simulation::Simulation;

/// Adds up work.
struct Tracked;

impl Observer for Tracked {
    fn observe(&mut self, _: &mut crate::motion::observe::View) -> crate::Continue {
        crate::Continue::Yes
    }

    fn tracks_work(&self) -> bool {
        true
    }
}

fn tissue(young_modulus: f64) -> Material {
    let constants = ElasticConstants::from_young_poisson(young_modulus, 0.3).unwrap();
    Material { density: 1000.0, law: Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants)) }
}

fn cuboid(min: [f64; 3], max: [f64; 3]) -> Shape {
    Shape::Box { min: min.into(), max: max.into() }
}

fn face(z: f64) -> Selector {
    Selector::Plane { point: Vector3::new(0.0, 0.0, z), normal: Vector3::z(), tolerance: 1e-9 }
}

fn held(name: &str, z: f64, down: f64) -> EssentialCondition {
    let displacement = Vector3::new(0.0, 0.0, -down);
    EssentialCondition::on_surface(name, face(z), displacement, Amplitude::Constant)
}

/// A block of 8 spacings a side, of 10 mm on the ground, under its weight and loads on its top.
fn block() -> Problem {
    let body = cuboid([0.0; 3], [0.08; 3]);
    let mut problem = Problem::new(body, tissue(3000.0), Recipe::with_spacing(0.01));
    problem.conditions = vec![held("ground", 0.0, 0.0)];
    problem.loads.body_forces = vec![BodyForce {
        part: Selector::All,
        acceleration: Vector3::new(0.0, 0.0, -2.0).into(),
        amplitude: Amplitude::Constant,
    }];
    problem.loads.tractions = vec![Traction {
        name: "pull".into(),
        part: face(0.08),
        traction: Vector3::new(20.0, 0.0, 0.0).into(),
        amplitude: Amplitude::Constant,
    }];
    problem.loads.pressures = vec![Pressure {
        name: "weight".into(),
        part: face(0.08),
        pressure: 30.0,
        amplitude: Amplitude::Constant,
    }];
    problem
}

fn run(problem: &Problem) -> Simulation {
    let mut simulation = Simulation::new(problem).unwrap();
    simulation.run(&mut Tracked).unwrap();
    simulation
}

/// The kinds of the rows that exceed their limits.
fn doubts(simulation: &Simulation) -> Vec<Kind> {
    simulation.audit().unwrap().doubts().map(|row| row.kind).collect()
}

#[track_caller]
fn silent(simulation: &Simulation) {
    let audit = simulation.audit().unwrap();
    let doubts: Vec<&Row> = audit.doubts().collect();
    assert!(doubts.is_empty(), "{doubts:#?}");
}

fn row(simulation: &Simulation, kind: Kind) -> Row {
    let rows = simulation.audit().unwrap().rows;
    rows.into_iter().find(|row| row.kind == kind).unwrap_or_else(|| panic!("no row of {kind:?}"))
}

#[test]
fn a_good_run_is_not_doubted_and_has_a_row_of_every_kind_that_applies() {
    let simulation = run(&block());
    silent(&simulation);
    for kind in [
        Kind::PrescribedAtNodes,
        Kind::PrescribedBetween,
        Kind::LoadForce,
        Kind::LoadMoment,
        Kind::Forces,
        Kind::Moments,
        Kind::Volume,
        Kind::Mass,
        Kind::NodalMass,
        Kind::InternalWork,
        Kind::Centre,
        Kind::Edges,
        Kind::Gap,
    ] {
        row(&simulation, kind);
    }
    // Σ weight + traction + pressure are known in closed form.
    let Figure::Vector(pull) = row(&simulation, Kind::LoadForce).asked else { panic!() };
    assert!((pull.z + 2.0 * 0.512).abs() < 0.005 * 1.024, "{pull}");
}

#[test]
fn a_displacement_that_falls_short_is_doubted() {
    let mut problem = block();
    problem.conditions.push(held("top", 0.08, 0.01));
    let mut simulation = run(&problem);
    silent(&simulation);
    simulation.state.displacement.iter_mut().for_each(|u| *u *= 0.9);
    let doubts = doubts(&simulation);
    assert!(doubts.contains(&Kind::PrescribedAtNodes) && doubts.contains(&Kind::PrescribedBetween));
}

#[test]
fn loads_that_reached_the_nodes_otherwise_are_doubted() {
    let mut simulation = run(&block());
    simulation.model.loads[1].force.iter_mut().for_each(|f| *f *= 1.05);
    assert_eq!(doubts(&simulation)[..1], [Kind::LoadForce]);
    // The same force at another place.
    let mut simulation = run(&block());
    let force = &mut simulation.model.loads[0].force;
    let nodes = force.len() / 3;
    let all: f64 = force.iter().skip(2).step_by(3).sum();
    let corner = (0..nodes).max_by_key(|&n| (1e6 * simulation.model.positions[n].sum()) as i64);
    force.fill(0.0);
    force[3 * corner.unwrap() + 2] = all;
    assert!(doubts(&simulation).contains(&Kind::LoadMoment));
}

#[test]
fn forces_that_do_not_add_up_are_doubted() {
    let mut simulation = run(&block());
    simulation.state.force_factor *= 0.5;
    let doubts = doubts(&simulation);
    assert!(doubts.contains(&Kind::Forces) && doubts.contains(&Kind::Moments), "{doubts:?}");
}

#[test]
fn reactions_of_one_condition_that_balance_each_other_are_not_doubted() {
    let mut problem = block();
    problem.loads = Default::default();
    let dent = |X: &Vector3| {
        let away = (X - Vector3::new(0.04, 0.04, 0.08)).norm_squared() / 0.0016;
        Vector3::new(0.0, 0.0, -0.005 * (1.0 - away).max(0.0).powi(2))
    };
    problem.conditions[0].part = face(0.08);
    problem.conditions[0].prescribed = Prescribed::Field(Field::of(dent));
    problem.motion = Motion::Newton(Newton { load_end: 1.0, tolerance: 1e-3, ..Newton::default() });
    assert_eq!(doubts(&run(&problem)).iter().filter(|kind| **kind == Kind::Forces).count(), 0);
}

#[test]
fn mass_volume_and_centre_that_are_not_those_of_the_shape_are_doubted() {
    let mut simulation = run(&block());
    simulation.model.lumped_mass[0] *= 100.0;
    assert_eq!(doubts(&simulation), [Kind::Mass, Kind::NodalMass]);
    let mut simulation = run(&block());
    simulation.discretisation.quadrature.weights.iter_mut().for_each(|w| *w *= 1.03);
    assert_eq!(doubts(&simulation), [Kind::Volume, Kind::NodalMass]);
    let mut simulation = run(&block());
    simulation.discretisation.quadrature.positions.iter_mut().for_each(|X| X.x += 0.003);
    assert_eq!(doubts(&simulation), [Kind::Centre]);
}

#[test]
fn soft_layers_that_are_too_thin_for_their_borders_are_doubted_and_others_are_not() {
    let problem = |thickness: f64| {
        let mut problem = block();
        let part = cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, thickness]);
        let part = Selector::Inside { shape: part, tolerance: 0.0 };
        problem.body = cuboid([0.0; 3], [0.08, 0.08, 0.16]);
        problem.recipe.material_borders = MaterialBorders::Straddled;
        problem.regions.insert(0, Region::new("soft", part, tissue(300.0)));
        problem.loads = Default::default();
        problem.loads.body_forces = block().loads.body_forces;
        problem.loads.body_forces[0].acceleration = Vector3::new(0.0, 0.0, -0.2).into();
        problem
    };
    let (thin, thick) = (run(&problem(0.01)), run(&problem(0.04)));
    assert!(doubts(&thin).contains(&Kind::Layer));
    assert!(!doubts(&thick).contains(&Kind::Layer), "{:?}", row(&thick, Kind::Layer));
    let Figure::Number(across) = row(&thin, Kind::Layer).done else { panic!() };
    assert!((across - 1.0).abs() < 0.01, "{across}");
    let sharp = |poisson_ratio: f64, thickness: f64| {
        let mut problem = problem(thickness);
        problem.recipe.material_borders = MaterialBorders::Sharp;
        let constants = ElasticConstants::from_young_poisson(300.0, poisson_ratio).unwrap();
        problem.regions[0].material.law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
        doubts(&run(&problem)).contains(&Kind::Layer)
    };
    assert!(!sharp(0.3, 0.005) && sharp(0.3, 0.0015));
    assert!(!sharp(0.49, 0.01) && sharp(0.49, 0.005));
}

#[test]
fn arms_that_are_glued_across_a_gap_are_doubted_and_wide_gaps_are_not() {
    let arms = |gap: f64| {
        let mut problem = block();
        let slit = cuboid([0.04, -1.0, 0.04 - gap / 2.0], [1.0, 1.0, 0.04 + gap / 2.0]);
        let body = cuboid([0.0; 3], [0.16, 0.06, 0.08]);
        problem.body = Shape::Difference(Box::new(body), Box::new(slit));
        problem.loads = Default::default();
        problem.recipe = Recipe::with_spacing(0.01);
        row(&Simulation::new(&problem).unwrap(), Kind::Gap)
    };
    assert!(!arms(0.03).exceeds());
    // Where supports do not see across gaps, nothing is glued, and the row says so.
    let narrow = arms(0.005);
    let Figure::Number(glued) = narrow.done else { panic!() };
    assert!((0.0..0.5).contains(&glued), "{narrow:?}");
}

#[test]
fn an_obstacle_that_has_been_entered_between_nodes_is_doubted() {
    let ball = |radius: f64, fall: f64| {
        let mut problem = block();
        problem.loads = Default::default();
        problem.conditions = vec![held("all", 0.0, 0.04)];
        problem.conditions[0].part = Selector::All;
        problem.obstacles = vec![Obstacle::new(
            "ball",
            Shape::Sphere { centre: Vector3::new(0.05, 0.05, -0.03), radius },
        )];
        let mut simulation = Simulation::new(&problem).unwrap();
        simulation.state.displacement.iter_mut().skip(2).step_by(3).for_each(|u| *u = -fall);
        row(&simulation, Kind::Depth)
    };
    assert!(!ball(0.003, 0.025).exceeds(), "{:?}", ball(0.003, 0.025));
    let deep = ball(0.0094, 0.025);
    let Figure::Number(depth) = deep.done else { panic!() };
    assert!(deep.exceeds() && (depth - 0.0044).abs() < 5e-4, "{deep:?}");
    let swallowed = ball(0.003, 0.04);
    let Figure::Number(depth) = swallowed.done else { panic!() };
    assert!(swallowed.exceeds() && (depth - 0.01).abs() < 0.003, "{swallowed:?}");
}

/// A free block that flies at 1 m/s against a rod of a radius and at a place along x \[m\].
fn flown_at_a_rod(radius: f64, x: f64, time: f64) -> Simulation {
    let mut problem = falling_on_a_plane();
    problem.loads.initial_velocities[0].1 = Vector3::new(0.0, 0.0, -1.0).into();
    problem.regions[0].material = tissue(20_000.0);
    problem.obstacles[0].shape = Shape::Cylinder {
        base: Vector3::new(x, -1.0, -0.007),
        axis: Vector3::y(),
        radius,
        height: 2.0,
    };
    problem.motion = Motion::dynamic(time, 0.0);
    run(&problem)
}

#[test]
fn an_obstacle_that_went_through_the_body_between_nodes_is_doubted_afterwards() {
    let simulation = flown_at_a_rod(0.0015, 0.035, 0.12);
    let heights = simulation.state.displacement.iter().skip(2).step_by(3);
    let top = heights.copied().reduce(f64::max).unwrap();
    assert!(top < -0.1, "all of it must be below the rod: {top}");
    assert_eq!(doubts(&simulation), [Kind::Depth]);
}

#[test]
fn an_obstacle_that_nodes_run_into_is_not_one_that_went_in_between() {
    let simulation = flown_at_a_rod(0.006, 0.04, 0.005);
    assert!(!simulation.state.contact_forces().is_empty(), "it must touch");
    assert!(simulation.state.contact.entered.is_empty());
}

#[test]
fn mass_that_is_lost_between_points_and_nodes_is_doubted() {
    let mut simulation = Simulation::new(&block()).unwrap();
    assert!(!row(&simulation, Kind::NodalMass).exceeds());
    simulation.model.lumped_mass[0] *= 0.999;
    assert!(row(&simulation, Kind::NodalMass).exceeds());
}

#[test]
fn a_held_volume_that_deforms_between_its_nodes_is_doubted() {
    let mut problem = block();
    let shape = cuboid([-1.0, -1.0, -1.0], [1.0, 1.0, 0.03]);
    problem.conditions[0].part = Selector::Inside { shape, tolerance: 1e-9 };
    problem.conditions[0].extent = crate::geometry::Extent::Volume;
    let mut simulation = run(&problem);
    silent(&simulation);
    let positions = simulation.model.positions.clone();
    for (u, X) in simulation.state.displacement.chunks_mut(3).zip(positions) {
        u[2] -= if X.z < 0.031 { 0.01 } else { 0.0 };
    }
    assert!(doubts(&simulation).contains(&Kind::PrescribedBetween));
}

#[test]
fn energy_that_vanishes_and_work_of_what_does_not_move_are_doubted() {
    let mut problem = block();
    problem.loads.tractions.clear();
    problem.loads.pressures.clear();
    problem.motion = Motion::dynamic(0.1, 0.0);
    let mut simulation = run(&problem);
    silent(&simulation);
    simulation.state.work.external *= 1.1;
    assert!(doubts(&simulation).contains(&Kind::Energy));
    let mut simulation = run(&problem);
    simulation.state.work.constraint -= 0.2 * simulation.state.work.external;
    assert!(doubts(&simulation).contains(&Kind::ContactWork));
}

/// A block above an obstacle that it falls on, stopped while it touches.
fn falling_on_a_plane() -> Problem {
    let mut problem = block();
    problem.loads = Default::default();
    problem.conditions.clear();
    problem.loads.initial_velocities = vec![(Selector::All, Vector3::new(0.0, 0.0, -0.5).into())];
    problem.obstacles = vec![Obstacle::new(
        "floor",
        Shape::HalfSpace { point: Vector3::new(0.0, 0.0, -0.001), normal: Vector3::z() },
    )];
    problem.motion = Motion::dynamic(0.02, 0.0);
    problem
}

#[test]
fn what_nodes_that_touch_keep_is_not_the_work_of_something_that_does_not_move() {
    let simulation = run(&falling_on_a_plane());
    let energies = simulation.energies();
    assert!(!simulation.state.contact_forces().is_empty(), "it must touch at the end");
    let largest = energies.kinetic.max(energies.strain);
    assert!(simulation.state.work.constraint.abs() > 0.02 * largest, "{energies:?}");
    assert!(!doubts(&simulation).contains(&Kind::ContactWork), "{energies:?}");
}

#[test]
fn what_obstacles_take_is_doubted() {
    let mut simulation = run(&falling_on_a_plane());
    let energies = simulation.energies();
    simulation.state.contact.impacts.lost += 0.1 * (energies.kinetic + energies.strain);
    assert!(doubts(&simulation).contains(&Kind::ContactWork));
}

#[test]
fn a_cloud_without_nodes_on_edges_is_doubted() {
    let mut simulation = Simulation::new(&block()).unwrap();
    assert!(!row(&simulation, Kind::Edges).exceeds());
    let inner = |X: &Vector3| X.iter().all(|x| (0.001..0.079).contains(x));
    let cloud = &mut simulation.discretisation.cloud;
    for X in cloud.positions.iter_mut().filter(|X| !inner(X)) {
        *X = 0.5 * (*X + Vector3::repeat(0.04));
    }
    assert!(row(&simulation, Kind::Edges).exceeds());
}

#[test]
fn tissue_that_keeps_its_volume_is_not_doubted_and_tissue_that_loses_it_is() {
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.49).unwrap();
    let mut problem = block();
    problem.regions[0].material.law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
    let mut simulation = run(&problem);
    silent(&simulation);
    let positions = simulation.model.positions.clone();
    for (u, X) in simulation.state.displacement.chunks_mut(3).zip(positions) {
        (0..3).for_each(|k| u[k] -= 0.1 * X[k]);
    }
    assert!(doubts(&simulation).contains(&Kind::PatchVolume));
}
