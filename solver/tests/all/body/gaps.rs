//! Gaps narrower than the supports: what is on their two sides stays apart.
#![allow(non_snake_case)]

use crate::common::*;
use mtled::algebra::random::Random;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::Discretisation;
use mtled::geometry::{Field, Selector, Shape, Surface};
use mtled::motion::observe::Unobserved;
use mtled::problem::*;
use mtled::simulation::Simulation;

/// Nodal spacing \[m\].
const SPACING: f64 = 0.005;

fn block(min: [f64; 3], max: [f64; 3]) -> Shape {
    Shape::Box { min: Vector3::from(min), max: Vector3::from(max) }
}

fn problem(body: Shape, spacing: f64) -> Problem {
    let mut problem =
        Problem::new(body, material(neo_hookean(3000.0, 0.3)), Recipe::with_spacing(spacing));
    problem.motion = Motion::Newton(Newton { tolerance: 1e-6, ..Newton::default() });
    problem
}

/// The faces x = `at` of what is above z = `height` \[m\].
fn end_above(at: f64, height: f64) -> Selector {
    let shape = Shape::HalfSpace { point: Vector3::new(0.0, 0.0, height), normal: -Vector3::z() };
    Selector::Intersection(vec![face(0, at), Selector::Inside { shape, tolerance: 1e-9 }])
}

fn solved(problem: &Problem) -> Simulation {
    let mut simulation = Simulation::new(problem).unwrap();
    simulation.run(&mut Unobserved).unwrap();
    simulation
}

fn displacement(simulation: &Simulation, X: [f64; 3]) -> Vector3 {
    simulation.displacements_at(&[Vector3::from(X)]).unwrap()[0]
}

/// Two bars above each other with a gap \[m\] between them, held at one end; the upper one is
/// pulled at the other.
fn two_bars(gap: f64) -> Problem {
    let lower = block([0.0, 0.0, 0.0], [0.05, 0.02, 0.0213]);
    let upper = block([0.0, 0.0, 0.0213 + gap], [0.05, 0.02, 0.0426 + gap]);
    let mut problem = problem(Shape::Union(vec![lower, upper]), SPACING);
    let pull = Vector3::new(0.002, 0.0, 0.001);
    problem.conditions = vec![
        EssentialCondition::on_surface("held", face(0, 0.0), Vector3::zeros(), Amplitude::Constant),
        EssentialCondition::on_surface(
            "pulled",
            end_above(0.05, 0.0213 + 0.5 * gap),
            pull,
            Amplitude::Linear { duration: 1.0 },
        ),
    ];
    problem
}

#[test]
fn a_bar_beside_another_that_is_pulled_stays_still() {
    let alone = {
        let body = block([0.0, 0.0, 0.0], [0.05, 0.02, 0.0213]);
        let mut problem = problem(body, SPACING);
        problem.conditions = two_bars(0.01).conditions;
        problem.conditions[1].part = face(0, 0.05);
        solved(&problem).reactions(&Vector3::zeros())[1].force
    };
    for gap in [1.2, 0.5, 0.2] {
        let problem = two_bars(gap * SPACING);
        let simulation = solved(&problem);
        for X in [[0.05, 0.01, 0.0213], [0.03, 0.01, 0.02], [0.04, 0.005, 0.01]] {
            let u = displacement(&simulation, X).norm();
            assert!(u < 1e-9, "a gap of {gap} spacings lets {u} m through");
        }
        // The bar is 4 spacings thick: nodes at other places change its force by a per cent.
        let force = simulation.reactions(&Vector3::zeros())[1].force;
        assert!((force - alone).norm() < 0.02 * alone.norm(), "{force} for {alone} at {gap}");
        assert!(simulation.discretisation.bridged.is_none());
    }
}

#[test]
fn both_sides_of_a_gap_take_part_in_a_uniform_strain() {
    let mut problem = two_bars(0.1 * SPACING);
    let strain = nalgebra::Matrix3::new(0.02, 0.01, 0.0, 0.0, -0.01, 0.015, 0.0, 0.005, 0.01);
    let displacement_of = move |X: &Vector3| strain * X;
    let mut all = EssentialCondition::on_surface(
        "all",
        Selector::All,
        Vector3::zeros(),
        Amplitude::Linear { duration: 1.0 },
    );
    all.prescribed = Prescribed::Field(Field::of(displacement_of));
    problem.conditions = vec![all];
    let simulation = solved(&problem);
    for X in [[0.02, 0.01, 0.02], [0.031, 0.007, 0.023], [0.04, 0.012, 0.012]] {
        let (u, exact) = (displacement(&simulation, X), displacement_of(&Vector3::from(X)));
        assert!((u - exact).norm() < 1e-7, "{u} for {exact}");
    }
}

#[test]
fn a_fork_with_a_slit_bends_as_finite_elements_say() {
    // Block of 100 × 40 × 20 mm with a slit of 2 mm from x = 30 mm to the end; the upper prong's
    // end moves up by 5 mm. Quadratic hexahedra of two sizes, which differ by 2 %: the lower
    // prong's tip moves by 0.21 mm, the force on the upper end is (3.4, 3.6) mN.
    let corners = [[0.0, -20.0], [100.0, -20.0], [100.0, -1.0], [30.0, -1.0], [30.0, 1.0]];
    let more = [[100.0, 1.0], [100.0, 20.0], [0.0, 20.0]];
    let points: Vec<[f64; 2]> =
        corners.iter().chain(&more).map(|c| [1e-3 * c[0], 1e-3 * c[1]]).collect();
    let body = Shape::Polygon { points: points.into(), z: (0.0, 0.02) };
    let mut problem = problem(body, 0.004);
    let upper = Shape::HalfSpace { point: Vector3::zeros(), normal: -Vector3::y() };
    let end = vec![face(0, 0.1), Selector::Inside { shape: upper, tolerance: 1e-9 }];
    problem.conditions = vec![
        EssentialCondition::on_surface("base", face(0, 0.0), Vector3::zeros(), Amplitude::Constant),
        EssentialCondition::on_surface(
            "up",
            Selector::Intersection(end),
            Vector3::y() * 0.005,
            Amplitude::Linear { duration: 1.0 },
        ),
    ];
    let simulation = solved(&problem);
    let lower = displacement(&simulation, [0.09, -0.01, 0.01]).y;
    // Measured: 0.23 mm at a spacing of 3 mm, 0.27 at 5; with supports across the slit 4.5.
    assert!((lower - 0.21e-3).abs() < 0.06e-3, "{lower}");
    let force = simulation.reactions(&Vector3::zeros())[1].force;
    assert!((force - Vector3::new(3.4e-3, 3.6e-3, 0.0)).norm() < 0.3e-3, "{force}");
}

#[test]
fn convex_bodies_are_not_searched_for_gaps() {
    let ball = Shape::Sphere { centre: Vector3::zeros(), radius: 0.02 };
    let discretisation = Discretisation::new(&problem(ball, SPACING)).unwrap();
    assert!(!discretisation.approximation.is_beside_gap(&Vector3::new(0.019, 0.0, 0.0)));
    let (vertices, triangles) = octahedron();
    let surface = Surface::new(vertices, triangles).unwrap();
    let body = Shape::Surface(std::sync::Arc::new(surface));
    let discretisation = Discretisation::new(&problem(body, SPACING)).unwrap();
    assert!(!discretisation.approximation.is_beside_gap(&Vector3::new(0.019, 0.0, 0.0)));
}

fn octahedron() -> (Vec<Vector3>, Vec<[u32; 3]>) {
    let tip = |k: usize, sign: f64| Vector3::ith(k, 0.02 * sign);
    let vertices = (0..3).flat_map(|k| [tip(k, 1.0), tip(k, -1.0)]).collect();
    let mut triangles = Vec::new();
    for (x, y, z) in (0..8).map(|n| (n & 1, n >> 1 & 1, n >> 2)) {
        let corners = [x, 2 + y, 4 + z];
        let turned = (x + y + z) % 2 == 1;
        triangles.push(if turned { [corners[0], corners[2], corners[1]] } else { corners });
    }
    (vertices, triangles)
}

/// Beside each other with a gap between them: two blocks, one of which is held and pulled and the other
/// held alone.
fn pair(random: &mut Random) -> (Problem, f64) {
    let mut within = |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + random.symmetric());
    let spacing = 0.01;
    let gap = spacing * 10.0_f64.powf(within(-4.0, -0.3));
    let (border, end) = (within(0.035, 0.055), within(0.085, 0.11));
    let (width, height) = (within(0.03, 0.045), within(0.03, 0.045));
    let left = block([0.0; 3], [border, width, height]);
    let right = block([border + gap, 0.0, 0.0], [end, width, height]);
    let mut problem = problem(Shape::Union(vec![left, right]), spacing);
    if within(-1.0, 1.0) > 0.0 {
        let seed = (1e6 * within(0.0, 1.0)) as u64;
        problem.recipe.cloud = Cloud::Jittered { spacing, jitter: within(0.05, 0.25), seed };
    }
    let still = Vector3::zeros();
    let up = Vector3::new(0.0, 0.002, 0.003);
    let top = Selector::Intersection(vec![
        face(2, height),
        Selector::Inside {
            shape: block([-1.0; 3], [border + 0.5 * gap, 1.0, 1.0]),
            tolerance: 0.0,
        },
    ]);
    problem.conditions = vec![
        EssentialCondition::on_surface("left", face(0, 0.0), still, Amplitude::Constant),
        EssentialCondition::on_surface("right", face(0, end), still, Amplitude::Constant),
    ];
    let traction = (20.0 * up.normalize()).into();
    problem.loads.tractions =
        vec![Traction { name: "pull".into(), part: top, traction, amplitude: Amplitude::Constant }];
    (problem, border + 0.5 * gap)
}

#[test]
fn a_block_without_loads_beside_a_gap_does_not_move_however_narrow_the_gap() {
    let mut random = Random(11);
    for n in 0..16 {
        let (problem, middle) = pair(&mut random);
        let simulation = solved(&problem);
        let (mut loaded, mut other) = (0.0_f64, 0.0_f64);
        let nodes = simulation.model.positions.iter().zip(simulation.state.displacement.chunks(3));
        for (X, u) in nodes {
            let size = u.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
            let side = if X.x < middle { &mut loaded } else { &mut other };
            *side = side.max(size);
        }
        assert!(loaded > 1e-4 && other < 1e-5 * loaded, "{n}: {other} beside {loaded}");
    }
}

#[test]
fn both_sides_of_a_gap_have_their_own_volume_and_no_point_lies_in_it() {
    let mut random = Random(23);
    for n in 0..24 {
        let (problem, middle) = pair(&mut random);
        let Shape::Union(blocks) = &problem.body else { panic!("two blocks") };
        let quadrature = Discretisation::new(&problem).unwrap().quadrature;
        let mut volumes = [0.0; 2];
        for (X, weight) in quadrature.positions.iter().zip(&quadrature.weights) {
            volumes[usize::from(X.x > middle)] += weight;
            let outside = problem.body.signed_distance(X) > -1e-9;
            assert!(!outside, "{n}: {X:?} lies in the gap or on its faces");
        }
        for (own, shape) in volumes.iter().zip(blocks) {
            let Shape::Box { min, max } = shape else { panic!("a block") };
            let exact = (max - min).product();
            assert!((own / exact - 1.0).abs() < 2e-3, "{n}: {own} of {exact}");
        }
    }
}
