//! A cantilever is released under gravity; its energies are followed.
//!
//! ρ ü = Div P + ρ g with u = 0 at x = 0, by central differences without damping. The sum
//! kinetic + strain energy − work of gravity stays within O(Δt²) of its first value, 0.

use mtled::motion::energy::Energies;
use mtled::{
    Amplitude, BodyForce, Continue, ElasticConstants, EssentialCondition, Law, Material, Motion,
    NeoHookeanLogJ, Observer, Problem, Recipe, Selector, Shape, Simulation, Vector3, View,
};

/// Samples the energies after every hundredth step.
struct History(Vec<(f64, Energies)>);

impl Observer for History {
    fn observe(&mut self, view: &mut View) -> Continue {
        if view.state.step.is_multiple_of(100) {
            self.0.push((view.state.time, view.energies()));
        }
        Continue::Yes
    }

    fn tracks_work(&self) -> bool {
        true
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let constants = ElasticConstants::from_young_poisson(10_000.0, 0.3)?; // Pa
    let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
    let beam = Shape::Box { min: Vector3::zeros(), max: Vector3::new(0.2, 0.04, 0.04) }; // m
    let mut problem =
        Problem::new(beam, Material { density: 1000.0, law }, Recipe::with_spacing(0.01));
    let clamp = Selector::Plane { point: Vector3::zeros(), normal: Vector3::x(), tolerance: 1e-6 };
    let at_once = Amplitude::Constant;
    problem.conditions =
        vec![EssentialCondition::on_surface("clamp", clamp, Vector3::zeros(), at_once.clone())];
    let gravity = Vector3::new(0.0, 0.0, -9.81).into(); // N/kg
    problem.loads.body_forces =
        vec![BodyForce { part: Selector::All, acceleration: gravity, amplitude: at_once }];
    problem.motion = Motion::dynamic(0.15, 0.0); // s, 1/s

    let mut history = History(Vec::new());
    Simulation::new(&problem)?.run(&mut history)?;
    println!("  time s   kinetic J    strain J   gravity J   balance J");
    for (time, e) in &history.0 {
        let (work, balance) = (e.external_work, e.balance());
        println!("{time:8.4} {:11.3e} {:11.3e} {work:11.3e} {balance:11.1e}", e.kinetic, e.strain);
        assert!(balance.abs() <= 1e-2 * work.abs().max(1e-6));
    }
    Ok(())
}
