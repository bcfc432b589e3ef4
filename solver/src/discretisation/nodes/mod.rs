//! Node clouds: where the nodes are and how far apart.
#![allow(non_snake_case)]

mod given;
mod graded;
mod random;
mod regular;

pub use graded::{SizeField, WantedSizes};

use crate::algebra::tensor::Vector3;
use crate::geometry::{GeometryError, Shape, positive};
use crate::problem::{Cloud, Dimension};

/// Nodes in the reference configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeCloud {
    /// \[node\], \[m\]
    pub positions: Vec<Vector3>,
    /// Local nodal spacing \[node\], \[m\].
    pub spacing: Vec<f64>,
    /// Whether a node lies on the boundary of the body \[node\].
    pub on_boundary: Vec<bool>,
}

/// More nodes than this are refused.
const MOST_NODES: f64 = 2e7;

/// Fills the body with nodes; in a plane, its cross-section. The same input
/// gives the same cloud, bit for bit.
pub fn node_cloud(
    body: &Shape,
    cloud: &Cloud,
    dimension: &Dimension,
) -> Result<NodeCloud, GeometryError> {
    body.validate_body()?;
    let section = body.section(dimension)?;
    let nodes = match cloud {
        Cloud::Regular { spacing } => {
            positive("the nodal spacing", *spacing)?;
            match body {
                Shape::Box { min, max } => regular::in_box(min, max, *spacing, None, dimension)?,
                _ => regular::in_solid(&section, *spacing, None, dimension)?,
            }
        }
        Cloud::Jittered { spacing, jitter, seed } => {
            positive("the nodal spacing", *spacing)?;
            if !(0.0..0.5).contains(jitter) {
                return Err(GeometryError::Jitter { jitter: *jitter });
            }
            let random = Some((*jitter, *seed));
            match body {
                Shape::Box { min, max } => regular::in_box(min, max, *spacing, random, dimension)?,
                _ => regular::in_solid(&section, *spacing, random, dimension)?,
            }
        }
        Cloud::Graded { spacing, refinements, growth, seed } => {
            let wanted = WantedSizes { spacing: *spacing, refinements, growth: *growth };
            graded::graded(&section, wanted, *seed, dimension)?
        }
        Cloud::Given { nodes } => given::given(&section, nodes, dimension)?,
    };
    if nodes.positions.is_empty() { Err(GeometryError::NoNodes) } else { Ok(nodes) }
}

/// Refuses a cloud before it is made.
fn refuse_too_many(count: f64) -> Result<(), GeometryError> {
    if count <= MOST_NODES {
        Ok(())
    } else {
        Err(GeometryError::TooMany { what: "nodes", count, limit: MOST_NODES })
    }
}

#[cfg(test)]
mod tests;
