//! A body given by a signed distance function of your own, falling onto a plane.
//!
//! A torus with its axis along z: d(X) = √((√(x² + y²) − R)² + (z − h)²) − r, which is
//! negative inside. Boundary nodes, panels and cut cells all come from this function.

use mtled::{
    Amplitude, BodyForce, DistanceFunction, ElasticConstants, Law, Material, Motion,
    NeoHookeanLogJ, Obstacle, Problem, Recipe, Selector, Shape, Simulation, Unobserved, Vector3,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (ring, tube, height) = (0.03, 0.012, 0.02); // m
    let lower = Vector3::new(-ring - tube, -ring - tube, height - tube);
    let upper = Vector3::new(ring + tube, ring + tube, height + tube);
    let torus = DistanceFunction::new(lower, upper, move |p| {
        (p.xy().norm() - ring).hypot(p.z - height) - tube
    });
    let law = NeoHookeanLogJ::new(ElasticConstants::from_young_poisson(5000.0, 0.4)?); // Pa
    let material = Material { density: 1000.0, law: Law::NeoHookeanLogJ(law) }; // kg/m³

    let mut problem = Problem::new(Shape::Function(torus), material, Recipe::with_spacing(0.005));
    let gravity = Vector3::new(0.0, 0.0, -9.81).into(); // N/kg
    problem.loads.body_forces = vec![BodyForce {
        part: Selector::All,
        acceleration: gravity,
        amplitude: Amplitude::Constant,
    }];
    problem.obstacles = vec![Obstacle::new(
        "floor",
        Shape::HalfSpace { point: Vector3::zeros(), normal: Vector3::z() },
    )];
    problem.motion = Motion::dynamic(0.12, 10.0); // s, 1/s

    let mut simulation = Simulation::new(&problem)?;
    simulation.run(&mut Unobserved)?;
    let probe = Vector3::new(ring, 0.0, height - 0.9 * tube);
    let z = probe.z + simulation.displacements_at(&[probe])?[0].z;
    let touching = simulation.state.contact.touching.len();
    println!(
        "after 0.12 s the probe is {:.2} mm above the floor, {touching} nodes touch it",
        1e3 * z
    );
    assert!(z > -1e-4 && z < probe.z);
    Ok(())
}
