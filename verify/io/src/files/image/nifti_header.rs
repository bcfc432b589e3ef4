//! A NIfTI-1 header of a grid \[byte offsets of nifti1.h\].

use super::grid::Grid;
use crate::files::bytes::Scalar;
use crate::files::error::Mistake;
use mtled::algebra::tensor::{Matrix3, Vector3};

/// Where the voxels start: behind the header and four bytes that say that it has no extension.
pub(crate) const VOXELS_AT: usize = 352;

/// Code of `intent_code` for a vector at each voxel.
const INTENT_VECTOR: i16 = 1007;
const MILLIMETRE: u8 = 2;
/// Coordinates of the scanner, RAS.
const SCANNER: i16 = 1;

/// The header of one number per voxel, or of `vectors` of three. Lengths are in mm.
pub(crate) fn header(grid: &Grid, scalar: Scalar, vectors: bool) -> Result<Vec<u8>, Mistake> {
    let mut bytes = vec![0; VOXELS_AT];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, &348i32.to_le_bytes());
    put(38, b"r");
    let mut sizes = [1i16; 8];
    sizes[0] = if vectors { 5 } else { 3 };
    for (axis, &n) in grid.size.iter().enumerate() {
        sizes[axis + 1] = i16::try_from(n).map_err(|_| {
            let expected = "at most 32767 voxels along each axis of a NIfTI-1 file";
            Mistake::bad_field("dim", &n.to_string(), expected)
        })?;
    }
    if vectors {
        sizes[5] = 3;
        put(68, &INTENT_VECTOR.to_le_bytes());
    }
    for (n, size) in sizes.into_iter().enumerate() {
        put(40 + 2 * n, &size.to_le_bytes());
    }
    put(70, &code(scalar).to_le_bytes());
    put(72, &(8 * scalar.size() as i16).to_le_bytes());
    put(108, &(VOXELS_AT as f32).to_le_bytes());
    put(112, &1f32.to_le_bytes());
    put(123, &[MILLIMETRE]);
    place(grid, &mut put);
    put(344, b"n+1\0");
    Ok(bytes)
}

/// sform, and qform where the directions are perpendicular.
fn place(grid: &Grid, put: &mut impl FnMut(usize, &[u8])) {
    let (origin, directions) = (grid.origin * 1e3, grid.directions * 1e3);
    let voxel = Vector3::from_fn(|axis, _| directions.column(axis).norm());
    let mut rotation = Matrix3::from_fn(|row, axis| directions[(row, axis)] / voxel[axis]);
    let hand = rotation.determinant().signum();
    rotation.column_mut(2).scale_mut(hand);
    let steps = [hand, voxel.x, voxel.y, voxel.z, 1.0, 1.0, 1.0, 1.0];
    for (n, step) in steps.into_iter().enumerate() {
        put(76 + 4 * n, &(step as f32).to_le_bytes());
    }
    if (rotation.transpose() * rotation - Matrix3::identity()).norm() < 1e-4 {
        put(252, &SCANNER.to_le_bytes());
        let turn = nalgebra::UnitQuaternion::from_matrix(&rotation).into_inner();
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let numbers = [turn.i, turn.j, turn.k, origin.x, origin.y, origin.z];
        for (n, number) in numbers.into_iter().enumerate() {
            put(256 + 4 * n, &(number as f32).to_le_bytes());
        }
    }
    put(254, &SCANNER.to_le_bytes());
    for row in 0..3 {
        let numbers =
            [directions[(row, 0)], directions[(row, 1)], directions[(row, 2)], origin[row]];
        for (n, number) in numbers.into_iter().enumerate() {
            put(280 + 16 * row + 4 * n, &(number as f32).to_le_bytes());
        }
    }
}

fn code(scalar: Scalar) -> i16 {
    match scalar {
        Scalar::U8 => 2,
        Scalar::I16 => 4,
        Scalar::I32 => 8,
        Scalar::F32 => 16,
        Scalar::F64 => 64,
        Scalar::I8 => 256,
        Scalar::U16 => 512,
        Scalar::U32 => 768,
        Scalar::I64 => 1024,
        Scalar::U64 => 1280,
    }
}
