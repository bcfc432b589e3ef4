//! The nodes of a body, with those on its borders and on the edges of held parts.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::Stiffness;
use crate::discretisation::nodes::{HeldParts, NodeCloud, node_cloud, place_nodes_on_borders};
use crate::error::Error;
use crate::geometry::{Extent, GeometryError, Panel, Shape};
use crate::problem::{Cloud, Dimension, Gradients, Problem};

/// Edge of the boundary panels over the smallest nodal spacing \[–\].
pub(super) const PANEL: f64 = 0.5;

/// The nodes, and what they were placed by.
pub(super) struct Placed {
    /// Those of what deforms.
    pub cloud: NodeCloud,
    /// Panels of the boundary with their edge \[m\], if anything needs them.
    pub panels: Option<(Vec<Panel>, f64)>,
    /// Of the two sides of sharp borders between materials, if there are any.
    pub stiffness: Option<Stiffness>,
}

impl Placed {
    /// Nodes of `body`, in a plane the section of the body of a problem, or its rest beside what is
    /// held as a volume.
    pub fn new(problem: &Problem, body: &Shape, is_rest: bool) -> Result<Placed, Error> {
        let (cloud, dimension) = (&problem.recipe.cloud, &problem.dimension);
        // A section has no ends; a lattice is laid into the body as it was given.
        let filled = if is_rest { body } else { &problem.body };
        let mut nodes = node_cloud(filled, cloud, dimension)?;
        let panels = panels_of(problem, body, &mut nodes)?;
        let stiffness = Stiffness::at_sharp_borders(problem);
        if let (Some(stiffness), false) = (&stiffness, matches!(cloud, Cloud::Given { .. })) {
            place_nodes_on_borders(&mut nodes, body, stiffness);
        }
        flatten(&mut nodes.positions, dimension);
        Ok(Placed { cloud: nodes, panels, stiffness })
    }
}

/// Puts places of a plane exactly there: to the correction of gradients a distance of
/// round-off across it would be a third direction, along which next to nothing changes
/// gradients as it likes.
pub(super) fn flatten(positions: &mut [Vector3], dimension: &Dimension) {
    if let Dimension::PlaneStrain { z, .. } = dimension {
        positions.iter_mut().for_each(|X| X.z = *z);
    }
}

/// The boundary in panels, if consistent gradients, loads or held parts need it. Nodes
/// of a cloud that is not given are put on the edges of held parts.
fn panels_of(
    problem: &Problem,
    body: &Shape,
    cloud: &mut NodeCloud,
) -> Result<Option<(Vec<Panel>, f64)>, Error> {
    let given = matches!(problem.recipe.cloud, Cloud::Given { .. });
    let held = !given && problem.conditions.iter().any(|c| c.extent == Extent::Surface);
    if !held && !needs_surface(problem) {
        return Ok(None);
    }
    let size = PANEL * cloud.smallest_spacing();
    let panels = body.boundary_panels(size, &problem.dimension)?;
    // A solid without itself has no boundary.
    if panels.is_empty() {
        return Err(GeometryError::NoVolume.into());
    }
    held.then(|| HeldParts::new(body, &problem.conditions, &panels, size).place_nodes(cloud));
    Ok(Some((panels, size)))
}

/// Whether consistent gradients or loads need the boundary.
pub(super) fn needs_surface(problem: &Problem) -> bool {
    problem.recipe.gradients != Gradients::Plain
        || problem.loads.parts_of_surface().next().is_some()
}
