//! Closed forms of viscosity and of active stress, in bodies that deform as one.
#![allow(non_snake_case)]

use crate::exact::homogeneous::uniaxial::uniaxial_stress;
use crate::studies::closed_forms::results::Results;
use anyhow::{Context, Result};
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::{Extent, Selector};
use mtled::material::{
    ElasticConstants, Law, Material, NeoHookeanIsochoric, Ogden, OgdenTerm, OgdenTerms,
    PronySeries, PronyTerm, VolumetricTerm,
};
use mtled::problem::{
    ActiveStress, Amplitude, Dimension, EssentialCondition, Fibres, Field, Motion, Newton,
    Prescribed, Problem, Traction,
};
use mtled::{Simulation, Unobserved};
use mtled_run::specimens::simple::{PLANE, SIZE, block_shape, free_body, recipe};

/// Bound on relative errors \[–\]: strains are uniform, and nothing is left but tolerances.
const BOUND: f64 = 1e-4;
/// Brain tissue (Miller, Chinzei 2002): μ \[Pa\], α \[–\], and g \[–\] with τ \[s\].
const BRAIN: (OgdenTerm, [PronyTerm; 2]) = (
    OgdenTerm { mu: 842.0, alpha: -4.7 },
    [PronyTerm { g: 0.450, tau: 0.5 }, PronyTerm { g: 0.365, tau: 50.0 }],
);
/// Tension of the muscle \[Pa\].
const TENSION: f64 = 900.0;

/// Relaxation, creep and contraction.
pub(crate) fn extra_stress(results: &mut Results) -> Result<()> {
    let source =
        "Simo 1987; Miller, Chinzei 2002: what is left of a sudden stress, 1 − Σ g (1 − e^(−t/τ))";
    for (dimension, name) in [(Dimension::Three, "cube"), (PLANE, "square")] {
        let sudden = shear_force(dimension, 1e-9)?;
        for time in [0.4, 30.0] {
            let error = (shear_force(dimension, time)? / sudden / left(time) - 1.0).abs();
            let label = format!(
                "brain tissue held in shear, {name}: force after {time} s over the sudden one, relative error"
            );
            results.relative(&format!("relaxation/{name}/{time}"), &label, error, BOUND, source);
        }
    }
    creep(results)?;
    contraction(results)
}

/// What is left of a sudden stress at time `t` \[s\].
fn left(t: f64) -> f64 {
    1.0 - BRAIN.1.iter().map(|term| term.g * (1.0 - (-t / term.tau).exp())).sum::<f64>()
}

/// A block of eight spacings a side \[m\], solved by Newton's method to a time \[s\].
fn block(dimension: Dimension, law: Law, end: f64) -> Problem {
    let material = Material { density: 1000.0, law };
    let mut problem = free_body(dimension, block_shape(), material, recipe(SIZE / 4.0, 0.2, 5));
    problem.motion = Motion::Newton(Newton { load_end: end, tolerance: 1e-9, parts: 10 });
    problem
}

/// Force \[N\] along x on the top of a block of brain whose surface was sheared suddenly by 0.3.
fn shear_force(dimension: Dimension, end: f64) -> Result<f64> {
    let terms = OgdenTerms::new(&[BRAIN.0])?;
    let law = Law::Ogden(Ogden::new(terms, 1e5, VolumetricTerm::Quadratic)?);
    let mut problem = block(dimension, law, end);
    problem.regions[0].viscosity = Some(PronySeries::new(&BRAIN.1)?);
    let shear = |X: &Vector3| Vector3::new(0.3 * X.y, 0.0, 0.0);
    for at in [SIZE, 0.0] {
        let point = Vector3::new(0.0, at, 0.0);
        let part = Selector::Plane { point, normal: Vector3::y(), tolerance: 1e-9 };
        let part = if at == SIZE { part } else { Selector::All };
        problem.conditions.push(EssentialCondition {
            name: format!("sheared at {at}"),
            extent: Extent::Surface,
            part,
            prescribed: Prescribed::Field(Field::of(shear)),
            amplitude: Amplitude::Constant,
            release: None,
        });
    }
    let simulation = solved(&problem)?;
    Ok(simulation.reactions(&Vector3::zeros())[0].force.x)
}

fn solved(problem: &Problem) -> Result<Simulation> {
    let mut simulation = Simulation::new(problem)?;
    simulation.run(&mut Unobserved)?;
    Ok(simulation)
}

/// Has a block stand on the three faces through the origin.
fn stand(problem: &mut Problem) {
    for axis in 0..3 {
        let normal = Vector3::ith(axis, 1.0);
        let mut values = [None; 3];
        values[axis] = Some(0.0);
        problem.conditions.push(EssentialCondition {
            name: format!("symmetry {axis}"),
            extent: Extent::Surface,
            part: Selector::Plane { point: Vector3::zeros(), normal, tolerance: 1e-9 },
            prescribed: Prescribed::Displacement(values),
            amplitude: Amplitude::Constant,
            release: None,
        });
    }
}

/// Stretches \[–\] of a block that deforms as one.
fn stretches(simulation: &Simulation) -> Result<Vector3> {
    let corner = simulation.displacements_at(&[Vector3::repeat(SIZE)])?;
    Ok(Vector3::repeat(1.0) + corner[0] / SIZE)
}

fn neo_hookean(shear_modulus: f64) -> Result<Law> {
    let constants = ElasticConstants::from_shear_bulk(shear_modulus, 1e5)?;
    Ok(Law::NeoHookeanIsochoric(NeoHookeanIsochoric::new(constants, VolumetricTerm::Quadratic)))
}

/// A dead load, suddenly and after all has relaxed.
fn creep(results: &mut Results) -> Result<()> {
    let traction = 500.0;
    for (id, end, shear_modulus) in [("sudden", 1e-9, 1000.0), ("crept", 2e3, 1000.0 * left(1e9))] {
        let mut problem = block(Dimension::Three, neo_hookean(1000.0)?, end);
        problem.regions[0].viscosity = Some(PronySeries::new(&BRAIN.1)?);
        stand(&mut problem);
        let point = Vector3::new(SIZE, 0.0, 0.0);
        problem.loads.tractions.push(Traction {
            name: "pull".into(),
            part: Selector::Plane { point, normal: Vector3::x(), tolerance: 1e-9 },
            traction: Vector3::new(traction, 0.0, 0.0).into(),
            amplitude: Amplitude::Constant,
        });
        let stretch = stretches(&solved(&problem)?)?.x;
        let state = uniaxial_stress(&neo_hookean(shear_modulus)?, stretch)
            .context("the lateral stretch has not converged")?;
        let error = (state.nominal_stress / traction - 1.0).abs();
        let label =
            format!("viscous bar under a dead load, {id}: stress of its stretch, relative error");
        let source = "neo-Hookean bar of the shear modulus that is left, lateral faces free";
        results.relative(&format!("creep/{id}"), &label, error, BOUND, source);
    }
    Ok(())
}

/// Muscle that nothing holds.
fn contraction(results: &mut Results) -> Result<()> {
    let law = neo_hookean(1000.0)?;
    let mut problem = block(Dimension::Three, law, 1.0);
    stand(&mut problem);
    let region = &mut problem.regions[0];
    region.fibres = Some(Fibres { fibre: Vector3::x().into(), sheet: None });
    let amplitude = Amplitude::Linear { duration: 1.0 };
    region.active = Some(ActiveStress { tension: TENSION, amplitude });
    let F = Matrix3::from_diagonal(&stretches(&solved(&problem)?)?);
    let active = F * Matrix3::from_diagonal(&Vector3::new(TENSION, 0.0, 0.0));
    let error = (law.first_piola_kirchhoff(&F) + active).amax() / active.amax();
    let label = "muscle that nothing holds: stress that is left over the active one";
    let source = "P + T F f ⊗ f = 0 (Land et al. 2015, section 2)";
    results.relative("contraction", label, error, BOUND, source);
    Ok(())
}
