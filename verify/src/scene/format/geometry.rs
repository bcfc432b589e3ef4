//! Shapes and selectors as they are written. Each is a table with one key that
//! names the kind.

use crate::files::LengthUnit;
use crate::scene::format::choice::choice;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

/// A vector in space: three numbers.
pub type Triple = [f64; 3];

/// A solid.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeFormat {
    /// Axis-parallel, between two corners [m].
    Box { min: Triple, max: Triple },
    /// From `base` [m] along `axis` (of any length) over `height` [m].
    Cylinder { base: Triple, axis: Triple, radius: f64, height: f64 },
    /// Centre and radius [m].
    Sphere { centre: Triple, radius: f64 },
    /// Axis-parallel with three semi-axes [m].
    Ellipsoid { centre: Triple, radii: Triple },
    /// A simple polygon in x and y [m], extruded from z[0] to z[1] [m].
    Polygon { points: Vec<[f64; 2]>, z: [f64; 2] },
    /// Everything behind the plane through `point` [m]; `normal` (of any
    /// length) points out.
    HalfSpace { point: Triple, normal: Triple },
    /// In at least one of these.
    Union(Vec<ShapeFormat>),
    /// The first without the second.
    Difference(Box<ShapeFormat>, Box<ShapeFormat>),
    /// A closed surface from an STL file, path relative to the case file.
    Stl {
        file: PathBuf,
        /// Unit of the coordinates in the file.
        unit: UnitFormat,
    },
    /// The voxels of some labels of an NRRD or NIfTI file, in the file's world
    /// coordinates turned to RAS. Path relative to the case file.
    LabelMap {
        file: PathBuf,
        labels: Vec<u32>,
        /// Overrides the unit that the file states (mm if it states none).
        unit: Option<UnitFormat>,
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
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SelectorFormat {
    /// Everything.
    All,
    /// Within `tolerance` of a plane.
    Plane { point: Triple, normal: Triple, tolerance: Option<f64> },
    /// Behind a plane; `normal` points out.
    HalfSpace { point: Triple, normal: Triple, tolerance: Option<f64> },
    /// In an axis-parallel box.
    Box { min: Triple, max: Triple, tolerance: Option<f64> },
    /// In a sphere.
    Sphere { centre: Triple, radius: f64, tolerance: Option<f64> },
    /// In any shape.
    Shape(ShapeFormat),
    /// In a voxel of this label.
    Label {
        value: u32,
        /// A label map, path relative to the case file; the body's own if
        /// left out.
        file: Option<PathBuf>,
        /// As for the shape `label_map`.
        unit: Option<UnitFormat>,
    },
    /// In at least one of these.
    Union(Vec<SelectorFormat>),
    /// In all of these.
    Intersection(Vec<SelectorFormat>),
    /// Not in this one.
    Not(Box<SelectorFormat>),
}
