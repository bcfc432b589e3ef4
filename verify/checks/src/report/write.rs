//! The files of a report, written atomically.

use super::{html, json, junit, markdown, svg};
use crate::escape::file_name;
use crate::study::{Report, Table};
use crate::temporary::{remove_abandoned, temporary};
use anyhow::{Context, Result};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::time::Duration;
use tempfile::NamedTempFile;

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
                let old = dir.join(check.case_file());
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
            let name = file_name(&format!("{}-{}.svg", study.id, number + 1));
            write_atomically(&dir.join(name), svg::to_svg_file(figure).as_bytes())?;
        }
    }
    Ok(())
}

/// Writes a temporary file beside `path` and renames it, so that a reader sees
/// the old bytes or the new ones and never a part; missing folders are created. Several
/// threads and programs may write the same path, the last one wins.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    path.file_name().with_context(|| format!("{} names no file", path.display()))?;
    write_then_rename(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

fn write_then_rename(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let write = || {
        std::fs::create_dir_all(folder)?;
        let mut file = temporary(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        rename(file, path)
    };
    // Somebody may clear the folder between two of these steps.
    let cleared = |error: &std::io::Error| error.kind() == ErrorKind::NotFound;
    (1..TRIES).fold(write(), |result, _| match result {
        Err(error) if cleared(&error) => write(),
        other => other,
    })
}

/// Tries to write into a folder that is cleared by others meanwhile.
const TRIES: usize = 4;

/// Pauses before a rename is tried again \[ms\]. Windows refuses one for as long as another
/// program reads the file or replaces it too; elsewhere none is.
const PAUSES: &[u64] = if cfg!(windows) { &[1, 10, 100, 1000] } else { &[] };

fn rename(mut file: NamedTempFile, path: &Path) -> std::io::Result<()> {
    for pause in PAUSES {
        match file.persist(path) {
            Err(refused) if refused.error.kind() == ErrorKind::PermissionDenied => {
                file = refused.file;
                std::thread::sleep(Duration::from_millis(*pause));
            }
            other => return other.map(drop).map_err(|refused| refused.error),
        }
    }
    file.persist(path)?;
    Ok(())
}

/// Makes a folder where it is missing and tries to write into it, so that a long run does
/// not end with files that cannot be written. What killed programs have left there is removed.
pub fn ensure_writable(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder)
        .and_then(|()| temporary(folder).map(drop))
        .with_context(|| format!("cannot write into the folder {}", folder.display()))?;
    remove_abandoned(folder);
    Ok(())
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
    fn threads_that_write_one_file_leave_one_whole_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        let write = |n: u8| (0..50).try_for_each(|_| write_atomically(&path, &[n; 5000]));
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|n| scope.spawn(move || write(n))).collect();
            threads.into_iter().for_each(|thread| thread.join().unwrap().unwrap());
        });
        let bytes = std::fs::read(&path).unwrap();
        assert!(bytes.len() == 5000 && bytes.iter().all(|b| *b == bytes[0]));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_can_be_read_by_whom_other_new_files_can() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, usual) = (folder.path().join("ours"), folder.path().join("usual"));
        write_atomically(&ours, b"x").unwrap();
        std::fs::write(&usual, b"x").unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&usual));
    }

    #[test]
    fn names_in_a_report_cannot_lead_out_of_its_folder() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("deep/out");
        let mut report = sample::compared();
        for study in &mut report.studies {
            study.id = format!("../../{}", study.id);
            for check in &mut study.checks {
                check.id = format!("../{}", check.id);
            }
        }
        write_report(&report, &out).unwrap();
        let beside = |path: &Path| std::fs::read_dir(path).unwrap().count();
        assert_eq!((beside(folder.path()), beside(&folder.path().join("deep"))), (1, 1));
        let files = ["results.json", "junit.xml", "index.html", "summary.md"];
        assert_eq!(beside(&out), files.len() + 2);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_named_before_anything_is_made_for_it() {
        let folder = tempfile::tempdir().unwrap();
        ensure_writable(&folder.path().join("new/folder")).unwrap();
        assert_eq!(std::fs::read_dir(folder.path().join("new/folder")).unwrap().count(), 0);
        std::fs::write(folder.path().join("file"), b"x").unwrap();
        let error = ensure_writable(&folder.path().join("file/inside")).unwrap_err();
        assert!(format!("{error:#}").contains("file/inside"), "{error:#}");
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
