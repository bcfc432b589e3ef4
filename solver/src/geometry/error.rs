//! Reasons to refuse a shape or a node cloud.

use crate::algebra::tensor::Vector3;
use std::fmt::{Display, Formatter};

/// Why a shape or a node cloud is refused; lengths in \[m\].
#[allow(missing_docs, reason = "the messages name every field")]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GeometryError {
    #[error("{name} is {value}; it must be positive and finite")]
    NotPositive { name: &'static str, value: f64 },
    #[error("the box runs from {min} m to {max} m along axis {axis}; it must have an extent")]
    EmptyBox { axis: usize, min: f64, max: f64 },
    #[error("the extrusion runs from z = {from} m to {to} m; it must have a height")]
    EmptyExtrusion { from: f64, to: f64 },
    #[error("{name} has length {length}; it must be a unit vector")]
    NotUnit { name: &'static str, length: f64 },
    #[error("{name} has a coordinate that is not finite")]
    NotFinite { name: &'static str },
    #[error("the polygon has {count} points; it needs at least 3")]
    TooFewPoints { count: usize },
    #[error("edges {first} and {second} of the polygon cross or touch")]
    PolygonCrosses { first: usize, second: usize },
    #[error("the {shape} has no members")]
    NoMembers { shape: &'static str },
    #[error("the members of the intersection have nothing in common")]
    NothingInCommon,
    #[error("the {shape} is unbounded, so nodes or panels cannot cover its boundary")]
    Unbounded { shape: &'static str },
    #[error("the {shape} cannot be cut at z = {z} m into a plane cross-section")]
    SectionUnsupported { shape: &'static str, z: f64 },
    #[error("the {shape} does not reach the plane z = {z} m")]
    SectionEmpty { shape: &'static str, z: f64 },

    #[error("the label map of {size:?} voxels holds {count} labels; it needs {expected}")]
    LabelCount { size: [usize; 3], count: usize, expected: usize },
    #[error(
        "the voxels of the label map are {edge:e} m long along index {axis}; from 1e-9 to 1000 m are possible: check the steps and the unit of the file"
    )]
    VoxelEdge { axis: usize, edge: f64 },
    #[error(
        "the label map begins {distance:e} m from the origin of its coordinates; {farthest:e} m are possible: check the origin and the unit of the file"
    )]
    FarOrigin { distance: f64, farthest: f64 },
    #[error("the label map directions have determinant {determinant} m³")]
    SingularDirections { determinant: f64 },
    #[error("label map directions {first} and {second} enclose a cosine of {cosine}, not 0")]
    SkewDirections { first: usize, second: usize, cosine: f64 },
    #[error("no voxel has label {label}")]
    NoSuchLabel { label: u32 },
    #[error("no label was chosen")]
    NoLabels,
    #[error(
        "the label map is smoothed by {smoothing} voxels; above 0 and at most {most} are possible"
    )]
    Smoothing { smoothing: f64, most: f64 },

    #[error("the surface has {vertices} vertices and {triangles} triangles")]
    SurfaceEmpty { vertices: usize, triangles: usize },
    #[error("triangle {triangle} uses vertex {vertex} of {count}")]
    SurfaceVertex { triangle: usize, vertex: u32, count: usize },
    #[error("the surface is not closed: {0}")]
    SurfaceOpen(#[from] Box<EdgeFaults>),
    #[error(
        "the triangles enclose nothing: they lie on each other, as where each is there once in either direction; export the surface with one side only"
    )]
    SurfaceFlat,
    #[error(
        "shells {first} and {second} of the {count} that the surface consists of cross near {at:?} m: give each a surface of its own and make a union of these"
    )]
    ShellsCross { first: usize, second: usize, count: usize, at: [f64; 3] },
    #[error(
        "shells {first} and {second} of the {count} that the surface consists of cross near {at:?} m, and one of them faces inwards: if it is to be taken away, give each a file of its own and use their `difference`; else turn its triangles outwards"
    )]
    CavityCrosses { first: usize, second: usize, count: usize, at: [f64; 3] },

    #[error("the body encloses no volume: its shapes leave nothing of each other")]
    NoVolume,
    #[error("no node lies in the body")]
    NoNodes,
    #[error("{count} nodes are too few; at least {needed} are needed")]
    TooFewNodes { count: usize, needed: usize },
    #[error("jitter is {jitter}; it must lie in 0 ≤ jitter < 0.5")]
    Jitter { jitter: f64 },
    #[error("about {count:.3e} {what} would be needed; the limit is {limit:.0e}: {remedy}")]
    TooMany { what: &'static str, count: f64, limit: f64, remedy: &'static str },
    #[error("the background grid has {count} Gauss points per direction; it must have 1 to 5")]
    GaussPoints { count: usize },
    #[error("refinement {refinement} of size {size} m contains no point of the body")]
    RefinementEmpty { refinement: usize, size: f64 },
    #[error(
        "node {node} at ({:?}, {:?}, {:?}) m lies far outside the body, which is {extent:.4} m across: give positions in metres",
        position[0], position[1], position[2]
    )]
    NodeFarOutside { node: usize, position: [f64; 3], extent: f64 },
    #[error("node {node} lies {distance} m outside the body, where nodes are {spacing} m apart")]
    NodeOutside { node: usize, distance: f64, spacing: f64 },
    #[error("nodes {first} and {second} are {distance} m apart")]
    DuplicateNodes { first: usize, second: usize, distance: f64 },
}

/// `value` must be positive and finite.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), GeometryError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(GeometryError::NotPositive { name, value })
    }
}

/// Edges at which triangles are not closed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EdgeFaults {
    /// With one triangle alone.
    pub open: EdgeFault,
    /// With two that run along the edge in the same direction.
    pub turned: EdgeFault,
    /// With three or more, not as many in one direction as in the other.
    pub crowded: EdgeFault,
}

/// Edges with the same fault.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EdgeFault {
    /// Number of edges.
    pub count: usize,
    /// Ends of the first \[m\].
    pub first: Option<[[f64; 3]; 2]>,
}

impl EdgeFault {
    /// Counts an edge with its ends \[m\].
    pub(crate) fn add(&mut self, ends: [Vector3; 2]) {
        self.count += 1;
        self.first.get_or_insert(ends.map(Into::into));
    }
}

impl std::error::Error for EdgeFaults {}

impl Display for EdgeFaults {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        let kinds = [
            (self.open, "have one triangle only, as at a hole", "close it"),
            (self.turned, "lie between triangles of which one faces inwards", "orient them alike"),
            (self.crowded, "have three or more triangles that do not pair", "remove inner ones"),
        ];
        let mut start = "";
        for (fault, what, cure) in kinds {
            if let Some([from, to]) = fault.first {
                let count = fault.count;
                write!(
                    f,
                    "{start}{count} edges {what}, the first from {from:?} m to {to:?} m ({cure})"
                )?;
                start = "; ";
            }
        }
        Ok(())
    }
}
