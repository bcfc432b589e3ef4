//! Python functions as parts of a problem: a signed distance, a displacement.
#![allow(non_snake_case)]

use crate::background::Watch;
use mtled::geometry::Field;
use mtled::{DistanceFunction, Vector3};
use numpy::{IntoPyArray, PyArrayLike1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

/// Most samples of a distance: 1 GB.
const MOST_SAMPLES: f64 = 1.25e8;

/// A signed distance on a lattice. The solver asks for thousands of distances for each node, from
/// all of its threads: Python is asked once for all.
struct Lattice {
    lower: Vector3,
    upper: Vector3,
    /// Distance of samples along x, y and z \[m\].
    step: Vector3,
    counts: [usize; 3],
    /// x fastest \[m\].
    samples: Vec<f64>,
}

impl Lattice {
    /// Without samples, which are at most `sample` \[m\] apart.
    fn new(lower: Vector3, upper: Vector3, sample: f64) -> PyResult<Lattice> {
        let edges = upper - lower;
        let sound = |edge: &f64| *edge > 0.0 && edge.is_finite();
        if !edges.iter().all(sound) || !lower.iter().all(|corner| corner.is_finite()) {
            return Err(PyValueError::new_err(
                "the corners of the box around the body must be finite, and the lower one below \
                 the upper one along x, y and z",
            ));
        }
        let cells = edges.map(|edge| (edge / sample).ceil().max(1.0));
        let count = cells.iter().map(|cells| cells + 1.0).product::<f64>();
        if sample <= 0.0 || count.is_nan() || count > MOST_SAMPLES {
            return Err(PyValueError::new_err(format!(
                "samples {sample} m apart in this box are {count:.0}; give a distance above 0 with \
                 at most {MOST_SAMPLES:.0} of them"
            )));
        }
        let counts = [0, 1, 2].map(|axis| cells[axis] as usize + 1);
        let step = edges.component_div(&cells);
        Ok(Lattice { lower, upper, step, counts, samples: Vec::new() })
    }

    fn coordinates(&self, axis: usize) -> Vec<f64> {
        let [nx, ny, nz] = self.counts;
        let index = |n: usize| [n % nx, n / nx % ny, n / (nx * ny)][axis];
        (0..nx * ny * nz).map(|n| self.lower[axis] + self.step[axis] * index(n) as f64).collect()
    }

    /// Linear between the samples; around the box the distance to it is added.
    fn at(&self, X: &Vector3) -> f64 {
        let inside = X.sup(&self.lower).inf(&self.upper);
        let place = (inside - self.lower).component_div(&self.step);
        let [nx, ny, _] = self.counts;
        let mut value = 0.0;
        let low = [0, 1, 2].map(|axis| (place[axis] as usize).min(self.counts[axis] - 2));
        for corner in 0..8usize {
            let mut weight = 1.0;
            let index = [0, 1, 2].map(|axis| {
                let (fraction, high) = (place[axis] - low[axis] as f64, corner >> axis & 1);
                weight *= if high == 1 { fraction } else { 1.0 - fraction };
                low[axis] + high
            });
            value += weight * self.samples[index[0] + nx * (index[1] + ny * index[2])];
        }
        value + (X - inside).norm()
    }
}

/// The solid in which `callable(x, y, z)`, a signed distance \[m\] of arrays, is negative.
pub(crate) fn distance(
    callable: &Bound<PyAny>,
    lower: Vector3,
    upper: Vector3,
    sample: f64,
) -> PyResult<DistanceFunction> {
    let mut lattice = Lattice::new(lower, upper, sample)?;
    let py = callable.py();
    let coordinates = [0, 1, 2].map(|axis| lattice.coordinates(axis).into_pyarray(py));
    let count = coordinates[0].len()?;
    let returned = callable.call1(<(_, _, _)>::from(coordinates))?;
    let distances: PyArrayLike1<f64, numpy::AllowTypeChange> = returned.extract()?;
    lattice.samples = distances.as_array().to_vec();
    if lattice.samples.len() != count {
        return Err(PyValueError::new_err(format!(
            "the function has returned {} distances for {count} points; it takes arrays x, y and z \
             and must return one of the same length",
            lattice.samples.len()
        )));
    }
    if let Some(n) = lattice.samples.iter().position(|distance| !distance.is_finite()) {
        return Err(PyValueError::new_err(format!(
            "the function has returned {} for point {n}; distances must be finite numbers",
            lattice.samples[n]
        )));
    }
    Ok(DistanceFunction::new(lower, upper, move |X| lattice.at(X)))
}

/// The displacement \[m\] that `callable(x, y, z)` returns as three numbers for one position
/// \[m\]. What it raises ends the work of `watch`.
pub(crate) fn displacement(callable: Py<PyAny>, watch: Arc<Watch>) -> Field {
    Field::of(move |X| {
        let none = Vector3::repeat(f64::NAN);
        if watch.is_stopped() {
            return none;
        }
        Python::attach(|py| {
            let returned = callable.bind(py).call1((X.x, X.y, X.z));
            let value = returned.and_then(|value| value.extract::<[f64; 3]>());
            value.map(Vector3::from).unwrap_or_else(|error| {
                watch.raise(error);
                none
            })
        })
    })
}
