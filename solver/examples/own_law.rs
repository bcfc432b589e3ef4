//! A material of your own, given by its strain energy alone: Fung's exponential law, with fibres.
//!
//! ψ = c/2 (e^Q − 1) + K/2 (J − 1)², Q = b (I₁ − 3 − 2 ln J) + f (a·C a − 1)², fibres along a. A block is pulled
//! along and across its fibres; the first takes more force.

use mtled::material::{Number, OwnLaw, StrainEnergy};
use mtled::{
    Amplitude, EssentialCondition, Law, Material, Motion, Newton, Problem, Recipe, Selector, Shape,
    Simulation, Unobserved, Vector3,
};

#[derive(Debug)]
struct Fung {
    stiffness: f64,    // Pa
    matrix: f64,       // –
    fibres: f64,       // –
    bulk_modulus: f64, // Pa
    axis: Vector3,
}

impl StrainEnergy for Fung {
    fn energy(&self, c: &[[Number; 3]; 3]) -> Number {
        let minor = |a: usize, b: usize| c[1][a] * c[2][b] - c[1][b] * c[2][a];
        let third = c[0][0] * minor(1, 2) - c[0][1] * minor(0, 2) + c[0][2] * minor(0, 1);
        let matrix = c[0][0] + c[1][1] + c[2][2] - 3.0 - third.ln();
        let along = |i: usize, j: usize| c[i][j] * (self.axis[i] * self.axis[j]);
        let stretch = (0..9).map(|n| along(n / 3, n % 3)).fold(Number::from(-1.0), |a, b| a + b);
        let exponent = matrix * self.matrix + stretch * stretch * self.fibres;
        let growth = third.powf(0.5) - 1.0;
        (exponent.exp() - 1.0) * (0.5 * self.stiffness)
            + growth * growth * (0.5 * self.bulk_modulus)
    }
}

/// Force \[N\] that stretches a block of 40 mm by a tenth along x.
fn pull(axis: Vector3) -> Result<f64, Box<dyn std::error::Error>> {
    let law = Fung { stiffness: 2000.0, matrix: 1.5, fibres: 10.0, bulk_modulus: 20e3, axis };
    let material = Material { density: 1000.0, law: Law::Own(OwnLaw::new(law)?) };
    let block = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.04) };
    let mut problem = Problem::new(block, material, Recipe::with_spacing(0.008));
    let face = |x: f64| Selector::Plane {
        point: Vector3::new(x, 0.0, 0.0),
        normal: Vector3::x(),
        tolerance: 1e-9,
    };
    let held = |name, x, u| {
        let u = Vector3::new(u, 0.0, 0.0);
        EssentialCondition::on_surface(name, face(x), u, Amplitude::Constant)
    };
    problem.conditions = vec![held("left", 0.0, 0.0), held("right", 0.04, 0.004)];
    problem.motion = Motion::Newton(Newton::default());
    let mut simulation = Simulation::new(&problem)?;
    simulation.run(&mut Unobserved)?;
    Ok(simulation.reactions(&Vector3::zeros())[1].force.x)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (along, across) = (pull(Vector3::x())?, pull(Vector3::y())?);
    println!("a tenth takes {along:.3} N along the fibres and {across:.3} N across");
    assert!(along > 1.1 * across && across > 0.0);
    Ok(())
}
