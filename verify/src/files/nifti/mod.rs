//! NIfTI-1 label maps, `.nii` and `.nii.gz` (nifti.nimh.nih.gov/nifti-1).

use super::bytes::{ByteOrder, Scalar, at_most, open, skip, start_of, voxel_bytes};
use super::error::{FileError, Mistake};
use super::unit::LengthUnit;
use super::voxels;
use flate2::bufread::MultiGzDecoder;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::LabelMap;
use nifti::{Endianness, NiftiHeader, NiftiType};
use std::io::{BufRead, Read};
use std::path::Path;

/// Length of a NIfTI-1 header \[byte\].
const HEADER: usize = 348;

/// Reads a label map; NIfTI is RAS already. `unit` overrides the file's.
pub fn read(path: &Path, unit: Option<LengthUnit>) -> Result<LabelMap, FileError> {
    let voxels = read_voxels(path)?;
    voxels.labels(unit).map_err(|mistake| mistake.of(path))
}

/// An image as it stands in its file.
pub(super) struct Voxels {
    pub header: NiftiHeader,
    /// The bytes that the header was read from.
    pub header_bytes: Vec<u8>,
    pub size: [usize; 3],
    pub scalar: Scalar,
    pub order: ByteOrder,
    /// Slope and intercept of the stored values.
    pub scaling: (f64, f64),
    /// Stored values, first index fastest.
    pub stored: Vec<u8>,
}

/// Reads an image of one value per voxel, compressed or not.
pub(super) fn read_voxels(path: &Path) -> Result<Voxels, FileError> {
    let (mut file, _) = open(path)?;
    let start = file.fill_buf().map_err(|error| Mistake::Unreadable(error).of(path))?;
    match start.starts_with(&[0x1f, 0x8b]) {
        true => parse_voxels(MultiGzDecoder::new(file)),
        false => parse_voxels(file),
    }
    .map_err(|mistake| mistake.of(path))
}

pub(super) fn parse_voxels(mut stream: impl Read) -> Result<Voxels, Mistake> {
    let header_bytes = at_most(&mut stream, HEADER as u64)?;
    let header = header(&header_bytes)?;
    let size = size(&header)?;
    frame(&header)?;
    let order = match header.endianness {
        Endianness::Little => ByteOrder::Little,
        Endianness::Big => ByteOrder::Big,
    };
    let (scalar, count) = (scalar(&header)?, voxels::voxel_count(&size)?);
    let scaling = scaling(&header)?;
    skip(&mut stream, offset(&header)?.saturating_sub(HEADER as u64))?;
    let (stored, _) = voxel_bytes(stream, count * scalar.size())?;
    Ok(Voxels { header, header_bytes, size, scalar, order, scaling, stored })
}

impl Voxels {
    /// Centre of the first voxel and steps along the indices \[m\]; `unit` overrides the file's.
    pub fn frame(&self, unit: Option<LengthUnit>) -> Result<(Vector3, Matrix3), Mistake> {
        let (origin, directions) = frame(&self.header)?;
        let metres = match unit {
            Some(unit) => unit.in_metres(),
            None => stated_unit(&self.header)?.in_metres(),
        };
        Ok((origin * metres, directions * metres))
    }

    fn labels(&self, unit: Option<LengthUnit>) -> Result<LabelMap, Mistake> {
        let (origin, directions) = self.frame(unit)?;
        let labels = voxels::labels(&self.stored, self.scalar, self.order, self.scaling)?;
        voxels::label_map(self.size, origin, directions, labels)
    }
}

fn header(bytes: &[u8]) -> Result<NiftiHeader, Mistake> {
    let format = "a NIfTI-1 file in one piece (.nii or .nii.gz)";
    if bytes.len() < HEADER {
        return match bytes.starts_with(&348i32.to_le_bytes()) {
            true => Err(Mistake::TruncatedHeader { found: bytes.len() }),
            false => Err(Mistake::WrongFormat { format, start: start_of(bytes) }),
        };
    }
    let magic = &bytes[HEADER - 4..HEADER];
    if magic == b"ni1\0" {
        let expected = "`n+1`; convert the .hdr/.img pair to one .nii";
        return Err(Mistake::bad_field("magic", "ni1", expected));
    }
    let header = NiftiHeader::from_reader(bytes)
        .map_err(|_| Mistake::WrongFormat { format, start: start_of(magic) })?;
    if header.sizeof_hdr != HEADER as i32 {
        return Err(Mistake::WrongFormat { format, start: start_of(bytes) });
    }
    Ok(header)
}

/// Voxels along the three axes; further axes must have one entry.
fn size(header: &NiftiHeader) -> Result<[usize; 3], Mistake> {
    let axes = usize::from(header.dim[0]);
    let sizes: Vec<usize> = header.dim[1..].iter().take(axes).map(|&n| usize::from(n)).collect();
    if axes < 3 || sizes[3..].iter().any(|&n| n > 1) {
        let expected = "three axes, one label per voxel";
        return Err(Mistake::bad_field("dim", &format!("{sizes:?}"), expected));
    }
    Ok([sizes[0], sizes[1], sizes[2]])
}

fn scalar(header: &NiftiHeader) -> Result<Scalar, Mistake> {
    Ok(match header.data_type() {
        Ok(NiftiType::Uint8) => Scalar::U8,
        Ok(NiftiType::Int8) => Scalar::I8,
        Ok(NiftiType::Uint16) => Scalar::U16,
        Ok(NiftiType::Int16) => Scalar::I16,
        Ok(NiftiType::Uint32) => Scalar::U32,
        Ok(NiftiType::Int32) => Scalar::I32,
        Ok(NiftiType::Uint64) => Scalar::U64,
        Ok(NiftiType::Int64) => Scalar::I64,
        Ok(NiftiType::Float32) => Scalar::F32,
        Ok(NiftiType::Float64) => Scalar::F64,
        _ => {
            let expected = "a type of whole numbers such as 2 (uint8)";
            return Err(Mistake::bad_field("datatype", &header.datatype.to_string(), expected));
        }
    })
}

/// Where the voxels start \[byte\]; 0 means behind the header.
fn offset(header: &NiftiHeader) -> Result<u64, Mistake> {
    let offset = header.vox_offset;
    if !(offset >= 0.0 && offset.fract() == 0.0) {
        let expected = "a whole number of bytes such as 352";
        return Err(Mistake::bad_field("vox_offset", &offset.to_string(), expected));
    }
    Ok(offset as u64)
}

/// Slope and intercept of the stored values; a slope of 0 means none.
fn scaling(header: &NiftiHeader) -> Result<(f64, f64), Mistake> {
    match header.scl_slope {
        slope if slope == 0.0 || !slope.is_finite() => Ok((1.0, 0.0)),
        slope => {
            finite("scl_inter", &[header.scl_inter])?;
            Ok((f64::from(slope), f64::from(header.scl_inter)))
        }
    }
}

/// Refuses a field with a number that is not finite.
fn finite(field: &'static str, values: &[f32]) -> Result<(), Mistake> {
    match values.iter().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(Mistake::bad_field(field, &format!("{values:?}"), "finite numbers")),
    }
}

fn stated_unit(header: &NiftiHeader) -> Result<LengthUnit, Mistake> {
    match header.xyzt_units & 7 {
        0 | 2 => Ok(LengthUnit::Millimetre),
        1 => Ok(LengthUnit::Metre),
        3 => Ok(LengthUnit::Micrometre),
        other => {
            let expected = "0 (unknown), 1 (m), 2 (mm) or 3 (µm)";
            Err(Mistake::bad_field("xyzt_units", &other.to_string(), expected))
        }
    }
}

/// Centre of the first voxel and steps along the indices: sform, else qform,
/// else pixdim alone.
fn frame(header: &NiftiHeader) -> Result<(Vector3, Matrix3), Mistake> {
    let wide = |row: &[f32; 4]| row.map(f64::from);
    if header.sform_code > 0 {
        finite("srow_x", &header.srow_x)?;
        finite("srow_y", &header.srow_y)?;
        finite("srow_z", &header.srow_z)?;
        let rows = [wide(&header.srow_x), wide(&header.srow_y), wide(&header.srow_z)];
        let origin = Vector3::from_fn(|row, _| rows[row][3]);
        let directions = Matrix3::from_fn(|row, column| rows[row][column]);
        if voxels::are_singular(&directions) {
            let expected = "three rows whose directions span a volume";
            return Err(Mistake::bad_field(
                "srow_x, srow_y, srow_z",
                &format!("{rows:?}"),
                expected,
            ));
        }
        return Ok((origin, directions));
    }
    let step = header.pixdim.map(f64::from);
    if !step[1..4].iter().all(|step| *step > 0.0 && step.is_finite()) {
        let value = format!("{:?}", &step[1..4]);
        return Err(Mistake::bad_field("pixdim", &value, "three positive voxel sizes"));
    }
    if header.qform_code > 0 {
        finite("qoffset", &[header.quatern_x, header.quatern_y, header.quatern_z])?;
        finite("quatern", &[header.quatern_b, header.quatern_c, header.quatern_d])?;
        let hand = if step[0] < 0.0 { -1.0 } else { 1.0 };
        let scale = Matrix3::from_diagonal(&Vector3::new(step[1], step[2], hand * step[3]));
        let origin = [header.quatern_x, header.quatern_y, header.quatern_z].map(f64::from);
        return Ok((Vector3::from(origin), quaternion_rotation(header) * scale));
    }
    Ok((Vector3::zeros(), Matrix3::from_diagonal(&Vector3::new(step[1], step[2], step[3]))))
}

/// Rotation of the unit quaternion a + bi + cj + dk with a ≥ 0.
fn quaternion_rotation(header: &NiftiHeader) -> Matrix3 {
    let [b, c, d] = [header.quatern_b, header.quatern_c, header.quatern_d].map(f64::from);
    let a = (1.0 - b * b - c * c - d * d).max(0.0).sqrt();
    let quaternion = nalgebra::Quaternion::new(a, b, c, d);
    *nalgebra::UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix().matrix()
}
