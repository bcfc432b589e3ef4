//! Space or plane.

/// Three dimensions, or a plane-strain slice with two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dimension {
    Three,
    /// Displacements in x and y, F₃₃ = 1. The cross-section is taken at `z`
    /// \[m\]; volumes, masses and forces are those of a slab of `thickness` \[m\].
    PlaneStrain {
        thickness: f64,
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

    /// What an area in the plane is multiplied with: 1 in space \[–\] or \[m\].
    pub fn thickness(&self) -> f64 {
        match self {
            Dimension::Three => 1.0,
            Dimension::PlaneStrain { thickness, .. } => *thickness,
        }
    }
}
