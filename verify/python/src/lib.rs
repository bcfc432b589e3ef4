//! The module `mtled._mtled`: cases, their discretisation and their results as Python objects
//! with numpy arrays. Everything that is computed is computed by `mtled` and the crates of the harness;
//! the package around this module is Python.

// A module uses only modules above it.
mod arrays;
mod errors;

mod background;
mod functions;

mod discretisation;
mod warped;

mod result;

mod case;

use pyo3::prelude::*;

/// Cases, their discretisation and their results.
#[pymodule]
mod _mtled {
    #[pymodule_export]
    use super::case::Case;
    #[pymodule_export]
    use super::discretisation::Discretisation;
    #[pymodule_export]
    use super::result::Result;
    #[pymodule_export]
    use super::warped::WarpedImage;
    use mtled_case::bundled::CASES;
    use mtled_case::scene;
    use mtled_verify::cli;
    use pyo3::prelude::*;
    use std::ffi::OsString;

    /// The version of the crates.
    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// Runs the program `mtled` with these arguments and returns its exit code.
    #[pyfunction]
    fn program(py: Python, arguments: Vec<OsString>) -> u8 {
        py.detach(|| cli::run_with(arguments))
    }

    /// The JSON Schema of case files.
    #[pyfunction]
    fn schema() -> String {
        scene::schema()
    }

    /// Names and texts of the bundled cases.
    #[pyfunction]
    fn bundled_cases() -> Vec<(&'static str, &'static str)> {
        CASES.to_vec()
    }
}
