//! Vectors of the solver as numpy arrays that own their memory: nothing is copied.
#![allow(non_snake_case)]

use mtled::Vector3;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// An array of rows.
pub(crate) type Rows<T = f64> = Py<PyArray2<T>>;

/// Values one row after the other, as an array with so many columns.
pub(crate) fn rows<T: numpy::Element>(
    py: Python,
    values: Vec<T>,
    columns: usize,
) -> PyResult<Py<PyArray2<T>>> {
    let count = values.len() / columns;
    Ok(values.into_pyarray(py).reshape([count, columns])?.unbind())
}

/// Vectors as an array with three columns.
pub(crate) fn vectors(py: Python, vectors: Vec<Vector3>) -> PyResult<Rows> {
    // Collected in place.
    let flat: Vec<[f64; 3]> = vectors.into_iter().map(<[f64; 3]>::from).collect();
    rows(py, flat.into_flattened(), 3)
}

/// Positions from an array with three columns.
pub(crate) fn positions(array: &PyReadonlyArray2<f64>) -> PyResult<Vec<Vector3>> {
    let array = array.as_array();
    if array.ncols() != 3 {
        return Err(PyValueError::new_err(format!(
            "points need three columns x, y and z in metres, not {}",
            array.ncols()
        )));
    }
    if array.iter().any(|value| !value.is_finite()) {
        return Err(PyValueError::new_err("points must be finite numbers"));
    }
    Ok(array.rows().into_iter().map(|X| Vector3::new(X[0], X[1], X[2])).collect())
}
