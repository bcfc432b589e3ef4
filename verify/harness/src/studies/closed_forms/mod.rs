//! Problems with a closed form.

mod contact;
mod extra_stress;
mod inclusion;
mod motion;
mod results;

use crate::exact::homogeneous::{biaxial, shear, uniaxial};
use crate::exact::{bar, torsion};
use crate::studies::closed_forms::contact::contact;
use crate::studies::closed_forms::extra_stress::extra_stress;
use crate::studies::closed_forms::inclusion::inclusions;
use crate::studies::closed_forms::motion::{swing, wave};
use crate::studies::closed_forms::results::Results;
use crate::studies::workbench::Workbench;
use anyhow::{Context, Result};
use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::{Extent, Selector};
use mtled::material::{ElasticConstants, Law, LinearElastic, Material};
use mtled::motion::observe::Unobserved;
use mtled::problem::{
    Amplitude, BodyForce, Dimension, EssentialCondition, Field, Loads, Motion, Prescribed, Problem,
    Region,
};
use mtled_case::scene::Case;
use mtled_checks::measure::larger;
use mtled_checks::study::{Study, Table, number, text};
use mtled_run::run::{integrate, solve_case};
use mtled_run::specimens::simple::relaxation;
use mtled_run::specimens::spacing::spacing_of;

pub(crate) fn closed_forms(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut results = Results::default();
    let bar = with_dense_grid(bench.case("uniaxial_bar")?)?;
    stretch(&bar, study, &mut results)?;
    stretch_both_ways(&bar, &mut results)?;
    shear(&bar, &mut results)?;
    rotate(&bar, &mut results)?;
    twist(&with_dense_grid(bench.case("twisted_cylinder")?)?, study, &mut results)?;
    column(&bar, &mut results)?;
    swing(&mut results)?;
    contact(bench, &mut results)?;
    extra_stress(&mut results)?;
    study.checks.append(&mut results.checks);
    study.notes.push(
        "Two cells per spacing here, instead of the default 1.26: with plain gradients the quadrature \
         error dominates otherwise (up to 3 % in the lateral displacement of the pulled bar)."
            .into(),
    );
    study.notes.push(
        "Hertz's half-space is a block eight contact radii to each side, moved at its far faces as \
         a half-space under a point force. The spherical shell is a formula only."
            .into(),
    );
    study.tables.push(Table {
        title: "Computed against the closed form".into(),
        columns: vec![
            text("quantity"),
            text("unit"),
            number("computed", ""),
            number("closed form", ""),
            number("relative error", "1"),
        ],
        rows: results.rows,
    });
    inclusions(bench, study)
}

/// Two cells per spacing: quadrature dominates the error of these problems.
fn with_dense_grid(mut case: Case) -> Result<Case> {
    case.problem.recipe.grid.cell = 0.5 * spacing_of(&case.problem)?;
    Ok(case)
}

/// A bar on rollers: homogeneous uniaxial stress.
fn stretch(case: &Case, study: &mut Study, results: &mut Results) -> Result<()> {
    let (solved, record) = solve_case(case)?;
    let last = record.samples.last().context("the record is empty")?;
    let (min, max) = case.problem.body.bounding_box().context("the bar has no bounds")?;
    let size = max - min;
    let pull = last.displacements[0].last().context("the bar has no probe")?;
    let stretch = 1.0 + pull.x / size.x;
    let law = &case.problem.regions[0].material.law;
    let exact =
        uniaxial::uniaxial_stress(law, stretch).context("the lateral stretch has not converged")?;
    let force = last.reactions.last().context("the bar has no condition")?.force.x;
    let source = "Bonet and Wood 2008, section 6.4, lateral stress zero";
    let area = size.y * size.z;
    results.value(
        ("uniaxial_bar/force", "pulled bar, axial force", "N"),
        (force, exact.nominal_stress * area),
        source,
    );
    let thinning = exact.lateral_stretch - 1.0;
    results.value(
        ("uniaxial_bar/contraction", "pulled bar, lateral displacement", "m"),
        (pull.y, thinning * size.y),
        source,
    );
    study.notes.push(format!(
        "Pulled bar: {} nodes, {} quadrature points, {} steps.",
        solved.simulation.discretisation.cloud.positions.len(),
        solved.simulation.discretisation.supports.len(),
        solved.summary.steps
    ));
    Ok(())
}

/// The bar pulled by 20 % along x and by 10 % along y: biaxial stress.
fn stretch_both_ways(case: &Case, results: &mut Results) -> Result<()> {
    let mut case = case.clone();
    let (min, max) = case.problem.body.bounding_box().context("the bar has no bounds")?;
    let size = max - min;
    let stretches = [1.2, 1.1];
    let mut pull = case.problem.conditions.last().context("the bar has no condition")?.clone();
    pull.part = Selector::Plane { point: max, normal: Vector3::y(), tolerance: 1e-6 };
    let by = (stretches[1] - 1.0) * size.y;
    pull.prescribed = Prescribed::Displacement([None, Some(by), None]);
    case.problem.conditions.push(pull);
    let (_, record) = solve_case(&case)?;
    let last = record.samples.last().context("the record is empty")?;
    let corner = last.displacements[0].last().context("the bar has no probe")?;
    let law = &case.problem.regions[0].material.law;
    let exact =
        biaxial::biaxial_stress(law, stretches).context("the lateral stretch has not converged")?;
    let force = last.reactions.last().context("the bar has no condition")?.force.y;
    let source = "Rivlin and Saunders 1951, free face";
    results.value(
        ("biaxial/force", "sheet pulled both ways, transverse force", "N"),
        (force, exact.nominal_stress[1] * size.x * size.z),
        source,
    );
    results.value(
        ("biaxial/thinning", "sheet pulled both ways, displacement of its face", "m"),
        (corner.z, (exact.lateral_stretch - 1.0) * size.z),
        source,
    );
    Ok(())
}

/// The boundary of the bar in simple shear: mean shear stress.
fn shear(case: &Case, results: &mut Results) -> Result<()> {
    let amount = 0.3;
    let sheared = Prescribed::Field(Field::of(move |at| Vector3::x() * (amount * at.y)));
    let stress = stress_inside(case, sheared, relaxation(500, 1e-6))?;
    let exact = shear::nominal_stress(&case.problem.regions[0].material.law, amount);
    results.value(
        ("simple_shear/stress", "sheared bar, mean nominal shear stress", "Pa"),
        (stress.mean[(0, 1)], exact[(0, 1)]),
        "Ogden 1984, section 2.2.6, P(I + γ e₁⊗e₂)",
    );
    Ok(())
}

/// The boundary of the bar rotated by 60°: no stress.
fn rotate(case: &Case, results: &mut Results) -> Result<()> {
    let angle = std::f64::consts::FRAC_PI_3;
    let axis = Vector3::new(1.0, 2.0, 2.0) / 3.0;
    let rotated = Prescribed::Rotation { point: Vector3::zeros(), axis, angle };
    // Relaxation relates its residual to the forces, which vanish here.
    let damped = Motion::Dynamic { end: 1.5, step: Default::default(), damping: 100.0 };
    let stress = stress_inside(case, rotated, damped)?;
    let modulus = case.problem.regions[0].material.law.constants().shear_modulus;
    results.relative(
        "rigid_rotation/stress",
        "bar rotated by 60° at its boundary: largest stress over the shear modulus",
        stress.largest / modulus,
        1e-9,
        "objectivity: P(R) = 0; damped for half a second after the rotation",
    );
    Ok(())
}

/// First Piola–Kirchhoff stress at the quadrature points \[Pa\].
struct StressInside {
    /// Over the reference volume.
    mean: Matrix3,
    largest: f64,
}

/// The case with its whole boundary prescribed.
fn stress_inside(case: &Case, prescribed: Prescribed, motion: Motion) -> Result<StressInside> {
    let amplitude = Amplitude::Smooth { duration: 1.0 };
    let boundary = EssentialCondition {
        name: "boundary".into(),
        extent: Extent::Surface,
        part: Selector::All,
        prescribed,
        amplitude,
        release: None,
    };
    let problem = Problem { conditions: vec![boundary], motion, ..case.problem.clone() };
    let solved = integrate(Simulation::with_any_recipe(&problem)?, &mut Unobserved)?;
    let discretisation = &solved.simulation.discretisation;
    let law = problem.regions[0].material.law;
    let (mut mean, mut volume, mut largest) = (Matrix3::zeros(), 0.0, 0.0);
    for (point, weight) in discretisation.quadrature.weights.iter().enumerate() {
        let rows = &discretisation.supports;
        let gradient = rows.deformation_gradient(point, &solved.simulation.state.displacement, 3);
        let stress = law.first_piola_kirchhoff(&gradient);
        mean += stress * *weight;
        volume += weight;
        largest = larger(largest, stress.amax());
    }
    Ok(StressInside { mean: mean / volume, largest })
}

/// A cylinder twisted between bonded ends.
fn twist(case: &Case, study: &mut Study, results: &mut Results) -> Result<()> {
    let (_, record) = solve_case(case)?;
    let last = record.samples.last().context("the record is empty")?;
    let reaction = last.reactions.last().context("the cylinder has no condition")?;
    let (min, max) = case.problem.body.bounding_box().context("the cylinder has no bounds")?;
    let (radius, length) = (0.5 * (max.x - min.x), max.z - min.z);
    let Some(Prescribed::Rotation { angle, .. }) =
        case.problem.conditions.last().map(|condition| condition.prescribed.clone())
    else {
        anyhow::bail!("the case does not rotate the cylinder");
    };
    let mu = case.problem.regions[0].material.law.constants().shear_modulus;
    let exact = torsion::moment(mu, angle / length, radius);
    let source = "Rivlin 1949, incompressible neo-Hookean cylinder; ν = 0.49 here";
    results.value(
        ("twisted_cylinder/moment", "twisted cylinder, moment", "N·m"),
        (reaction.moment.z, exact),
        source,
    );
    let axial = torsion::axial_force(mu, angle / length, radius);
    study.notes.push(format!(
        "Twisted cylinder: axial force {:.5} N against {:.5} N for an incompressible material; \
         not checked, since it is of second order in the twist and depends on ν.",
        reaction.force.z, axial
    ));
    Ok(())
}

/// A confined column under its own weight, linear elastic.
fn column(case: &Case, results: &mut Results) -> Result<()> {
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.3)?;
    let (density, gravity) = (1000.0, 0.1);
    let problem = column_problem(&case.problem, constants, density, gravity);
    let (min, max) = problem.body.bounding_box().context("the column has no bounds")?;
    let solved = integrate(Simulation::with_any_recipe(&problem)?, &mut Unobserved)?;
    let exact = bar::ConfinedColumn { height: max.x - min.x, density, gravity, constants };
    let discretisation = &solved.simulation.discretisation;
    let top = Vector3::new(max.x, 0.5 * (min.y + max.y), 0.5 * (min.z + max.z));
    let computed =
        discretisation.rows_at(&[top])?.interpolate(0, &solved.simulation.state.displacement, 3).x;
    let source = "Timoshenko and Goodier, column with lateral strain zero";
    results.value(
        ("column/top", "confined column, sag of its top", "m"),
        (computed, exact.displacement(exact.height)),
        source,
    );
    wave(problem, &exact, top, results)
}

/// The bar of `problem` as a column: x is up, the sides cannot move laterally.
fn column_problem(
    problem: &Problem,
    constants: ElasticConstants,
    density: f64,
    gravity: f64,
) -> Problem {
    let roller = |name: &str, part: Selector, fixed: [Option<f64>; 3]| EssentialCondition {
        name: name.into(),
        extent: Extent::Volume,
        part,
        prescribed: Prescribed::Displacement(fixed),
        amplitude: Amplitude::Constant,
        release: None,
    };
    let foot = Selector::Plane { point: Vector3::zeros(), normal: Vector3::x(), tolerance: 1e-6 };
    Problem {
        dimension: Dimension::Three,
        regions: vec![Region::new(
            "column",
            Selector::All,
            Material { density, law: Law::LinearElastic(LinearElastic::new(constants)) },
        )],
        conditions: vec![
            roller("foot", foot, [Some(0.0), None, None]),
            roller("sides", Selector::All, [None, Some(0.0), Some(0.0)]),
        ],
        loads: Loads {
            body_forces: vec![BodyForce {
                part: Selector::All,
                acceleration: Vector3::new(-gravity, 0.0, 0.0).into(),
                amplitude: Amplitude::Smooth { duration: 1.0 },
            }],
            ..Loads::default()
        },
        motion: relaxation(500, 1e-5),
        ..problem.clone()
    }
}
