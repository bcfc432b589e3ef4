//! Problems with a closed form.

use super::{Workbench, relative_error, spacing_of};
use crate::exact::{bar, torsion, uniaxial};
use crate::run::{march, prepare, solve_case};
use crate::scene::Case;
use crate::study::{Bound, Cell, Check, Column, Kind, Study, Table};
use anyhow::{Context, Result};
use mtled::material::{ElasticConstants, Law, LinearElastic, Material};
use mtled::observe::Unobserved;
use mtled::problem::{
    Amplitude, BodyForce, Dimension, EssentialCondition, Loads, Motion, Prescribed, Problem,
    Region, Relaxation,
};
use mtled::selection::{Extent, Selector};
use mtled::tensor::Vector3;

/// The bound on closed forms \[–\].
const BOUND: f64 = 0.01;

pub fn closed_forms(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut rows = Vec::new();
    let bar = with_dense_grid(bench.case("uniaxial_bar")?)?;
    stretch(&bar, study, &mut rows)?;
    twist(&with_dense_grid(bench.case("twisted_cylinder")?)?, study, &mut rows)?;
    column(&bar, study, &mut rows)?;
    study.notes.push(
        "Two cells per spacing here, instead of the default 1.26: with plain gradients the quadrature \
         error dominates otherwise (lateral displacement of the pulled bar then off by up to 3 %)."
            .into(),
    );
    let column = |name: &str, unit: &str| Column { name: name.into(), unit: unit.into() };
    study.tables.push(Table {
        title: "Computed against the closed form".into(),
        columns: vec![
            column("quantity", ""),
            column("unit", ""),
            column("computed", ""),
            column("closed form", ""),
            column("relative error", "1"),
        ],
        rows,
    });
    Ok(())
}

/// Two cells per spacing: quadrature dominates the error of these problems.
fn with_dense_grid(mut case: Case) -> Result<Case> {
    case.problem.recipe.grid.cell = 0.5 * spacing_of(&case.problem)?;
    Ok(case)
}

/// Adds a check of the relative error and its row in the table.
fn compare(
    study: &mut Study,
    rows: &mut Vec<Vec<Cell>>,
    (id, quantity, unit): (&str, &str, &str),
    (computed, exact): (f64, f64),
    source: &str,
) {
    let error = relative_error(computed, exact);
    let description = format!("{quantity}: relative error");
    study.checks.push(Check::new(
        id,
        &description,
        Kind::Exact,
        error,
        Bound::AtMost(BOUND),
        "1",
        source,
    ));
    rows.push(vec![
        Cell::Text(quantity.into()),
        Cell::Text(unit.into()),
        Cell::Number(computed),
        Cell::Number(exact),
        Cell::Number(error),
    ]);
}

/// A bar on rollers: homogeneous uniaxial stress.
fn stretch(case: &Case, study: &mut Study, rows: &mut Vec<Vec<Cell>>) -> Result<()> {
    let (solved, record) = solve_case(case)?;
    let last = record.samples.last().context("nothing was recorded")?;
    let (min, max) = case.problem.body.bounding_box().context("the bar has no bounds")?;
    let size = max - min;
    let pull = last.displacements[0].last().context("the bar has no probe")?;
    let stretch = 1.0 + pull.x / size.x;
    let law = &case.problem.regions[0].material.law;
    let exact = uniaxial::uniaxial_stress(law, stretch).context("no lateral stretch found")?;
    let force = last.reactions.last().context("the bar has no condition")?.force.x;
    let source = "Bonet and Wood 2008, section 6.4, lateral stress zero";
    let area = size.y * size.z;
    compare(
        study,
        rows,
        ("closed_forms/uniaxial_bar/force", "pulled bar, axial force", "N"),
        (force, exact.nominal_stress * area),
        source,
    );
    let thinning = exact.lateral_stretch - 1.0;
    compare(
        study,
        rows,
        ("closed_forms/uniaxial_bar/contraction", "pulled bar, lateral displacement", "m"),
        (pull.y, thinning * size.y),
        source,
    );
    study.notes.push(format!(
        "Pulled bar: {} nodes, {} quadrature points, {} steps.",
        solved.prepared.discretisation.cloud.positions.len(),
        solved.prepared.discretisation.supports.len(),
        solved.summary.steps
    ));
    Ok(())
}

/// A cylinder twisted between bonded ends.
fn twist(case: &Case, study: &mut Study, rows: &mut Vec<Vec<Cell>>) -> Result<()> {
    let (_, record) = solve_case(case)?;
    let last = record.samples.last().context("nothing was recorded")?;
    let reaction = last.reactions.last().context("the cylinder has no condition")?;
    let (min, max) = case.problem.body.bounding_box().context("the cylinder has no bounds")?;
    let (radius, length) = (0.5 * (max.x - min.x), max.z - min.z);
    let Some(Prescribed::Rotation { angle, .. }) =
        case.problem.conditions.last().map(|condition| condition.prescribed.clone())
    else {
        anyhow::bail!("the case does not turn the cylinder");
    };
    let mu = case.problem.regions[0].material.law.constants().shear_modulus;
    let exact = torsion::moment(mu, angle / length, radius);
    let source = "Rivlin 1949, incompressible neo-Hookean cylinder; ν = 0.49 here";
    compare(
        study,
        rows,
        ("closed_forms/twisted_cylinder/moment", "twisted cylinder, moment", "N·m"),
        (reaction.moment.z, exact),
        source,
    );
    let axial = torsion::axial_force(mu, angle / length, radius);
    study.notes.push(format!(
        "Twisted cylinder: axial force {:.5} N against {:.5} N for an incompressible material; \
         not gated, since it is of second order in the twist and depends on ν.",
        reaction.force.z, axial
    ));
    Ok(())
}

/// A confined column under its own weight, linear elastic.
fn column(case: &Case, study: &mut Study, rows: &mut Vec<Vec<Cell>>) -> Result<()> {
    let constants = ElasticConstants::from_young_poisson(3000.0, 0.3)?;
    let (density, gravity) = (1000.0, 0.1);
    let problem = column_problem(&case.problem, constants, density, gravity);
    let (min, max) = problem.body.bounding_box().context("the column has no bounds")?;
    let solved = march(&problem, prepare(&problem)?, &mut Unobserved)?;
    let exact = bar::ConfinedColumn { height: max.x - min.x, density, gravity, constants };
    let discretisation = &solved.prepared.discretisation;
    let top = Vector3::new(max.x, 0.5 * (min.y + max.y), 0.5 * (min.z + max.z));
    let computed = discretisation.rows_at(&[top])?.interpolate(0, &solved.state.displacement, 3).x;
    let source = "Timoshenko and Goodier, column with lateral strain zero";
    compare(
        study,
        rows,
        ("closed_forms/column/top", "confined column, sag of its top", "m"),
        (computed, exact.displacement(exact.height)),
        source,
    );
    Ok(())
}

/// The bar of `problem` stood on end: x is up, sides cannot move sideways.
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
        regions: vec![Region {
            name: "column".into(),
            part: Selector::All,
            material: Material { density, law: Law::LinearElastic(LinearElastic::new(constants)) },
        }],
        conditions: vec![
            roller("foot", foot, [Some(0.0), None, None]),
            roller("sides", Selector::All, [None, Some(0.0), Some(0.0)]),
        ],
        loads: Loads {
            body_forces: vec![BodyForce {
                acceleration: Vector3::new(-gravity, 0.0, 0.0).into(),
                amplitude: Amplitude::Smooth { duration: 1.0 },
            }],
            ..Loads::default()
        },
        motion: Motion::Static(Relaxation {
            load_end: 1.0,
            load_steps: 500,
            tolerance: 1e-5,
            max_steps: 100_000,
            step: Default::default(),
        }),
        ..problem.clone()
    }
}
