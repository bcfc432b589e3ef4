//! Segmented images as geometry.
use crate::tensor::{Matrix3, Vector3};

/// A segmented image: one label per voxel, label 0 is outside.
#[derive(Debug, Clone)]
pub struct LabelMap {
    pub size: [usize; 3],
    /// Centre of voxel (0, 0, 0) \[m\].
    pub origin: Vector3,
    /// Column k: step from one voxel centre to the next along index k \[m\].
    pub directions: Matrix3,
    /// Labels, first index fastest.
    pub labels: Vec<u32>,
}

impl LabelMap {
    /// The label of the voxel that contains `x`, 0 outside the image.
    pub fn label_at(&self, _x: &Vector3) -> u32 {
        0
    }
}
