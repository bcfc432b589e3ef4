//! An image and its values between the voxels.

use super::grid::Grid;
use crate::files::bytes::{ByteOrder, Scalar};
use mtled::algebra::tensor::Vector3;

/// An image of one number per voxel.
#[derive(Debug, Clone)]
pub struct Image {
    /// Where the voxels are.
    pub grid: Grid,
    /// Type of the stored numbers.
    pub scalar: Scalar,
    /// Order of their bytes.
    pub order: ByteOrder,
    /// Stored numbers, first index fastest.
    pub stored: Vec<u8>,
    /// Reasons to doubt where the voxels lie.
    pub notes: Vec<String>,
    pub(super) header: Header,
}

/// What a file of the same format is written with.
#[derive(Debug, Clone)]
pub(super) enum Header {
    /// The bytes of a NIfTI-1 header, if it is one of a file in one piece; slope and intercept of
    /// the stored numbers.
    Nifti { bytes: Option<Vec<u8>>, scaling: (f64, f64) },
    /// The lines of an NRRD header up to the empty one.
    Nrrd { text: Vec<u8> },
}

/// How values between voxels are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Linear along the three indices; whole numbers are rounded.
    Linear,
    /// That of the nearest voxel, for labels.
    Nearest,
}

impl Image {
    /// The type of the stored numbers as in NumPy's array interface, such as `<f4`.
    pub fn array_type(&self) -> String {
        let order = if self.order == ByteOrder::Little { '<' } else { '>' };
        let kind = match self.scalar {
            Scalar::I8 | Scalar::I16 | Scalar::I32 | Scalar::I64 => 'i',
            Scalar::U8 | Scalar::U16 | Scalar::U32 | Scalar::U64 => 'u',
            Scalar::F32 | Scalar::F64 => 'f',
        };
        format!("{order}{kind}{}", self.scalar.size())
    }

    /// Appends the stored number at an index to `out`; 0 outside of all voxels. Within half a
    /// voxel of the faces the outermost voxels count. Returns whether the index is inside.
    pub fn sample(&self, index: &Vector3, how: Interpolation, out: &mut Vec<u8>) -> bool {
        if !self.grid.contains(index) {
            self.scalar.write(0.0, self.order, out);
            return false;
        }
        match how {
            Interpolation::Nearest => {
                let voxel = [0, 1, 2].map(|axis| (index[axis] + 0.5).floor() as usize);
                out.extend(self.bytes(voxel));
            }
            Interpolation::Linear => self.scalar.write(self.linear(index), self.order, out),
        }
        true
    }

    /// Corners of weight zero do not count: they may be NaN.
    fn linear(&self, index: &Vector3) -> f64 {
        let last = |axis: usize| self.grid.size[axis] - 1;
        let clamped = [0, 1, 2].map(|axis| index[axis].clamp(0.0, last(axis) as f64));
        let low = clamped.map(|c| c.floor() as usize);
        let mut value = 0.0;
        for corner in 0..8usize {
            let mut weight = 1.0;
            let voxel = [0, 1, 2].map(|axis| {
                let fraction = clamped[axis] - low[axis] as f64;
                let high = corner >> axis & 1;
                weight *= if high == 1 { fraction } else { 1.0 - fraction };
                (low[axis] + high).min(last(axis))
            });
            if weight > 0.0 {
                value += weight * self.scalar.read(self.bytes(voxel), self.order);
            }
        }
        value
    }

    fn bytes(&self, [i, j, k]: [usize; 3]) -> &[u8] {
        let [nx, ny, _] = self.grid.size;
        let (at, length) = (i + nx * (j + ny * k), self.scalar.size());
        &self.stored[at * length..(at + 1) * length]
    }
}
