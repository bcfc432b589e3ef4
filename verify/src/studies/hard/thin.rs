//! Bodies that are a few nodes thick.

use crate::specimens::simple::{PLANE, SIZE, free_body, grid};
use crate::studies::hard::bodies::{SMOOTH, TURN, face, hard_recipe, prism, rubber, settle, turn};
use crate::studies::hard::cases::{case, measured, rolled};
use crate::studies::hard::run::{HardCase, Truth};
use anyhow::Result;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::Shape;
use mtled::geometry::selection::Selector;
use mtled::problem::{Dimension, Motion, Problem};

pub fn thin(spacing: f64, list: &mut Vec<HardCase>) -> Result<()> {
    let (problem, truth) = slice(1.0, spacing)?;
    let words = "slice one spacing thick, rollers, compressed by 20 %";
    list.push(case("slice_1", words, problem, truth));
    let (problem, truth) = slice(2.0, spacing)?;
    list.push(HardCase {
        limit: measured(
            1e-4,
            "measured 1.2e-5: closing the boundary gives nodes of the free side a vertical area, \
             1e-5 of the largest, that the uniform state pulls at",
        ),
        ..case("slice_2", "slice two spacings thick, rollers, compressed by 20 %", problem, truth)
    });
    let (mut problem, truth) = slice(2.0, spacing)?;
    problem.recipe.grid = grid(2.0 * spacing);
    if let Motion::Static(settings) = &mut problem.motion {
        settings.max_steps = 3000;
    }
    list.push(HardCase {
        ends: &["TooFewPoints"],
        ..case("slice_cell", "the same, one cell thick: fewer points than nodes", problem, truth)
    });
    let words = "bridge two nodes wide between blocks, pulled";
    list.push(case("bridge_2", words, bridge(2.0, spacing)?, Truth::Unknown));
    let words = "bridge three nodes wide, pulled";
    list.push(case("bridge_3", words, bridge(3.0, spacing)?, Truth::Unknown));
    let problem = Problem { dimension: PLANE, ..bridge(2.0, spacing)? };
    let words = "bridge two nodes wide in plane strain, pulled";
    list.push(case("bridge_2_plane", words, problem, Truth::Unknown));
    Ok(())
}

fn slice(spacings: f64, spacing: f64) -> Result<(Problem, Truth)> {
    let height = spacings * spacing;
    let body = prism(SIZE, height);
    let problem = free_body(Dimension::Three, body, rubber()?, hard_recipe(spacing, 5));
    rolled(problem, height, -0.2)
}

/// Two blocks joined by a bridge, `nodes` nodes wide and four spacings long,
/// one drawn away from the other by two spacings.
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
    let body = Shape::Polygon { points: outline.collect(), z: (0.0, 3.0 * spacing) };
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
    problem.motion = settle(1e-5, 800);
    Ok(problem)
}
