//! Label maps from the bytes of their voxels.

use super::bytes::{ByteOrder, Scalar};
use super::error::Mistake;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::LabelMap;
use std::path::PathBuf;

/// A label map in RAS world coordinates (x right, y anterior, z superior) and
/// the files it came from.
#[derive(Debug, Clone)]
pub struct LabelMapFile {
    /// The labels.
    pub map: LabelMap,
    /// The file that was named, then a detached data file.
    pub files: Vec<PathBuf>,
}

/// An image in metres from its parts.
pub fn label_map(
    size: [usize; 3],
    origin: Vector3,
    directions: Matrix3,
    labels: Vec<u32>,
) -> Result<LabelMap, Mistake> {
    LabelMap::new(size, origin, directions, labels).map_err(Mistake::Geometry)
}

/// Whether directions span no volume.
pub fn are_singular(directions: &Matrix3) -> bool {
    let volume: f64 = directions.column_iter().map(|step| step.norm()).product();
    !(directions.determinant().abs() > 1e-9 * volume && volume.is_finite())
}

/// The largest label.
const LARGEST: f64 = 65535.0;

/// The most voxels of an image: 1024³, whose distances take 64 GB.
const MOST_VOXELS: usize = 1 << 30;

/// Number of voxels of an image, refused where it is 0 or more than can be used.
pub fn voxel_count(sizes: &[usize]) -> Result<usize, Mistake> {
    let count = sizes.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
    match count {
        Some(count) if (1..=MOST_VOXELS).contains(&count) => Ok(count),
        _ => Err(Mistake::BadSizes { sizes: sizes.to_vec(), most: MOST_VOXELS }),
    }
}

/// Decodes numbers as labels, value = slope × stored + intercept.
pub fn labels(
    bytes: &[u8],
    scalar: Scalar,
    order: ByteOrder,
    (slope, intercept): (f64, f64),
) -> Result<Vec<u32>, Mistake> {
    let chunks = bytes.chunks_exact(scalar.size());
    let values = chunks.map(|chunk| slope * scalar.read(chunk, order) + intercept);
    let labels: Vec<u32> = (values.enumerate())
        .map(|(voxel, value)| label(voxel, value, scalar, order))
        .collect::<Result<_, _>>()?;
    refuse_swapped_bytes(&labels, scalar, order)?;
    Ok(labels)
}

/// One label from its value.
pub fn label(voxel: usize, value: f64, scalar: Scalar, order: ByteOrder) -> Result<u32, Mistake> {
    if (0.0..=LARGEST).contains(&value) && value.fract() == 0.0 {
        return Ok(value as u32);
    }
    if scalar.size() > 1 && value > LARGEST {
        return Err(Mistake::LabelTooLarge { voxel, value, order: order.name() });
    }
    Err(Mistake::NotALabel { voxel, value })
}

/// Small labels of two bytes read the wrong way round are multiples of 256.
fn refuse_swapped_bytes(labels: &[u32], scalar: Scalar, order: ByteOrder) -> Result<(), Mistake> {
    let smallest = labels.iter().copied().filter(|&label| label > 0).min();
    match smallest {
        Some(smallest) if scalar.size() > 1 && labels.iter().all(|label| label % 256 == 0) => {
            Err(Mistake::ByteSwapped { smallest, order: order.name() })
        }
        _ => Ok(()),
    }
}
