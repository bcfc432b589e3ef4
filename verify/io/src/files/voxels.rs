//! Label maps from the bytes of their voxels.

use super::bytes::{ByteOrder, Scalar};
use super::error::Mistake;
use super::shear::{LARGEST_SHEAR, PERPENDICULAR, largest_cosine, upright};
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::{GeometryError, LabelMap};
use std::path::PathBuf;

/// A label map in RAS world coordinates (x right, y anterior, z superior) and
/// the files it came from.
#[derive(Debug, Clone)]
pub struct LabelMapFile {
    /// The labels.
    pub map: LabelMap,
    /// The file that was named, then a detached data file.
    pub files: Vec<PathBuf>,
    /// What should be known about them.
    pub notes: Vec<String>,
}

/// An image in metres from its parts, with what must be said about its labels. Where the
/// steps are not perpendicular, labels are those of the nearest voxels on a grid that is.
pub(crate) fn label_map(
    size: [usize; 3],
    origin: Vector3,
    directions: Matrix3,
    labels: Labels,
    notes: &mut Vec<String>,
) -> Result<LabelMap, Mistake> {
    notes.extend(labels.notes);
    let cosine = largest_cosine(&directions);
    if !(PERPENDICULAR..LARGEST_SHEAR).contains(&cosine) {
        let map = LabelMap::new(size, origin, directions, labels.values);
        return map.map_err(Mistake::Geometry);
    }
    notes.push(format!(
        "the steps from voxel to voxel are not perpendicular (the largest cosine is {cosine:.4}): \
         the labels are those of the nearest voxels on a perpendicular grid"
    ));
    let (upright_size, first, steps) = upright(size, &origin, &directions);
    let count = voxel_count(&upright_size)?;
    let singular = GeometryError::SingularDirections { determinant: directions.determinant() };
    let to_index = directions.try_inverse().ok_or(Mistake::Geometry(singular))?;
    let [nx, ny, _] = upright_size;
    let nearest = |n: usize| {
        let index = Vector3::from([n % nx, n / nx % ny, n / (nx * ny)].map(|c| c as f64));
        let voxel = (to_index * (first + steps * index - origin)).map(|c| (c + 0.5).floor());
        let is_in = (0..3).all(|axis| (0.0..size[axis] as f64).contains(&voxel[axis]));
        let [i, j, k] = [0, 1, 2].map(|axis| voxel[axis] as usize);
        if is_in { labels.values[i + size[0] * (j + size[1] * k)] } else { 0 }
    };
    let values = (0..count).map(nearest).collect();
    LabelMap::new(upright_size, first, steps, values).map_err(Mistake::Geometry)
}

/// Whether directions span no volume.
pub(crate) fn are_singular(directions: &Matrix3) -> bool {
    let volume: f64 = directions.column_iter().map(|step| step.norm()).product();
    !(directions.determinant().abs() > 1e-9 * volume && volume.is_finite())
}

/// The largest label.
const LARGEST: f64 = u32::MAX as f64;

/// The most voxels of an image: 1024³, whose distances take 64 GB.
const MOST_VOXELS: usize = 1 << 30;

/// Number of voxels of an image, refused where it is 0 or more than can be used.
pub(crate) fn voxel_count(sizes: &[usize]) -> Result<usize, Mistake> {
    let count = sizes.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
    match count {
        Some(count) if (1..=MOST_VOXELS).contains(&count) => Ok(count),
        _ => Err(Mistake::BadSizes { sizes: sizes.to_vec(), most: MOST_VOXELS }),
    }
}

/// Labels of an image, first index fastest, and what must be said about them.
#[derive(Debug)]
pub(crate) struct Labels {
    values: Vec<u32>,
    notes: Vec<String>,
}

impl Labels {
    /// From numbers; negative ones and NaN mean outside, as 0 does.
    pub(crate) fn of(
        numbers: impl IntoIterator<Item = f64>,
        scalar: Scalar,
        order: ByteOrder,
    ) -> Result<Labels, Mistake> {
        let mut outside = 0usize;
        let label = |(voxel, value): (usize, f64)| {
            let is_outside = value.is_nan() || (value < 0.0 && value.fract() == 0.0);
            outside += usize::from(is_outside);
            if is_outside { Ok(0) } else { label(voxel, value, scalar, order) }
        };
        let values: Vec<u32> =
            numbers.into_iter().enumerate().map(label).collect::<Result<_, _>>()?;
        let mut notes = Vec::new();
        if outside > 0 {
            notes.push(format!(
                "{outside} of {} voxels are negative or NaN; they count as outside, as 0 does",
                values.len()
            ));
        }
        notes.extend(maybe_swapped_bytes(&values, scalar, order));
        Ok(Labels { values, notes })
    }
}

/// One label from its value.
fn label(voxel: usize, value: f64, scalar: Scalar, order: ByteOrder) -> Result<u32, Mistake> {
    if (0.0..=LARGEST).contains(&value) && value.fract() == 0.0 {
        return Ok(value as u32);
    }
    if scalar.size() > 1 && value > LARGEST {
        return Err(Mistake::LabelTooLarge { voxel, value, order: order.name() });
    }
    Err(Mistake::NotALabel { voxel, value })
}

/// Small labels of two bytes read the wrong way round are multiples of 256.
fn maybe_swapped_bytes(labels: &[u32], scalar: Scalar, order: ByteOrder) -> Option<String> {
    let smallest = labels.iter().copied().filter(|&label| label > 0).min()?;
    let all = scalar.size() > 1 && labels.iter().all(|label| label % 256 == 0);
    all.then(|| {
        format!(
            "every label is a multiple of 256 (the smallest is {smallest}): if that is not so in \
             the program that made it, the byte order of the header ({} endian) is wrong",
            order.name()
        )
    })
}
