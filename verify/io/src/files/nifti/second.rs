//! Headers of NIfTI-2 \[byte offsets of nifti2.h\].

use crate::files::bytes::{ByteOrder, Scalar, start_of};
use crate::files::error::Mistake;
use nifti::{Endianness, NiftiHeader};

/// Length of a header \[byte\].
pub(crate) const HEADER: usize = 540;

/// Whether a file starts as one of NIfTI-2.
pub(crate) fn is_start(bytes: &[u8]) -> bool {
    let length = HEADER as i32;
    bytes.starts_with(&length.to_le_bytes()) || bytes.starts_with(&length.to_be_bytes())
}

/// The fields that images need, and whether the voxels are in a file of their own.
pub(crate) fn header(bytes: &[u8]) -> Result<(NiftiHeader, bool), Mistake> {
    if bytes.len() < HEADER {
        return Err(Mistake::TruncatedHeader { found: bytes.len() });
    }
    let in_pair = match &bytes[4..8] {
        b"n+2\0" => false,
        b"ni2\0" => true,
        magic => {
            let format = "a NIfTI-2 file";
            return Err(Mistake::WrongFormat { format, start: start_of(magic) });
        }
    };
    let (order, endianness) = if bytes.starts_with(&(HEADER as i32).to_le_bytes()) {
        (ByteOrder::Little, Endianness::Little)
    } else {
        (ByteOrder::Big, Endianness::Big)
    };
    let number = |at: usize, scalar: Scalar| scalar.read(&bytes[at..], order);
    let code = |at: usize| number(at, Scalar::I32) as i16;
    let real = |at: usize| number(at, Scalar::F64) as f32;
    let row = |at: usize| [0, 1, 2, 3].map(|n| real(at + 8 * n));
    let mut dim = [0; 8];
    for (axis, size) in dim.iter_mut().enumerate() {
        let found = number(16 + 8 * axis, Scalar::I64);
        let possible = (0.0..=f64::from(u16::MAX)).contains(&found);
        let expected = "sizes from 1 to 65535";
        let bad = || Mistake::bad_field("dim", &found.to_string(), expected);
        *size = if possible { found as u16 } else { return Err(bad()) };
    }
    let header = NiftiHeader {
        dim,
        datatype: number(12, Scalar::I16) as i16,
        pixdim: [0, 1, 2, 3, 4, 5, 6, 7].map(|n| real(104 + 8 * n)),
        vox_offset: number(168, Scalar::I64) as f32,
        scl_slope: real(176),
        scl_inter: real(184),
        qform_code: code(344),
        sform_code: code(348),
        quatern_b: real(352),
        quatern_c: real(360),
        quatern_d: real(368),
        quatern_x: real(376),
        quatern_y: real(384),
        quatern_z: real(392),
        srow_x: row(400),
        srow_y: row(432),
        srow_z: row(464),
        xyzt_units: number(500, Scalar::I32) as u8,
        endianness,
        ..NiftiHeader::default()
    };
    Ok((header, in_pair))
}
