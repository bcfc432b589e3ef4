//! A block of soft tissue, stretched by 20 % between bonded faces.
//!
//! Find u with Div P = 0 in the cube (0, L)³, P = ∂ψ/∂F, F = I + Grad u,
//! ψ = μ/2 (I₁ − 3) − μ ln J + λ/2 (ln J)², u = 0 at z = 0 and u = (0, 0, L/5) at z = L.

use mtled::{
    Amplitude, ElasticConstants, EssentialCondition, Law, Material, NeoHookeanLogJ, Problem,
    Recipe, Selector, Shape, Simulation, Unobserved, Vector3,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let edge = 0.1; // m
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.45)?; // Pa
    let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
    let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(edge) };
    let tissue = Material { density: 1000.0, law }; // kg/m³

    let mut problem = Problem::new(body, tissue, Recipe::with_spacing(edge / 8.0));
    let face = |z: f64| Selector::Plane {
        point: Vector3::new(0.0, 0.0, z),
        normal: Vector3::z(),
        tolerance: 1e-6,
    };
    let ramp = Amplitude::Smooth { duration: 1.0 };
    problem.conditions = vec![
        EssentialCondition::on_surface("bottom", face(0.0), Vector3::zeros(), ramp.clone()),
        EssentialCondition::on_surface("top", face(edge), Vector3::new(0.0, 0.0, 0.2 * edge), ramp),
    ];

    let mut simulation = Simulation::new(&problem)?;
    let summary = simulation.run(&mut Unobserved)?;
    let side = simulation.displacements_at(&[Vector3::new(edge, 0.5 * edge, 0.5 * edge)])?[0];
    let top = simulation.reactions(&Vector3::zeros())[1].force;
    println!("{} steps, smallest J {:.3}", summary.steps, summary.smallest_jacobian.jacobian);
    println!(
        "the side moves inwards by {:.3} mm, the top is pulled by {:.3} N",
        -1e3 * side.x,
        top.z
    );
    assert!(side.x < 0.0 && top.z > 0.0);
    Ok(())
}
