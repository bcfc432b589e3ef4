//! A block is sheared by a quarter of its height; its static equilibrium by Newton's method.
//!
//! f_int(u) = 0 for the nodes that are not prescribed: K Δu = −f_int with K = ∂f_int/∂u by
//! exact products, conjugate gradients, and a line search; the residual ends at round-off.

use mtled::{
    Amplitude, ElasticConstants, EssentialCondition, Law, Material, Motion, NeoHookeanIsochoric,
    Newton, Problem, Recipe, Selector, Shape, Simulation, Unobserved, Vector3, VolumetricTerm,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (edge, height) = (0.1, 0.05); // m
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.49)?; // Pa
    let law = NeoHookeanIsochoric::new(constants, VolumetricTerm::Quadratic);
    let material = Material { density: 1000.0, law: Law::NeoHookeanIsochoric(law) };
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::new(edge, edge, height) };

    let mut problem = Problem::new(body, material, Recipe::with_spacing(0.0125));
    let face = |z: f64| Selector::Plane {
        point: Vector3::new(0.0, 0.0, z),
        normal: Vector3::z(),
        tolerance: 1e-6,
    };
    let ramp = Amplitude::Linear { duration: 1.0 };
    let shear = Vector3::new(0.25 * height, 0.0, 0.0);
    problem.conditions = vec![
        EssentialCondition::on_surface("bottom", face(0.0), Vector3::zeros(), ramp.clone()),
        EssentialCondition::on_surface("top", face(height), shear, ramp),
    ];
    problem.motion = Motion::Newton(Newton::default());

    let mut simulation = Simulation::new(&problem)?;
    let summary = simulation.run(&mut Unobserved)?;
    let newton = summary.newton.ok_or("no Newton counts")?;
    let reactions = simulation.reactions(&Vector3::zeros());
    println!(
        "{} corrections, {} products with K, residual {:.1e} of the largest force",
        newton.iterations, newton.products, newton.residual
    );
    println!("shear force {:.4} N, against {:.4} N", reactions[1].force.x, reactions[0].force.x);
    let sum = (reactions[0].force + reactions[1].force).norm();
    assert!(newton.residual <= 1e-9 && sum <= 1e-6 * reactions[1].force.norm());
    Ok(())
}
