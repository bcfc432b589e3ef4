//! Node clouds: positions and spacings (method book, section 5).

mod borders;
mod cloud;
mod curves;
mod given;
mod graded;
mod held_edges;
mod regular;

pub(crate) use borders::place_nodes_on_borders;
pub use cloud::{NodeCloud, refuse_fine_spacing};
pub use given::refuse_far_nodes;
pub use graded::{RequestedSizes, SizeField};
pub(crate) use held_edges::HeldParts;

use crate::geometry::{GeometryError, Shape, positive};
use crate::problem::{Cloud, Dimension};

/// Fills the body with nodes; in a plane, its cross-section. The same input
/// gives the same cloud, bit for bit.
pub fn node_cloud(
    body: &Shape,
    cloud: &Cloud,
    dimension: &Dimension,
) -> Result<NodeCloud, GeometryError> {
    body.validate_body()?;
    let section = body.section(dimension)?;
    let lattice = |spacing: f64, jitter: Option<(f64, u64)>| {
        positive("the nodal spacing", spacing)?;
        refuse_fine_spacing(&section, spacing, dimension)?;
        if let Some((jitter, _)) = jitter
            && !(0.0..0.5).contains(&jitter)
        {
            return Err(GeometryError::Jitter { jitter });
        }
        match body {
            Shape::Box { min, max } => Ok(regular::in_box(min, max, spacing, jitter, dimension)),
            _ => regular::in_solid(&section, spacing, jitter, dimension),
        }
    };
    let nodes = match cloud {
        Cloud::Regular { spacing } => lattice(*spacing, None)?,
        Cloud::Jittered { spacing, jitter, seed } => lattice(*spacing, Some((*jitter, *seed)))?,
        Cloud::Graded { spacing, refinements, growth, seed } => {
            let requested = RequestedSizes { spacing: *spacing, refinements, growth: *growth };
            graded::graded(&section, requested, *seed, dimension)?
        }
        Cloud::Given { nodes } => given::given(&section, nodes, dimension)?,
    };
    if nodes.positions.is_empty() { Err(GeometryError::NoNodes) } else { Ok(nodes) }
}

#[cfg(test)]
mod tests;
