//! A made-up NIfTI image: anisotropic voxels, turned, one axis the other way round.

use mtled::algebra::tensor::{Matrix3, Vector3};

/// Not the same along any two axes.
pub const SIZE: [usize; 3] = [16, 12, 14];
const VOXEL: [f64; 3] = [2.0, 3.0, 2.5];

/// Centre of the first voxel and steps along the indices \[mm\], as the file stores them.
pub struct Place {
    pub origin: Vector3,
    pub directions: Matrix3,
}

/// Types of NIfTI that are tried, with their codes.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    I16 = 4,
    F32 = 16,
}

/// Around a point \[mm\].
pub fn around(middle: Vector3) -> Place {
    let axis = nalgebra::Unit::new_normalize(Vector3::new(1.0, 2.0, 3.0));
    let turn = nalgebra::Rotation3::from_axis_angle(&axis, 0.4);
    let steps = Matrix3::from_diagonal(&Vector3::new(VOXEL[0], -VOXEL[1], VOXEL[2]));
    let directions = (turn.matrix() * steps).map(|c| f64::from(c as f32));
    let half = Vector3::from_fn(|axis, _| 0.5 * (SIZE[axis] - 1) as f64);
    let origin = (middle - directions * half).map(|c| f64::from(c as f32));
    Place { origin, directions }
}

/// Index triples, the first index fastest.
pub fn voxels() -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = SIZE;
    (0..nx * ny * nz).map(move |n| [n % nx, n / nx % ny, n / (nx * ny)])
}

/// A `.nii` file of these values.
pub fn nifti(place: &Place, kind: Kind, value: impl Fn([usize; 3]) -> f64) -> Vec<u8> {
    let mut bytes = vec![0u8; 352];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, &348i32.to_le_bytes());
    for (n, size) in [3, SIZE[0], SIZE[1], SIZE[2], 1, 1, 1, 1].into_iter().enumerate() {
        put(40 + 2 * n, &(size as i16).to_le_bytes());
    }
    put(70, &(kind as i16).to_le_bytes());
    put(72, &(if kind == Kind::I16 { 16i16 } else { 32 }).to_le_bytes());
    for (n, step) in [1.0, VOXEL[0], VOXEL[1], VOXEL[2]].into_iter().enumerate() {
        put(76 + 4 * n, &(step as f32).to_le_bytes());
    }
    put(108, &352f32.to_le_bytes());
    put(112, &1f32.to_le_bytes());
    put(123, &[2]);
    put(148, b"made up");
    put(254, &1i16.to_le_bytes());
    for row in 0..3 {
        for column in 0..4 {
            let number = match column {
                3 => place.origin[row],
                _ => place.directions[(row, column)],
            };
            put(280 + 16 * row + 4 * column, &(number as f32).to_le_bytes());
        }
    }
    put(344, b"n+1\0");
    for voxel in voxels() {
        match kind {
            Kind::I16 => bytes.extend((value(voxel) as i16).to_le_bytes()),
            Kind::F32 => bytes.extend((value(voxel) as f32).to_le_bytes()),
        }
    }
    bytes
}
