//! How well prescribed displacements are met between the nodes of a surface.
#![allow(non_snake_case)]

use mtled::algebra::tensor::{Matrix3, Vector3, rotation};
use mtled::error::Error;
use mtled::geometry::Extent;
use mtled::problem::{EssentialCondition, Prescribed, Problem};
use mtled_run::run::Solved;

/// Edge of the panels on which the surface is sampled, over the smallest nodal
/// spacing \[–\]: several between two nodes.
const PANEL: f64 = 0.4;

/// Difference between the displacement field and the prescribed one, rms over the
/// constrained surfaces, over the largest displacement of a node \[–\]. None where no
/// surface is constrained at the end. Where a constrained part ends between two nodes,
/// its rim counts as constrained but is not.
pub(crate) fn boundary_misfit(problem: &Problem, solved: &Solved) -> Result<Option<f64>, Error> {
    let (discretisation, state) = (&solved.simulation.discretisation, &solved.simulation.state);
    let components = solved.simulation.model.components;
    let t = state.time;
    let active: Vec<&EssentialCondition> = (problem.conditions.iter())
        .filter(|condition| condition.extent == Extent::Surface)
        .filter(|condition| condition.release.is_none_or(|release| t < release))
        .collect();
    if active.is_empty() {
        return Ok(None);
    }
    let finest = discretisation.cloud.spacing.iter().copied().fold(f64::INFINITY, f64::min);
    let panels = problem.body.boundary_panels(PANEL * finest, &problem.dimension)?;
    let (mut squares, mut area) = (0.0, 0.0);
    for condition in active {
        let inside: Vec<_> =
            panels.iter().filter(|panel| condition.part.contains_panel(panel)).collect();
        let centres: Vec<Vector3> = inside.iter().map(|panel| panel.centre).collect();
        let rows = discretisation.rows_at(&centres)?;
        for (index, panel) in inside.iter().enumerate() {
            let u = rows.interpolate(index, &state.displacement, components);
            let prescribed = prescribed(condition, &panel.centre, t);
            let differences = (0..components).filter_map(|k| Some(u[k] - prescribed[k]?));
            squares += panel.area * differences.map(|d| d * d).sum::<f64>();
            area += panel.area;
        }
    }
    let displacements = state.displacement.chunks(components);
    let squared = displacements.map(|u| u.iter().map(|c| c * c).sum::<f64>());
    let largest = squared.fold(0.0, f64::max).sqrt();
    Ok((area > 0.0 && largest > 0.0).then(|| (squares / area).sqrt() / largest))
}

/// Displacement that a condition prescribes at a position, per component \[m\].
fn prescribed(condition: &EssentialCondition, X: &Vector3, t: f64) -> [Option<f64>; 3] {
    let factor = condition.amplitude.at(t);
    let u = match &condition.prescribed {
        Prescribed::Displacement(components) => {
            return components.map(|u| u.map(|u| factor * u));
        }
        Prescribed::Rotation { point, axis, angle } => {
            (rotation(axis, factor * angle) - Matrix3::identity()) * (X - point)
        }
        Prescribed::Field(field) => factor * field.at(X),
    };
    [Some(u.x), Some(u.y), Some(u.z)]
}
