//! Bodies that are a few nodes thick.

use crate::studies::hard::bodies::{SMOOTH, TURN, face, hard_recipe, prism, relax, rubber, turn};
use crate::studies::hard::case::{Expected, HardCase, Limit, case, rolled};
use anyhow::Result;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{Selector, Shape};
use mtled::problem::{BackgroundGrid, Dimension, Problem};
use mtled_run::specimens::simple::{PLANE, SIZE, free_body};

/// Adds the cases to the list.
pub(crate) fn thin(spacing: f64, list: &mut Vec<HardCase>) -> Result<()> {
    let (problem, expected) = slice(1.0, spacing)?;
    let label = "slice one spacing thick, rollers, compressed by 20 %";
    list.push(case("slice_1", label, problem, expected));
    let (problem, expected) = slice(2.0, spacing)?;
    list.push(HardCase {
        limit: Some(Limit::Stored(
            "closing the boundary gives nodes of the free side a vertical area, 1e-5 of the largest, on \
             which the uniform stress acts",
        )),
        ..case("slice_2", "slice two spacings thick, rollers, compressed by 20 %", problem, expected)
    });
    let (mut problem, expected) = slice(2.0, spacing)?;
    problem.recipe.grid = BackgroundGrid::with_cell(2.0 * spacing);
    if let Some(settings) = problem.motion.relaxation_mut() {
        settings.max_steps = 3000;
    }
    list.push(HardCase {
        // Nodes without stiffness have no fictitious mass either, by which rows are weighed.
        ends: &["TooFewPoints", "DependentConstraints"],
        ..case("slice_cell", "the same, one cell thick: fewer points than nodes", problem, expected)
    });
    let label = "bridge two nodes wide between blocks, pulled";
    list.push(case("bridge_2", label, bridge(2.0, spacing)?, Expected::Unknown));
    let label = "bridge three nodes wide, pulled";
    list.push(case("bridge_3", label, bridge(3.0, spacing)?, Expected::Unknown));
    let problem = Problem { dimension: PLANE, ..bridge(2.0, spacing)? };
    let label = "bridge two nodes wide in plane strain, pulled";
    list.push(case("bridge_2_plane", label, problem, Expected::Unknown));
    Ok(())
}

fn slice(spacings: f64, spacing: f64) -> Result<(Problem, Expected)> {
    let height = spacings * spacing;
    let body = prism(SIZE, height);
    let problem = free_body(Dimension::Three, body, rubber()?, hard_recipe(spacing, 5));
    rolled(problem, height, -0.2)
}

/// Two blocks joined by a bridge, `nodes` nodes wide and four spacings long, one moved away from the
/// other by two spacings.
fn bridge(nodes: f64, spacing: f64) -> Result<Problem> {
    let (a, l) = (0.5 * (nodes - 1.0) * spacing, 2.0 * spacing);
    let (w, e) = (0.25 * SIZE, 2.0 * spacing + 0.5 * SIZE);
    let quarter = [[l, a], [l, w], [e, w]];
    let outline = [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]].iter().flat_map(|s| {
        let mut corners = quarter.map(|p| turn([s[0] * p[0], s[1] * p[1]]));
        if s[0] * s[1] > 0.0 {
            corners.reverse();
        }
        corners
    });
    let body =
        Shape::Polygon { points: outline.collect::<Vec<_>>().into(), z: (0.0, 3.0 * spacing) };
    let mut problem = free_body(Dimension::Three, body, rubber()?, hard_recipe(spacing, 5));
    let along = Vector3::new(TURN.cos(), TURN.sin(), 0.0);
    let end = |sign: f64, by: Vector3| {
        let mut condition = face(0.0, [Some(by.x), Some(by.y), Some(by.z)], SMOOTH);
        condition.name = format!("end at {} m", sign * e);
        let point = along * (sign * (e - 0.01 * spacing));
        let shape = Shape::HalfSpace { point, normal: -along * sign };
        condition.part = Selector::Inside { shape, tolerance: 0.0 };
        condition
    };
    problem.conditions = vec![end(-1.0, Vector3::zeros()), end(1.0, along * (2.0 * spacing))];
    problem.motion = relax(1e-5, 800);
    Ok(problem)
}
