//! A case, and what can be done with it.

use crate::background::{Watch, in_background};
use crate::discretisation::Discretisation;
use crate::errors::{case_error, exception, set_up_error, solve_error};
use crate::functions;
use crate::result::Result;
use mtled::Shape;
use mtled::Simulation;
use mtled::problem::Prescribed;
use mtled_case::scene::{self, Mistakes, Override, parse_overridden, with_absolute_paths};
use mtled_run::run::{ensure_fits, load, located, solve_recorded, warnings};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A case without mistakes.
#[pyclass(frozen, module = "mtled")]
pub(crate) struct Case {
    case: Arc<scene::Case>,
    /// Where the files are that it names relative to it; none of a bundled case.
    folder: Option<PathBuf>,
    /// Whether its text states all of it: a body from Python it does not.
    stated: bool,
    /// Conditions with the Python functions that give their displacements.
    displacements: Vec<(usize, Py<PyAny>)>,
}

fn overrides(texts: &[String]) -> PyResult<Vec<Override>> {
    let parsed = texts.iter().map(|text| text.parse::<Override>());
    parsed.collect::<std::result::Result<_, _>>().map_err(|error| exception(error.into()))
}

#[pymethods]
impl Case {
    /// Reads a case file, or a bundled case by its name, with `KEY=VALUE` in place of its own.
    #[staticmethod]
    fn load(py: Python, path: PathBuf, set: Vec<String>) -> PyResult<Case> {
        let set = overrides(&set)?;
        let case = py.detach(|| load(&path, &set)).map_err(exception)?;
        let folder = path.is_file().then(|| path.parent().unwrap_or(Path::new("")).to_path_buf());
        Ok(Case { case: Arc::new(case), folder, stated: true, displacements: Vec::new() })
    }

    /// Reads a case from its text; `file` names it in messages, other files are looked for in
    /// `folder`.
    #[staticmethod]
    fn parse(
        py: Python,
        text: &str,
        file: &str,
        folder: PathBuf,
        set: Vec<String>,
    ) -> PyResult<Case> {
        let set = overrides(&set)?;
        let parsed = py.detach(|| parse_overridden(text, file, &folder, &set));
        let case = parsed.map_err(|mistakes| case_error(&Mistakes(mistakes)))?;
        py.detach(|| ensure_fits(&case)).map_err(exception)?;
        Ok(Case {
            case: Arc::new(case),
            folder: Some(folder),
            stated: true,
            displacements: Vec::new(),
        })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.case.name
    }

    #[getter]
    fn title(&self) -> &str {
        &self.case.title
    }

    #[getter]
    fn description(&self) -> &str {
        &self.case.description
    }

    #[getter]
    fn file(&self) -> &str {
        self.case.file()
    }

    #[getter]
    fn text(&self) -> &str {
        self.case.text()
    }

    #[getter]
    fn hash(&self) -> &str {
        &self.case.hash
    }

    #[getter]
    fn overrides(&self) -> Vec<String> {
        self.case.overrides().iter().map(ToString::to_string).collect()
    }

    #[getter]
    fn conditions(&self) -> Vec<String> {
        self.case.problem.conditions.iter().map(|condition| condition.name.clone()).collect()
    }

    #[getter]
    fn is_bundled(&self) -> bool {
        self.folder.is_none()
    }

    #[getter]
    fn has_functions(&self) -> bool {
        !self.stated || !self.displacements.is_empty()
    }

    /// The text with absolute names of files, which can be stored in any folder.
    fn portable_text(&self) -> PyResult<String> {
        let folder = self.folder.as_deref().unwrap_or(Path::new("."));
        with_absolute_paths(self.case.text(), folder).map_err(|error| exception(error.into()))
    }

    /// The case with the solid in which `distance(x, y, z)` is negative as its body. It is
    /// sampled at points `sample_m` apart at most.
    fn with_distance(
        &self,
        distance: Bound<PyAny>,
        lower_m: [f64; 3],
        upper_m: [f64; 3],
        sample_m: f64,
    ) -> PyResult<Case> {
        let (py, corners) = (distance.py(), (lower_m.into(), upper_m.into()));
        let body = functions::distance(&distance, corners.0, corners.1, sample_m)?;
        let mut case = scene::Case::clone(&self.case);
        case.problem.body = Shape::Function(body);
        py.detach(|| ensure_fits(&case)).map_err(exception)?;
        Ok(Case { case: Arc::new(case), stated: false, ..self.copy(py) })
    }

    /// The case with the displacement that `displacement(x, y, z)` returns in a condition.
    fn with_displacement(
        &self,
        py: Python,
        condition: &str,
        displacement: Py<PyAny>,
    ) -> PyResult<Case> {
        let known = self.conditions();
        let Some(condition) = known.iter().position(|name| name == condition) else {
            return Err(PyKeyError::new_err(format!(
                "there is no condition called {condition}; the case has {}",
                known.join(", ")
            )));
        };
        let mut case = self.copy(py);
        case.displacements.push((condition, displacement));
        Ok(case)
    }

    /// Nodes, quadrature points and supports.
    fn discretise(&self, py: Python) -> PyResult<Discretisation> {
        let watch = Arc::new(Watch::default());
        let case = self.effective(py, &watch);
        let (simulation, warnings) = in_background(py, &watch, None, move |_| {
            let simulation = Simulation::with_any_recipe(&case.problem)
                .map_err(|error| set_up_error(&located(&case, &error)))?;
            let warnings = warnings(&case, &simulation);
            PyResult::Ok((simulation, warnings))
        })??;
        Discretisation::new(py, simulation, warnings)
    }

    /// Sets the case up and runs it.
    fn solve(&self, py: Python, error_bars: bool, progress: Option<Py<PyAny>>) -> PyResult<Result> {
        let watch = Arc::new(Watch::default());
        let case = self.effective(py, &watch);
        let stated = !self.has_functions();
        let run = case.clone();
        let finished = in_background(py, &watch, progress.as_ref(), move |watch| {
            let simulation = Simulation::new(&run.problem)
                .map_err(|error| set_up_error(&located(&run, &error)))?;
            solve_recorded(&run, simulation, error_bars, &|done, step| watch.report(done, step))
                .map_err(|failed| solve_error(&located(&run, &failed.error), failed.outcome()))
        })??;
        Result::new(py, case, finished, stated)
    }
}

impl Case {
    fn copy(&self, py: Python) -> Case {
        let displacements = self.displacements.iter();
        Case {
            case: self.case.clone(),
            folder: self.folder.clone(),
            stated: self.stated,
            displacements: displacements
                .map(|(n, function)| (*n, function.clone_ref(py)))
                .collect(),
        }
    }

    /// The case with the Python functions in it, whose exceptions end the work of `watch`.
    fn effective(&self, py: Python, watch: &Arc<Watch>) -> Arc<scene::Case> {
        if self.displacements.is_empty() {
            return self.case.clone();
        }
        let mut case = scene::Case::clone(&self.case);
        for (condition, function) in &self.displacements {
            let field = functions::displacement(function.clone_ref(py), watch.clone());
            case.problem.conditions[*condition].prescribed = Prescribed::Field(field);
        }
        Arc::new(case)
    }
}
