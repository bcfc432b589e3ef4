//! NRRD images: read from raw or gzip data, written with gzip data attached.

use super::format::gzip;
use super::grid::Grid;
use super::voxels::{Header, Image};
use crate::files::bytes::{ByteOrder, Scalar};
use crate::files::error::{FileError, Mistake};
use crate::files::nrrd::{Opened, open_image, stored};
use crate::files::unit::LengthUnit;
use crate::files::voxels::voxel_count;
use mtled::algebra::tensor::Vector3;
use std::path::Path;

/// Fields that say where and how the data are stored.
const OF_THE_DATA: [&str; 5] = ["encoding", "endian", "datafile", "byteskip", "lineskip"];

/// Reads an image into RAS.
pub(crate) fn read(path: &Path, unit: Option<LengthUnit>) -> Result<Image, FileError> {
    open_image(path).and_then(|opened| parse(opened, unit).map_err(|mistake| mistake.of(path)))
}

fn parse(opened: Opened, unit: Option<LengthUnit>) -> Result<Image, Mistake> {
    let Opened { header, text, data, length, .. } = opened;
    let (size, scalar) = (header.sizes()?, header.scalar()?);
    let order = header.byte_order(scalar, header.encoding()?)?;
    let (origin, directions) = header.frame(unit)?;
    let grid = Grid::new(size, origin, directions)?;
    let stored = stored(&header, data, length, voxel_count(&size)? * scalar.size())?;
    let notes = header.doubts();
    Ok(Image { grid, scalar, order, stored, notes, header: Header::Nrrd { text } })
}

/// The header of an NRRD image is kept; a NIfTI image gets one of its grid.
pub(crate) fn image(image: &Image, voxels: &[u8]) -> Result<Vec<u8>, Mistake> {
    let mut text = match &image.header {
        Header::Nrrd { text } => kept_lines(text),
        Header::Nifti { scaling, .. } if *scaling != (1.0, 0.0) => {
            let expected = "1 and 0 for an NRRD file, which has no scaling; write .nii.gz";
            let value = format!("{} and {}", scaling.0, scaling.1);
            return Err(Mistake::bad_field("scl_slope, scl_inter", &value, expected));
        }
        Header::Nifti { .. } => {
            let [nx, ny, nz] = image.grid.size;
            let frame = frame(&image.grid, "");
            let kind = name(image.scalar);
            format!(
                "NRRD0004\ntype: {kind}\ndimension: 3\n{frame}sizes: {nx} {ny} {nz}\n\
                 kinds: domain domain domain\n"
            )
            .into_bytes()
        }
    };
    let order = image.order.name();
    text.extend(format!("endian: {order}\nencoding: gzip\n\n").bytes());
    text.extend(gzip(voxels)?);
    Ok(text)
}

/// Lines of a header that do not say how its data are stored.
fn kept_lines(text: &[u8]) -> Vec<u8> {
    let is_kept = |line: &&[u8]| {
        let line = String::from_utf8_lossy(line).trim_end().to_lowercase();
        let field = line.split(':').next().unwrap_or_default().replace([' ', '_'], "");
        let key_and_value = line.contains(":=");
        !line.is_empty() && (key_and_value || !OF_THE_DATA.contains(&field.as_str()))
    };
    let lines = text.split_inclusive(|&b| b == b'\n').filter(is_kept);
    lines.flat_map(|line| [line.trim_ascii_end(), b"\n"].concat()).collect()
}

/// Components along L, P and S \[mm\] first, as ITK stores vectors.
pub(crate) fn field(grid: &Grid, vectors: &[[f32; 3]]) -> Result<Vec<u8>, Mistake> {
    let [nx, ny, nz] = grid.size;
    let frame = frame(grid, "none ");
    let mut bytes = format!(
        "NRRD0004\ntype: float\ndimension: 4\n{frame}sizes: 3 {nx} {ny} {nz}\n\
         kinds: vector domain domain domain\nendian: {}\nencoding: gzip\n\n",
        ByteOrder::Little.name()
    )
    .into_bytes();
    let mut values = Vec::with_capacity(12 * vectors.len());
    for vector in vectors {
        for (component, factor) in [-1e3, -1e3, 1e3].into_iter().enumerate() {
            let value = factor * f64::from(vector[component]);
            values.extend((value as f32).to_le_bytes());
        }
    }
    bytes.extend(gzip(&values)?);
    Ok(bytes)
}

/// Space, directions and origin in LPS \[mm\].
fn frame(grid: &Grid, before: &str) -> String {
    let vector = |v: Vector3| format!("({},{},{})", -1e3 * v.x, -1e3 * v.y, 1e3 * v.z);
    let steps = [0, 1, 2].map(|axis| vector(grid.directions.column(axis).into_owned()));
    format!(
        "space: left-posterior-superior\nspace directions: {before}{}\nspace origin: {}\n\
         space units: \"mm\" \"mm\" \"mm\"\n",
        steps.join(" "),
        vector(grid.origin)
    )
}

fn name(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::I8 => "int8",
        Scalar::U8 => "uint8",
        Scalar::I16 => "int16",
        Scalar::U16 => "uint16",
        Scalar::I32 => "int32",
        Scalar::U32 => "uint32",
        Scalar::I64 => "int64",
        Scalar::U64 => "uint64",
        Scalar::F32 => "float",
        Scalar::F64 => "double",
    }
}
