//! The files of a report, written atomically.

use super::{html, json, junit, markdown, svg};
use crate::study::{Report, Table};
use anyhow::{Context, Result};
use std::io::Write;
use std::path::Path;

/// Writes results.json, junit.xml, index.html, summary.md and every figure into
/// `dir`, which is created where it is missing.
pub fn write_report(report: &Report, dir: &Path) -> Result<()> {
    debug_assert!(report.studies.iter().flat_map(|study| &study.tables).all(is_rectangular));
    let files = [
        ("results.json", json::to_json(report)),
        ("junit.xml", junit::to_junit(report)),
        ("index.html", html::to_html(report)?),
        ("summary.md", markdown::to_markdown(report)),
    ];
    for (name, text) in files {
        write_atomically(&dir.join(name), text.as_bytes())?;
    }
    write_figures(report, &dir.join("figures"))?;
    write_failures(report, dir)
}

/// Whether each row has a cell for each column.
fn is_rectangular(table: &Table) -> bool {
    table.rows.iter().all(|row| row.len() == table.columns.len())
}

/// The input files that reproduce failures; those of checks that pass now are
/// removed.
fn write_failures(report: &Report, dir: &Path) -> Result<()> {
    for check in report.checks() {
        match (check.failure_file(), &check.reproduce) {
            (Some(file), Some(case)) => write_atomically(&dir.join(file), case.as_bytes())?,
            _ => {
                let old = dir.join(format!("failures/{}.toml", check.id.replace('/', "-")));
                if old.exists() {
                    std::fs::remove_file(&old)
                        .with_context(|| format!("cannot remove {}", old.display()))?;
                }
            }
        }
    }
    Ok(())
}

/// Every figure as a file of its own, `<study>-<number>.svg`.
fn write_figures(report: &Report, dir: &Path) -> Result<()> {
    for study in &report.studies {
        for (number, figure) in study.figures.iter().enumerate() {
            let name = format!("{}-{}.svg", study.id, number + 1);
            write_atomically(&dir.join(name), svg::to_svg_file(figure).as_bytes())?;
        }
    }
    Ok(())
}

/// Writes a temporary file beside `path` and renames it, so that a reader sees
/// the old bytes or the new ones and never a part; missing folders are created.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    let name = path.file_name().with_context(|| format!("{} names no file", path.display()))?;
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".{}.tmp", std::process::id()));
    let temporary = path.with_file_name(hidden);
    let written = write_then_rename(&temporary, path, bytes);
    if written.is_err() {
        // Best effort: the first error is the one to report.
        let _ = std::fs::remove_file(&temporary);
    }
    written.with_context(|| format!("cannot write {}", path.display()))
}

fn write_then_rename(temporary: &Path, path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder)?;
    }
    let mut file = std::fs::File::create(temporary)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    drop(file);
    std::fs::rename(temporary, path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    /// Set MTLED_SAMPLE_REPORT to a folder to see the pages.
    #[test]
    fn a_report_is_four_files_and_folders_of_figures_and_failing_cases() {
        let scratch = tempfile::tempdir().unwrap();
        let kept = std::env::var_os("MTLED_SAMPLE_REPORT").map(std::path::PathBuf::from);
        let folder = kept.unwrap_or(scratch.path().join("deep/report"));
        write_report(&sample::compared(), &folder).unwrap();
        write_report(&sample::compared(), &folder).unwrap();
        let mut names: Vec<_> = std::fs::read_dir(&folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| !name.ends_with(".png"))
            .collect();
        names.sort();
        let files =
            ["failures", "figures", "index.html", "junit.xml", "results.json", "summary.md"];
        assert_eq!(names, files);
    }

    #[test]
    fn the_case_of_a_failure_lies_beside_the_report_until_the_check_passes() {
        let folder = tempfile::tempdir().unwrap();
        let mut report = sample::compared();
        write_report(&report, folder.path()).unwrap();
        let case = folder.path().join("failures/brain-tumour-shift.toml");
        assert_eq!(std::fs::read_to_string(&case).unwrap(), "# smallest\nname = \"brain\"\n");
        report.studies[3].checks[0].pass = true;
        write_report(&report, folder.path()).unwrap();
        assert!(!case.exists());
    }

    #[test]
    fn a_report_that_is_read_back_makes_the_same_files() {
        let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        write_report(&sample::compared(), first.path()).unwrap();
        let back = crate::report::read_report(first.path()).unwrap();
        write_report(&back, second.path()).unwrap();
        for file in ["results.json", "junit.xml", "index.html", "summary.md"] {
            let read =
                |folder: &tempfile::TempDir| std::fs::read(folder.path().join(file)).unwrap();
            assert!(read(&first) == read(&second), "{file}");
        }
    }

    #[test]
    fn a_path_that_cannot_be_written_is_named_in_the_error() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_atomically(&folder.path().join(".."), b"x").unwrap_err();
        assert!(error.to_string().contains("names no file"), "{error}");
        std::fs::write(folder.path().join("file"), b"x").unwrap();
        let error = write_atomically(&folder.path().join("file/inside"), b"x").unwrap_err();
        assert!(error.to_string().contains("inside"), "{error}");
    }
}
