//! An image after a deformation.

use crate::arrays::{Rows, rows};
use crate::errors::exception;
use mtled_checks::report::write_atomically;
use mtled_io::files::LengthUnit;
use mtled_io::files::image::{Grid, Image, ImageFormat, field_bytes, image_bytes};
use mtled_run::warp::Deformed;
use numpy::{IntoPyArray, PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

/// A warped image, and where its voxels came from.
#[pyclass(frozen, module = "mtled")]
pub(crate) struct WarpedImage {
    image: Image,
    sources: Vec<[f32; 3]>,
    /// The stored bytes, first index fastest.
    #[pyo3(get)]
    bytes: Py<PyArray1<u8>>,
    /// Voxels for which no place was found that moved there: the body has folded.
    #[pyo3(get)]
    unconverged: usize,
    /// Voxels that came from outside of the image; they are 0.
    #[pyo3(get)]
    from_outside: usize,
    /// Nodes of the body outside of the image.
    #[pyo3(get)]
    nodes_outside: usize,
}

/// A unit of length by its name.
pub(crate) fn unit_of(name: &str) -> PyResult<LengthUnit> {
    match name {
        "m" => Ok(LengthUnit::Metre),
        "mm" => Ok(LengthUnit::Millimetre),
        "um" => Ok(LengthUnit::Micrometre),
        _ => Err(PyValueError::new_err(format!("\"{name}\" is no unit; there are m, mm and um"))),
    }
}

impl WarpedImage {
    /// Of an image and its deformation.
    pub(crate) fn new(
        py: Python,
        image: Image,
        deformed: Deformed,
        nodes_outside: usize,
    ) -> PyResult<WarpedImage> {
        Ok(WarpedImage {
            bytes: deformed.voxels.into_pyarray(py).unbind(),
            sources: deformed.sources,
            unconverged: deformed.unconverged,
            from_outside: deformed.from_outside,
            image,
            nodes_outside,
        })
    }

    fn grid(&self) -> &Grid {
        &self.image.grid
    }
}

#[pymethods]
impl WarpedImage {
    /// Number of voxels along each index.
    #[getter]
    fn shape(&self) -> [usize; 3] {
        self.grid().size
    }

    /// The type of the stored numbers as numpy writes it.
    #[getter]
    fn dtype(&self) -> String {
        self.image.array_type()
    }

    /// Centre of the first voxel [m] along R, A and S.
    #[getter]
    fn origin_m(&self) -> [f64; 3] {
        self.grid().origin.into()
    }

    /// Steps from one voxel to the next [m]: a column for each index, (3, 3).
    #[getter]
    fn directions_m(&self, py: Python) -> PyResult<Rows> {
        let by_rows = self.grid().directions.transpose();
        rows(py, by_rows.iter().copied().collect(), 3)
    }

    /// The vectors X − x [m] to where each voxel came from, first index fastest, (voxels, 3).
    #[getter]
    fn source_vectors_m(&self, py: Python) -> PyResult<Rows<f32>> {
        rows(py, self.sources.clone().into_flattened(), 3)
    }

    /// Writes the image; the ending of the name is .nii, .nii.gz or .nrrd.
    fn write(&self, py: Python, path: PathBuf) -> PyResult<()> {
        let bytes = self.bytes.bind(py).readonly();
        let voxels = bytes.as_slice()?;
        write(&path, |format| Ok(image_bytes(&self.image, voxels, format, &path)?))
    }

    /// Writes the vectors as a displacement field that ITK reads.
    fn write_inverse_field(&self, path: PathBuf) -> PyResult<()> {
        write(&path, |format| Ok(field_bytes(self.grid(), &self.sources, format, &path)?))
    }
}

fn write(path: &Path, bytes: impl FnOnce(ImageFormat) -> anyhow::Result<Vec<u8>>) -> PyResult<()> {
    let written =
        || -> anyhow::Result<()> { write_atomically(path, &bytes(ImageFormat::of_output(path)?)?) };
    written().map_err(exception)
}
