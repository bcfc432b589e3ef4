//! The result of a run.

use crate::arrays::{Rows, positions, rows, vectors};
use crate::errors::exception;
use crate::warped::{WarpedImage, unit_of};
use mtled_case::scene::Case;
use mtled_io::files::image::{Interpolation, read_image};
use mtled_run::picture::{Choice, Shown, panels, picture_svg};
use mtled_run::run::{Finished, StoredField, field_at_nodes, history};
use mtled_run::warp::{DisplacementField, deform, nodes_outside};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::Arc;

/// Vertices, cells, regions of cells, and fields by their names.
type MeshArrays<'py> = (Rows, Rows<u32>, Py<PyArray1<u16>>, Bound<'py, PyDict>);

/// What a run has come to. Displacements are those of the field, not nodal parameters.
#[pyclass(frozen, module = "mtled")]
pub(crate) struct Result {
    case: Arc<Case>,
    finished: Arc<Finished>,
    /// Whether the text of the case states all of the problem.
    stated: bool,
    /// Reference positions of the nodes [m], (nodes, 3).
    #[pyo3(get)]
    nodes_m: Rows,
    /// The displacement field at the nodes [m], (nodes, 3).
    #[pyo3(get)]
    displacement_m: Rows,
}

impl Result {
    /// Of a finished run; `stated` says whether the text of the case states all of the problem.
    pub(crate) fn new(
        py: Python,
        case: Arc<Case>,
        finished: Finished,
        stated: bool,
    ) -> PyResult<Result> {
        let simulation = &finished.solved.simulation;
        let field = py
            .detach(|| field_at_nodes(simulation, &finished.solved.simulation.state.displacement));
        Ok(Result {
            nodes_m: vectors(py, simulation.discretisation.cloud.positions.clone())?,
            displacement_m: rows(py, field.map_err(exception)?, 3)?,
            case,
            finished: Arc::new(finished),
            stated,
        })
    }

    /// Refuses what would be read back with the case file, where that does not state the problem.
    fn ensure_stated(&self) -> PyResult<()> {
        match self.stated {
            true => Ok(()),
            false => Err(PyValueError::new_err(
                "the folder of a run belongs to its case file, and that does not state the Python \
                 functions of this case; store the arrays instead",
            )),
        }
    }

    fn body(&self, py: Python) -> PyResult<mtled_run::picture::Body> {
        let body = py.detach(|| self.finished.body(&self.case)).map_err(exception)?;
        body.ok_or_else(|| {
            PyValueError::new_err(
                "there is no mesh to look at: the case has no frames (`output.frames` is 0), or \
                 nothing of its body is as large as a cell",
            )
        })
    }
}

#[pymethods]
impl Result {
    /// The text of `result.json`.
    fn json(&self) -> String {
        self.finished.json(&self.case).to_string()
    }

    /// The main results, a line each.
    fn text(&self) -> String {
        self.finished.text(&self.case)
    }

    /// Names of the columns with their units, and a row for each sample.
    fn history(&self, py: Python) -> PyResult<(Vec<String>, Rows)> {
        let (names, samples) = history(&self.case, &self.finished.record);
        let columns = names.len();
        Ok((names, rows(py, samples.concat(), columns)?))
    }

    /// The displacement field [m] at reference positions [m] in the body, (points, 3).
    fn displacement_at(&self, py: Python, points_m: PyReadonlyArray2<f64>) -> PyResult<Rows> {
        let points = positions(&points_m)?;
        let solved = &self.finished.solved;
        let displacement = py.detach(|| {
            let rows = solved.simulation.discretisation.rows_at(&points)?;
            let (u, components) =
                (&solved.simulation.state.displacement, solved.simulation.model.components);
            Ok((0..points.len()).map(|i| rows.interpolate(i, u, components)).collect::<Vec<_>>())
        });
        let displacement =
            displacement.map_err(|error: mtled::Error| PyValueError::new_err(error.to_string()))?;
        vectors(py, displacement)
    }

    /// The mesh to look at: vertices [m], cells by their vertices, region of each cell, and the
    /// fields at the vertices.
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<MeshArrays<'py>> {
        let body = self.body(py)?;
        let fields = PyDict::new(py);
        for field in body.fields {
            match field.components {
                1 => fields.set_item(field.name, field.values.into_pyarray(py))?,
                columns => fields.set_item(field.name, rows(py, field.values, columns)?)?,
            }
        }
        let mesh = body.mesh;
        Ok((
            vectors(py, mesh.vertices)?,
            rows(py, mesh.cells, mesh.corners)?,
            mesh.regions.into_pyarray(py).unbind(),
            fields,
        ))
    }

    /// The body before and after as SVG, coloured by a field.
    fn picture(&self, py: Python, field: &str) -> PyResult<String> {
        let body = self.body(py)?;
        let Some(field) = body.field(field) else {
            let known: Vec<&str> = body.fields.iter().map(|field| field.name.as_str()).collect();
            return Err(PyValueError::new_err(format!(
                "there is no field \"{field}\"; there are {}",
                known.join(", ")
            )));
        };
        let choice = Choice { direction: None, shown: Shown::usual(&body.mesh) };
        let drawn = py.detach(|| panels(&body, field, &choice));
        let (drawn, scale) = drawn.map_err(exception)?;
        Ok(picture_svg(&drawn, &scale, &format!("{}, {}", self.case.name, field.label())))
    }

    /// An image after the deformation, on its own grid.
    fn warp(
        &self,
        py: Python,
        image: PathBuf,
        labels: bool,
        decay_m: Option<f64>,
        unit: Option<&str>,
    ) -> PyResult<WarpedImage> {
        if decay_m.is_some_and(|decay| !(0.0..f64::INFINITY).contains(&decay)) {
            return Err(PyValueError::new_err("the distance of the decay must be 0 m or more"));
        }
        let unit = unit.map(unit_of).transpose()?;
        let how = if labels { Interpolation::Nearest } else { Interpolation::Linear };
        let warped = py.detach(|| -> anyhow::Result<_> {
            let (case, solved) = (&self.case, &self.finished.solved);
            let u = &solved.simulation.state.displacement;
            let stored = StoredField::new(case, &solved.simulation, u, solved.summary.stopped);
            let field = DisplacementField::new(&stored, &case.problem, decay_m)?;
            let read = read_image(&image, unit)?;
            let outside = nodes_outside(&field, &read.grid, &image)?;
            let deformed = deform(&field, &read, how);
            Ok((read, deformed, outside))
        });
        let (read, deformed, outside) = warped.map_err(exception)?;
        WarpedImage::new(py, read, deformed, outside)
    }

    /// Writes the files that `mtled solve` writes to a folder.
    fn write(&self, py: Python, folder: PathBuf) -> PyResult<()> {
        self.ensure_stated()?;
        py.detach(|| self.finished.write(&self.case, &folder)).map(drop).map_err(exception)
    }
}
