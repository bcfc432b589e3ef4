//! How well held surfaces are held between their nodes.
#![allow(non_snake_case)]

use crate::run::Solved;
use mtled::algebra::tensor::{Matrix3, Vector3, rotation};
use mtled::error::Error;
use mtled::geometry::selection::Extent;
use mtled::problem::{EssentialCondition, Prescribed, Problem};

/// Edge of the panels at which the surface is looked at, over the smallest nodal
/// spacing \[–\]: several between two nodes.
const PANEL: f64 = 0.4;

/// rms over the held surfaces of what the displacement field differs from what is
/// prescribed, over the largest displacement of a node \[–\]; none where no surface is
/// held at the end. Where a held part ends between two nodes, its rim is not held.
pub fn held_misfit(problem: &Problem, solved: &Solved) -> Result<Option<f64>, Error> {
    let (discretisation, state) = (&solved.prepared.discretisation, &solved.state);
    let components = solved.prepared.model.components;
    let t = state.time;
    let held: Vec<&EssentialCondition> = (problem.conditions.iter())
        .filter(|condition| condition.extent == Extent::Surface)
        .filter(|condition| condition.release.is_none_or(|release| t < release))
        .collect();
    if held.is_empty() {
        return Ok(None);
    }
    let finest = discretisation.cloud.spacing.iter().copied().fold(f64::INFINITY, f64::min);
    let panels = problem.body.boundary_panels(PANEL * finest, &problem.dimension)?;
    let (mut squares, mut area) = (0.0, 0.0);
    for condition in held {
        let inside: Vec<_> =
            panels.iter().filter(|panel| condition.part.contains(&panel.centre)).collect();
        let centres: Vec<Vector3> = inside.iter().map(|panel| panel.centre).collect();
        let rows = discretisation.rows_at(&centres)?;
        for (index, panel) in inside.iter().enumerate() {
            let u = rows.interpolate(index, &state.displacement, components);
            let wanted = prescribed(condition, &panel.centre, t);
            let apart = (0..components).filter_map(|k| Some(u[k] - wanted[k]?));
            squares += panel.area * apart.map(|difference| difference * difference).sum::<f64>();
            area += panel.area;
        }
    }
    let moved = state.displacement.chunks(components);
    let largest = moved.map(|u| u.iter().map(|c| c * c).sum::<f64>()).fold(0.0, f64::max).sqrt();
    Ok((area > 0.0 && largest > 0.0).then(|| (squares / area).sqrt() / largest))
}

/// What a condition prescribes at a place, per component \[m\].
fn prescribed(condition: &EssentialCondition, X: &Vector3, t: f64) -> [Option<f64>; 3] {
    let factor = condition.amplitude.at(t);
    match &condition.prescribed {
        Prescribed::Displacement(components) => components.map(|u| u.map(|u| factor * u)),
        Prescribed::Rotation { point, axis, angle } => {
            let turn = rotation(axis, factor * angle) - Matrix3::identity();
            let u: Vector3 = turn * (X - point);
            [Some(u.x), Some(u.y), Some(u.z)]
        }
        Prescribed::Field(field) => {
            let u = factor * field.at(X);
            [Some(u.x), Some(u.y), Some(u.z)]
        }
    }
}
