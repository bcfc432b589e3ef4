//! A soft ball is pressed onto a rigid plane, without friction.
//!
//! Gap g(x) = x·e_z ≥ 0 for every boundary node; where g = 0 the plane pushes along e_z.
//! The cap on top moves down by a tenth of the radius and the ball comes to rest, damped.

use mtled::{
    Amplitude, Continue, ElasticConstants, EssentialCondition, Law, Material, Motion,
    NeoHookeanLogJ, Observer, Obstacle, Problem, Recipe, Selector, Shape, Simulation, Vector3,
    View,
};

/// The largest number of nodes in contact.
struct Touching(usize);

impl Observer for Touching {
    fn observe(&mut self, view: &mut View) -> Continue {
        self.0 = self.0.max(view.state.contact.touching.len());
        Continue::Yes
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (radius, push) = (0.03, 0.003); // m
    let law = NeoHookeanLogJ::new(ElasticConstants::from_young_poisson(3000.0, 0.4)?); // Pa
    let material = Material { density: 1000.0, law: Law::NeoHookeanLogJ(law) };
    let centre = Vector3::new(0.0, 0.0, radius);
    let ball = Shape::Sphere { centre, radius };
    let mut problem = Problem::new(ball, material, Recipe::with_spacing(radius / 5.0));

    let point = Vector3::new(0.0, 0.0, 1.6 * radius);
    let above = Shape::HalfSpace { point, normal: -Vector3::z() };
    let cap = Selector::Inside { shape: above, tolerance: 0.0 };
    let ramp = Amplitude::Smooth { duration: 0.3 };
    let down = Vector3::new(0.0, 0.0, -push);
    problem.conditions = vec![EssentialCondition::on_surface("cap", cap, down, ramp)];
    problem.obstacles = vec![Obstacle::new(
        "plane",
        Shape::HalfSpace { point: Vector3::zeros(), normal: Vector3::z() },
    )];
    problem.motion = Motion::dynamic(0.6, 40.0); // s, 1/s

    let mut simulation = Simulation::new(&problem)?;
    let mut touching = Touching(0);
    simulation.run(&mut touching)?;
    let force = simulation.reactions(&centre)[0].force;
    let lowest = simulation.displacements_at(&[Vector3::new(0.0, 0.0, 1e-6)])?[0];
    println!("{} nodes touch, the cap is pushed by {:.4} N", touching.0, -force.z);
    println!("the lowest point has moved by {:.2e} m", lowest.z);
    assert!(touching.0 > 0 && force.z < 0.0);
    Ok(())
}
