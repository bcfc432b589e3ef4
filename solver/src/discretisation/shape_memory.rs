//! Memory of shapes that are large: images and surfaces.

use crate::geometry::{Selector, Shape};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Bytes of a label, and of the distance at a voxel.
const PER_LABEL: f64 = 4.0;
const PER_DISTANCE: f64 = 8.0;
/// Of a voxel while its distance is computed: image, distance, samples far away, and where the
/// nearest point came from.
const PER_VOXEL_READING: f64 = 32.0;
/// What computes distances beside its voxels.
const READING_IMAGE: f64 = 2.0e6;
/// Of a triangle with its vertices, normals and search tree, and while it is read.
const PER_TRIANGLE: f64 = 300.0;
const PER_TRIANGLE_READING: f64 = 700.0;

/// Memory of the images and surfaces of some shapes \[bytes\]; what several shapes share
/// counts once.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShapeMemory {
    /// While they exist.
    pub kept: f64,
    /// At the peak of reading them.
    pub reading: f64,
}

impl ShapeMemory {
    /// Of shapes and of those in selectors.
    pub fn of<'a>(
        shapes: impl Iterator<Item = &'a Shape>,
        selectors: impl Iterator<Item = &'a Selector>,
    ) -> ShapeMemory {
        let mut parts = Parts::default();
        shapes.for_each(|shape| parts.add_shape(shape));
        selectors.for_each(|selector| parts.add_selector(selector));
        let kept = parts.0.values().map(|(kept, _)| kept).sum();
        let more = parts.0.values().map(|(_, reading)| *reading).fold(0.0, f64::max);
        ShapeMemory { kept, reading: kept + more }
    }
}

/// By address: bytes that stay, and more of them while it is read.
#[derive(Default)]
struct Parts(BTreeMap<usize, (f64, f64)>);

impl Parts {
    fn add<T>(&mut self, part: &Arc<T>, kept: f64, reading: f64) {
        self.0.insert(Arc::as_ptr(part) as usize, (kept, reading - kept));
    }

    fn add_shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Labels(field) => {
                let voxels = field.map().labels.len() as f64;
                self.add(field.map(), PER_LABEL * voxels, PER_LABEL * voxels);
                let samples = field.samples() as f64;
                let kept = PER_DISTANCE * samples + field.surface_bytes();
                self.add(field, kept, READING_IMAGE + PER_VOXEL_READING * samples);
            }
            Shape::Surface(surface) => {
                let triangles = surface.triangle_count() as f64;
                self.add(surface, PER_TRIANGLE * triangles, PER_TRIANGLE_READING * triangles);
            }
            Shape::Union(members) | Shape::Intersection(members) => {
                members.iter().for_each(|member| self.add_shape(member));
            }
            Shape::Difference(body, hole) => {
                self.add_shape(body);
                self.add_shape(hole);
            }
            _ => {}
        }
    }

    fn add_selector(&mut self, selector: &Selector) {
        match selector {
            Selector::Inside { shape, .. } => self.add_shape(shape),
            Selector::Label { map, .. } => {
                let bytes = PER_LABEL * map.labels.len() as f64;
                self.add(map, bytes, bytes);
            }
            Selector::Union(parts) | Selector::Intersection(parts) => {
                parts.iter().for_each(|part| self.add_selector(part));
            }
            // Of the body itself.
            Selector::Facing { body, .. } => self.add_shape(body),
            Selector::Not(part) => self.add_selector(part),
            Selector::All | Selector::Plane { .. } => {}
        }
    }
}
