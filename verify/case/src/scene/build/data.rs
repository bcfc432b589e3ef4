//! Fields of a case file through data at scattered points or voxels.
#![allow(non_snake_case)]

use crate::scene::build::builder::Builder;
use crate::scene::format::DataFormat;
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{DistanceFunction, Scattered, Selector, Shape};
use mtled::problem::Dimension;
use mtled_io::files::image::{VectorFile, VectorFrame, is_image, read_vectors};
use mtled_io::files::points::read_displacements;
use mtled_io::files::{FileError, LengthUnit};
use std::path::Path;
use std::sync::Arc;

impl Builder<'_> {
    /// A field of displacements \[m\] through data, or `None` and a mistake.
    pub(crate) fn displacements(
        &mut self,
        key: &str,
        format: &DataFormat,
    ) -> Option<Arc<Scattered>> {
        let data = self.vectors(key, format)?;
        self.scattered(key, format, data)
    }

    /// A field of directions through data, or `None` and a mistake. Where a vector is 0, as outside
    /// of what a scanner saw, there is none.
    pub(crate) fn axes(&mut self, key: &str, format: &DataFormat) -> Option<Arc<Scattered>> {
        let mut data = self.vectors(key, format)?;
        data.retain(|(_, direction)| direction.norm() > 0.0);
        self.scattered(key, format, data)
    }

    fn scattered(
        &mut self,
        key: &str,
        format: &DataFormat,
        mut data: Vec<(Vector3, Vector3)>,
    ) -> Option<Arc<Scattered>> {
        if let Dimension::PlaneStrain { z, .. } = self.dimension {
            data.iter_mut().for_each(|(position, vector)| (position.z, vector.z) = (z, 0.0));
        }
        match Scattered::new(&data, format.reach) {
            Ok(scattered) => Some(Arc::new(scattered)),
            Err(error) => {
                self.mistake(&format!("{key}.file"), error);
                None
            }
        }
    }

    /// Places and vectors \[m\] of a file, or `None` and a mistake.
    fn vectors(&mut self, key: &str, format: &DataFormat) -> Option<Vec<(Vector3, Vector3)>> {
        self.positive(&format!("{key}.reach"), format.reach);
        let path = self.resolve(&format.file);
        let is_image = is_image(&path);
        if format.frame.is_some() && !is_image {
            self.mistake(&format!("{key}.frame"), "belongs to images (NIfTI, NRRD); remove it");
            return None;
        }
        if format.field.is_some() && is_image {
            self.mistake(&format!("{key}.field"), "belongs to VTU files; remove it");
            return None;
        }
        let read = if is_image { from_image(&path, format) } else { from_table(&path, format) };
        let key = format!("{key}.file");
        let read = match read {
            Ok(read) => read,
            Err(error) => {
                self.mistake(&key, error);
                return None;
            }
        };
        self.has_read(&key, &format.file, &read.files, &read.notes);
        let scaled = |(position, vector)| (position, vector * format.factor);
        Some(read.vectors.into_iter().map(scaled).collect())
    }
}

fn from_image(path: &Path, format: &DataFormat) -> Result<VectorFile, FileError> {
    read_vectors(path, format.unit.map(LengthUnit::from), format.frame.map(VectorFrame::from))
}

fn from_table(path: &Path, format: &DataFormat) -> Result<VectorFile, FileError> {
    let unit = format.unit.map_or(1.0, |unit| LengthUnit::from(unit).in_metres());
    let rows = read_displacements(path, format.field_name())?;
    let vectors = rows.into_iter().map(|(position, vector)| (unit * position, unit * vector));
    let (vectors, files) = (vectors.collect(), vec![path.to_path_buf()]);
    Ok(VectorFile { vectors, files, notes: Vec::new() })
}

/// The positions within reach of the data.
pub(crate) fn near(data: &Arc<Scattered>) -> Selector {
    let (lower, upper) = data.bounds();
    let data = data.clone();
    let distance = move |X: &Vector3| data.distance(X) - data.reach();
    let shape = Shape::Function(DistanceFunction::new(lower, upper, distance));
    Selector::Inside { shape, tolerance: 0.0 }
}
