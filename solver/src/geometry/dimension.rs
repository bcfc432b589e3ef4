//! Space or plane.

use crate::algebra::tensor::Vector3;

/// Three dimensions, or a plane-strain slice with two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dimension {
    /// Space.
    Three,
    /// Displacements in x and y, F₃₃ = 1; volumes, masses and forces are those
    /// of a slab.
    PlaneStrain {
        /// Of the slab \[m\].
        thickness: f64,
        /// Height of the cross-section \[m\].
        z: f64,
    },
}

impl Dimension {
    /// Number of displacement components per node: 3 or 2.
    pub fn components(&self) -> usize {
        match self {
            Dimension::Three => 3,
            Dimension::PlaneStrain { .. } => 2,
        }
    }

    /// Factor from areas in the plane to volumes \[m\]; 1 in space \[–\].
    pub fn thickness(&self) -> f64 {
        match self {
            Dimension::Three => 1.0,
            Dimension::PlaneStrain { thickness, .. } => *thickness,
        }
    }

    /// The vector without its component out of the plane.
    pub(crate) fn in_plane(&self, mut v: Vector3) -> Vector3 {
        if let Dimension::PlaneStrain { .. } = self {
            v.z = 0.0;
        }
        v
    }
}
