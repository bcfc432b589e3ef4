//! Errors of the crates as exceptions of the package, which `mtled/errors.py` defines.

use mtled_case::scene::{Diagnostic, Mistakes};
use mtled_io::files::FileError;
use mtled_run::warp::WarpError;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

mod python {
    use pyo3::import_exception;

    import_exception!(mtled.errors, MtledError);
    import_exception!(mtled.errors, CaseError);
    import_exception!(mtled.errors, SetUpError);
    import_exception!(mtled.errors, SolveError);
    import_exception!(mtled.errors, ImageError);
}

/// File, line, column, key and message of a mistake; line 0 is the file as a whole.
type Place = (String, usize, usize, String, String);

fn place(mistake: &Diagnostic) -> Place {
    let location = &mistake.location;
    (
        location.file.clone(),
        location.line,
        location.column,
        mistake.key.clone(),
        mistake.message.clone(),
    )
}

/// `CaseError`: the mistakes of a case file.
pub(crate) fn case_error(mistakes: &Mistakes) -> PyErr {
    let places: Vec<Place> = mistakes.0.iter().map(place).collect();
    python::CaseError::new_err((mistakes.to_string(), places))
}

/// `SetUpError`: the solver refuses what a case states.
pub(crate) fn set_up_error(mistake: &Diagnostic) -> PyErr {
    python::SetUpError::new_err((mistake.to_string(), vec![place(mistake)]))
}

/// `SolveError`: a run has failed, `outcome` says how.
pub(crate) fn solve_error(mistake: &Diagnostic, outcome: &str) -> PyErr {
    python::SolveError::new_err((mistake.to_string(), vec![place(mistake)], outcome.to_string()))
}

/// Any other error: the exception that fits to it.
pub(crate) fn exception(error: anyhow::Error) -> PyErr {
    if let Some(mistakes) = error.downcast_ref::<Mistakes>() {
        return case_error(mistakes);
    }
    let text = format!("{error:#}");
    if error.is::<FileError>() || error.is::<WarpError>() {
        return python::ImageError::new_err(text);
    }
    if error.chain().any(|cause| cause.is::<std::io::Error>()) {
        return PyOSError::new_err(text);
    }
    python::MtledError::new_err(text)
}
