//! Shapes and selectors as they are written. Each is a table with one key that
//! names the kind.

use crate::scene::format::choice::choice;
use mtled_io::files::LengthUnit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A vector in space: three numbers.
pub(crate) type Triple = [f64; 3];

/// A solid.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeFormat {
    /// Axis-parallel, between two corners [m].
    Box {
        /// Corner with the smallest coordinates [m].
        min: Triple,
        /// Opposite corner [m].
        max: Triple,
    },
    /// From `base` [m] along `axis` (of any length) over `height` [m].
    Cylinder {
        /// Centre of the circle at its foot [m].
        base: Triple,
        /// Direction from there, of any length [–].
        axis: Triple,
        /// Radius [m].
        radius: f64,
        /// Length along the axis [m].
        height: f64,
    },
    /// Centre and radius [m].
    Sphere {
        /// Centre [m].
        centre: Triple,
        /// Radius [m].
        radius: f64,
    },
    /// Axis-parallel with three semi-axes [m].
    Ellipsoid {
        /// Centre [m].
        centre: Triple,
        /// Semi-axes along x, y and z [m].
        radii: Triple,
    },
    /// A simple polygon in x and y [m], extruded from z[0] to z[1] [m].
    Polygon {
        /// Its corners in order, x and y of each [m].
        points: Vec<[f64; 2]>,
        /// Lower and upper end [m].
        z: [f64; 2],
    },
    /// Everything behind the plane through `point` [m]; `normal` (of any
    /// length) points out.
    HalfSpace {
        /// A point of the plane [m].
        point: Triple,
        /// Outward direction, of any length [–].
        normal: Triple,
    },
    /// In at least one of these.
    Union(Vec<ShapeFormat>),
    /// What all of these have in common.
    Intersection(Vec<ShapeFormat>),
    /// The first without the second.
    Difference(Box<ShapeFormat>, Box<ShapeFormat>),
    /// A closed surface from a file: STL, OBJ, PLY, or PolyData of VTK (.vtp or legacy .vtk), as
    /// the extension of its name says. Path relative to the case file. Faces of more than three
    /// corners are cut into triangles; lines and points are left out. It may consist of several
    /// shells; those that cross are united, cavities are those whose triangles face inwards.
    Stl {
        /// The file (.stl, .obj, .ply, .vtp, .vtk), as text or binary, all its solids, objects or
        /// pieces. Vertices no further apart than 1e-9 of the size of the surface are one.
        /// Coordinates are along R, A and S; where the header, a comment or the name of a solid
        /// says `SPACE=LPS`, x and y change their signs.
        file: PathBuf,
        /// Unit of the coordinates in the file.
        unit: UnitFormat,
    },
    /// The voxels of some labels of an NRRD or NIfTI file, in the file's world
    /// coordinates turned to RAS. Path relative to the case file.
    LabelMap {
        /// The NRRD or NIfTI file.
        file: PathBuf,
        /// Values of the voxels that belong to the shape.
        labels: Vec<u32>,
        /// Overrides the unit that the file states (mm if it states none); that of the file if
        /// left out.
        unit: Option<UnitFormat>,
        /// Which layer of a file of 3D Slicer (.seg.nrrd) whose segments overlap, counted from 0;
        /// left out, the file must have one.
        layer: Option<usize>,
        /// Standard deviation of the smoothing of the surface [voxel], at most 4: 0.7 if
        /// left out; 1.4 flattens the steps between voxels that contact would feel.
        smoothing: Option<f64>,
    },
}

choice! {
    /// A unit of length.
    UnitFormat for LengthUnit {
        "m" Metre,
        "mm" Millimetre,
    }
}

/// A part of the body or of its boundary: "all" or a table with one key.
/// Tolerances are lengths [m]; left out, they are a thousandth of the nodal
/// spacing.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SelectorFormat {
    /// Everything.
    All,
    /// Within `tolerance` of a plane.
    Plane {
        /// A point of the plane [m].
        point: Triple,
        /// Its normal, of any length [–].
        normal: Triple,
        /// Distance that still counts [m]; a thousandth of the nodal spacing if left out.
        tolerance: Option<f64>,
    },
    /// Behind a plane; `normal` points out.
    HalfSpace {
        /// A point of the plane [m].
        point: Triple,
        /// Outward direction, of any length [–].
        normal: Triple,
        /// Distance that still counts [m]; a thousandth of the nodal spacing if left out.
        tolerance: Option<f64>,
    },
    /// In an axis-parallel box.
    Box {
        /// Corner with the smallest coordinates [m].
        min: Triple,
        /// Opposite corner [m].
        max: Triple,
        /// Distance that still counts [m]; a thousandth of the nodal spacing if left out.
        tolerance: Option<f64>,
    },
    /// In a sphere.
    Sphere {
        /// Centre [m].
        centre: Triple,
        /// Radius [m].
        radius: f64,
        /// Distance that still counts [m]; a thousandth of the nodal spacing if left out.
        tolerance: Option<f64>,
    },
    /// In any shape.
    Shape(ShapeFormat),
    /// In a voxel of this label.
    Label {
        /// The label.
        value: u32,
        /// A label map, path relative to the case file; the body's own if
        /// left out.
        file: Option<PathBuf>,
        /// Overrides the unit that the file states; that of the file if left out.
        unit: Option<UnitFormat>,
        /// Which layer of a `file` whose segments overlap, counted from 0; left out, that file
        /// must have one.
        layer: Option<usize>,
    },
    /// Where the outward normal of the body is near a direction: a flat face of a surface, or
    /// one side of an organ. Away from the boundary, the normal at its nearest place.
    Facing {
        /// The direction, of any length [–].
        direction: Triple,
        /// Largest angle between the normal and the direction [rad]: 0 < angle < π.
        angle: f64,
    },
    /// In at least one of these.
    Union(Vec<SelectorFormat>),
    /// In all of these.
    Intersection(Vec<SelectorFormat>),
    /// Not in this one.
    Not(Box<SelectorFormat>),
}
