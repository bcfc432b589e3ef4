//! The voxels of an image in space.

use crate::files::error::Mistake;
use crate::files::voxels::{are_singular, voxel_count};
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::GeometryError;

/// Places of voxels in RAS world coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Number of voxels along each index.
    pub size: [usize; 3],
    /// Centre of voxel (0, 0, 0) \[m\].
    pub origin: Vector3,
    /// Column k: step from one voxel centre to the next along index k \[m\].
    pub directions: Matrix3,
    to_index: Matrix3,
}

impl Grid {
    /// From its parts; the directions must span a volume.
    pub(crate) fn new(
        size: [usize; 3],
        origin: Vector3,
        directions: Matrix3,
    ) -> Result<Grid, Mistake> {
        voxel_count(&size)?;
        let singular = || {
            let determinant = directions.determinant();
            Mistake::Geometry(GeometryError::SingularDirections { determinant })
        };
        if are_singular(&directions) {
            return Err(singular());
        }
        let to_index = directions.try_inverse().ok_or_else(singular)?;
        Ok(Grid { size, origin, directions, to_index })
    }

    /// Number of voxels.
    pub fn count(&self) -> usize {
        self.size.iter().product()
    }

    /// Centre of a voxel \[m\].
    pub fn centre(&self, [i, j, k]: [usize; 3]) -> Vector3 {
        self.origin + self.directions * Vector3::new(i as f64, j as f64, k as f64)
    }

    /// A vector \[m\] in steps along the indices \[–\].
    pub fn steps(&self, vector: &Vector3) -> Vector3 {
        self.to_index * vector
    }

    /// A position \[m\] in units of voxels; (0, 0, 0) is the centre of the first one.
    pub fn index_of(&self, position: &Vector3) -> Vector3 {
        self.steps(&(position - self.origin))
    }

    /// Whether an index lies in one of the voxels.
    pub fn contains(&self, index: &Vector3) -> bool {
        (0..3).all(|axis| index[axis] >= -0.5 && index[axis] < self.size[axis] as f64 - 0.5)
    }

    /// Lower and upper corner of the box around all voxels \[m\].
    pub fn bounds(&self) -> (Vector3, Vector3) {
        let end = |axis: usize, high: bool| if high { self.size[axis] as f64 - 0.5 } else { -0.5 };
        let corner = |n: usize| {
            self.origin
                + self.directions * Vector3::from_fn(|axis, _| end(axis, n >> axis & 1 == 1))
        };
        (1..8).map(corner).fold((corner(0), corner(0)), |(l, u), c| (l.inf(&c), u.sup(&c)))
    }
}
