//! Reads results.json back.

use super::json::SCHEMA_VERSION;
use crate::input::read_text;
use crate::study::{Check, Comparison, Provenance, Report, Study};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why there is no report to read.
#[derive(Debug, Error)]
#[allow(missing_docs)] // The messages say it.
pub enum ReportError {
    #[error("there is no {}: name the folder of a report, or its results.json", path.display())]
    Absent { path: PathBuf },
    #[error("cannot read {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{} is not the results.json of a report: {source}", path.display())]
    Malformed { path: PathBuf, source: serde_json::Error },
    #[error(
        "{} has schema version {found}, this program reads {SCHEMA_VERSION}: read it with the \
         version of mtled that wrote it", path.display()
    )]
    Version { path: PathBuf, found: u64 },
    #[error("{} has check {check} of study {study}, and no such study", path.display())]
    Stray { path: PathBuf, check: String, study: String },
}

#[derive(Deserialize)]
struct Head {
    schema_version: u64,
}

#[derive(Deserialize)]
struct File {
    suite: String,
    provenance: Provenance,
    wall_seconds: f64,
    comparison: Option<Comparison>,
    checks: Vec<Check>,
    studies: Vec<Study>,
}

/// The report in a folder, or in the results.json that is named.
pub fn read_report(path: &Path) -> Result<Report, ReportError> {
    let file = if path.is_dir() { path.join("results.json") } else { path.to_path_buf() };
    match read_text(&file) {
        Ok(text) => from_json(&text, &file),
        Err(source) if source.kind() == std::io::ErrorKind::NotFound => {
            Err(ReportError::Absent { path: file })
        }
        Err(source) => Err(ReportError::Unreadable { path: file, source }),
    }
}

/// The report that [`super::json::to_json`] has written to `path`; `null` is
/// read as NaN.
pub fn from_json(text: &str, path: &Path) -> Result<Report, ReportError> {
    let at = || path.to_path_buf();
    let malformed = |source| ReportError::Malformed { path: at(), source };
    let head: Head = serde_json::from_str(text).map_err(malformed)?;
    if head.schema_version != u64::from(SCHEMA_VERSION) {
        return Err(ReportError::Version { path: at(), found: head.schema_version });
    }
    let mut file: File = serde_json::from_str(text).map_err(malformed)?;
    for check in file.checks {
        match file.studies.iter_mut().find(|study| study.id == check.study) {
            Some(study) => study.checks.push(check),
            None => {
                let Check { id: check, study, .. } = check;
                return Err(ReportError::Stray { path: at(), check, study });
            }
        }
    }
    Ok(Report {
        schema_version: SCHEMA_VERSION,
        suite: file.suite,
        provenance: file.provenance,
        studies: file.studies,
        wall_seconds: file.wall_seconds,
        comparison: file.comparison,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{json::to_json, sample};

    fn read(text: &str) -> Result<Report, ReportError> {
        from_json(text, Path::new("results.json"))
    }

    #[test]
    fn a_report_that_is_read_back_is_written_the_same() {
        for report in [sample::report(), sample::compared(), sample::empty()] {
            let text = to_json(&report);
            assert_eq!(to_json(&read(&text).unwrap()), text);
        }
    }

    #[test]
    fn a_null_value_is_read_as_nan() {
        let report = read(&to_json(&sample::report())).unwrap();
        let none = report.checks().find(|check| check.id == "convergence/none").unwrap();
        assert!(none.value.is_nan() && !none.pass);
    }

    #[test]
    fn files_that_are_not_reports_are_refused_with_the_reason() {
        let old =
            to_json(&sample::empty()).replace("\"schema_version\": 1", "\"schema_version\": 7");
        let stray =
            to_json(&sample::report()).replace("\"study\":\"brain\"", "\"study\":\"heart\"");
        let cases = [
            (old.as_str(), "has schema version 7, this program reads 1"),
            ("{\"schema_version\": 1}", "missing field"),
            ("[]", "is not the results.json of a report"),
            (&stray, "of study heart, and no such study"),
        ];
        for (text, message) in cases {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
        let error = read_report(Path::new("nowhere")).unwrap_err().to_string();
        assert!(error.starts_with("there is no nowhere"), "{error}");
    }
}
