//! Shapes and selections in a job: every kind has a key `kind`, lengths end in `_m`.

use crate::scene::format::{SelectorFormat, ShapeFormat, Triple, UnitFormat};
use mtled::geometry::LabelField;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A solid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Shape {
    /// Axis-parallel, between two corners.
    Box { min_m: Triple, max_m: Triple },
    /// From the centre of its base along its axis (of any length).
    Cylinder { base_m: Triple, axis: Triple, radius_m: f64, height_m: f64 },
    /// A ball.
    Sphere { centre_m: Triple, radius_m: f64 },
    /// Axis-parallel with three semi-axes.
    Ellipsoid { centre_m: Triple, radii_m: Triple },
    /// A simple polygon in x and y, extruded from z_m[0] to z_m[1].
    Polygon { points_m: Vec<[f64; 2]>, z_m: [f64; 2] },
    /// Everything behind a plane; the normal (of any length) points out.
    HalfSpace { point_m: Triple, normal: Triple },
    /// In at least one of these.
    Union { of: Vec<Shape> },
    /// In all of these.
    Intersection { of: Vec<Shape> },
    /// In the first, not in the second.
    Difference { of: Box<[Shape; 2]> },
    /// A closed surface from a file that is, as its extension says, STL, OBJ, PLY, or PolyData of
    /// VTK (.vtp or legacy .vtk). The file has the given unit.
    Stl { file: PathBuf, unit: UnitFormat },
    /// The voxels of some labels of an NRRD or NIfTI file, in its world coordinates turned to
    /// RAS. The unit is that of the file where it is null (mm if the file states none). The
    /// surface is the level 1/2 of the voxels smoothed with this standard deviation.
    /// Of a file with layers of overlapping segments the layer says which is meant, from 0.
    LabelMap {
        file: PathBuf,
        labels: Vec<u32>,
        unit: Option<UnitFormat>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        layer: Option<usize>,
        smoothing_voxels: f64,
    },
}

/// A part of the body or of its boundary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Selection {
    /// Everything.
    All,
    /// Within a tolerance of a plane.
    Plane { point_m: Triple, normal: Triple, tolerance_m: f64 },
    /// Behind a plane; the normal points out.
    HalfSpace { point_m: Triple, normal: Triple, tolerance_m: f64 },
    /// In an axis-parallel box.
    Box { min_m: Triple, max_m: Triple, tolerance_m: f64 },
    /// In a ball.
    Sphere { centre_m: Triple, radius_m: f64, tolerance_m: f64 },
    /// In a shape, or closer than the tolerance.
    Shape { shape: Shape, tolerance_m: f64 },
    /// In a voxel of this label; the label map is that of the body where it is null.
    Label {
        value: u32,
        file: Option<PathBuf>,
        unit: Option<UnitFormat>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        layer: Option<usize>,
    },
    /// Where the outward normal of the body and a direction (of any length) enclose at most an
    /// angle.
    Facing { direction: Triple, angle_rad: f64 },
    /// In at least one of these.
    Union { of: Vec<Selection> },
    /// In all of these.
    Intersection { of: Vec<Selection> },
    /// Not in this one.
    Not { of: Box<Selection> },
}

impl From<&ShapeFormat> for Shape {
    fn from(format: &ShapeFormat) -> Shape {
        match format {
            ShapeFormat::Box { min, max } => Shape::Box { min_m: *min, max_m: *max },
            ShapeFormat::Cylinder { base, axis, radius, height } => {
                Shape::Cylinder { base_m: *base, axis: *axis, radius_m: *radius, height_m: *height }
            }
            ShapeFormat::Sphere { centre, radius } => {
                Shape::Sphere { centre_m: *centre, radius_m: *radius }
            }
            ShapeFormat::Ellipsoid { centre, radii } => {
                Shape::Ellipsoid { centre_m: *centre, radii_m: *radii }
            }
            ShapeFormat::Polygon { points, z } => {
                Shape::Polygon { points_m: points.clone(), z_m: *z }
            }
            ShapeFormat::HalfSpace { point, normal } => {
                Shape::HalfSpace { point_m: *point, normal: *normal }
            }
            ShapeFormat::Union(parts) => {
                Shape::Union { of: parts.iter().map(Into::into).collect() }
            }
            ShapeFormat::Intersection(parts) => {
                Shape::Intersection { of: parts.iter().map(Into::into).collect() }
            }
            ShapeFormat::Difference(whole, hole) => {
                Shape::Difference { of: Box::new([(&**whole).into(), (&**hole).into()]) }
            }
            ShapeFormat::Stl { file, unit } => Shape::Stl { file: file.clone(), unit: *unit },
            ShapeFormat::LabelMap { file, labels, unit, layer, smoothing } => Shape::LabelMap {
                file: file.clone(),
                labels: labels.clone(),
                unit: *unit,
                layer: *layer,
                smoothing_voxels: smoothing.unwrap_or(LabelField::SMOOTHING),
            },
        }
    }
}

impl Selection {
    /// With this tolerance \[m\] where the case states none.
    pub fn new(format: &SelectorFormat, preset: f64) -> Selection {
        let all = |parts: &[SelectorFormat]| {
            parts.iter().map(|part| Selection::new(part, preset)).collect()
        };
        match format {
            SelectorFormat::All => Selection::All,
            SelectorFormat::Plane { point, normal, tolerance } => Selection::Plane {
                point_m: *point,
                normal: *normal,
                tolerance_m: tolerance.unwrap_or(preset),
            },
            SelectorFormat::HalfSpace { point, normal, tolerance } => Selection::HalfSpace {
                point_m: *point,
                normal: *normal,
                tolerance_m: tolerance.unwrap_or(preset),
            },
            SelectorFormat::Box { min, max, tolerance } => Selection::Box {
                min_m: *min,
                max_m: *max,
                tolerance_m: tolerance.unwrap_or(preset),
            },
            SelectorFormat::Sphere { centre, radius, tolerance } => Selection::Sphere {
                centre_m: *centre,
                radius_m: *radius,
                tolerance_m: tolerance.unwrap_or(preset),
            },
            SelectorFormat::Shape(shape) => {
                Selection::Shape { shape: shape.into(), tolerance_m: preset }
            }
            SelectorFormat::Label { value, file, unit, layer } => {
                Selection::Label { value: *value, file: file.clone(), unit: *unit, layer: *layer }
            }
            SelectorFormat::Facing { direction, angle } => {
                Selection::Facing { direction: *direction, angle_rad: *angle }
            }
            SelectorFormat::Union(parts) => Selection::Union { of: all(parts) },
            SelectorFormat::Intersection(parts) => Selection::Intersection { of: all(parts) },
            SelectorFormat::Not(part) => {
                Selection::Not { of: Box::new(Selection::new(part, preset)) }
            }
        }
    }
}
