//! A suite made of case files: references by finer runs, and bounds from what is measured.

use super::read::{CaseFormat, SuiteFormat};
use crate::lab::label::percent;
use crate::lab::store::{Job, RunOutcome, RunRecord, Source, Task, TaskRunner};
use crate::lab::sweep::{REFINEMENT, ReferenceSource, find_reference};
use anyhow::{Context, Result, bail};
use mtled_case::scene::{Knob, Setting, read_text};
use mtled_checks::report::four_digits;
use mtled_run::accuracy::{Group, ReferenceSolution, own_reference_text};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Folder of the references beside the suite.
const REFERENCES: &str = "references";
/// Levels of folders below the first in which cases are looked for.
const DEEPEST: usize = 3;
/// A bound over the largest error that was measured \[–\].
const MARGIN: f64 = 1.25;
/// A group whose reference is worse than this is not judged \[–\].
const WORST_REFERENCE: f64 = 0.5;
/// Refinements that are tried where the first takes too long \[–\].
const SMALLER_REFINEMENTS: [f64; 2] = [1.6, 1.35];
/// Power of the number of nodes with which the time of a run grows \[–\].
const GROWTH: f64 = 1.2;

/// What the references may take, and over how many clouds errors are measured.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// CPU time of the reference of a case \[s\].
    pub cpu_s: f64,
    /// Spacing of the case over that of its reference, if it is prescribed \[–\].
    pub refinement: Option<f64>,
    /// Clouds, that of the case included.
    pub clouds: u64,
}

/// A suite that is not written yet.
#[derive(Debug)]
pub struct Draft {
    /// In the order of the files.
    pub cases: Vec<DraftCase>,
}

/// A case of it.
#[derive(Debug)]
pub struct DraftCase {
    format: CaseFormat,
    /// The text of its reference.
    pub reference: Option<String>,
    /// What a user should know of it.
    pub notes: Vec<String>,
}

/// The case files of a folder and of those in it, in the order of their names.
pub fn find_cases(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    collect(folder, 0, &mut found)?;
    found.sort();
    Ok(found)
}

fn collect(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) -> Result<()> {
    let entries = std::fs::read_dir(folder);
    for entry in entries.with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let skipped = name.starts_with('.') || ["reports", "target", REFERENCES].contains(&&*name);
        if path.is_dir() && !skipped && depth < DEEPEST {
            collect(&path, depth + 1, found)?;
        } else if path.extension().is_some_and(|end| end == "toml") && is_case(&path) {
            found.push(path);
        }
    }
    Ok(())
}

/// Whether a file has the tables that every case has; its mistakes are found later.
fn is_case(path: &Path) -> bool {
    let table = |line: &str, name: &str| {
        let line = line.trim_start();
        line.starts_with(&format!("[{name}]")) || line.starts_with(&format!("[{name}."))
    };
    let Ok(text) = read_text(path) else { return false };
    ["geometry", "material"].iter().all(|name| text.lines().any(|line| table(line, name)))
}

/// Runs the cases, makes their references and sets bounds; `files` are relative to `folder`.
pub fn draft(
    folder: &Path,
    files: &[PathBuf],
    limits: &Limits,
    runner: &TaskRunner,
) -> Result<Draft> {
    // All mistakes come before the first run.
    let source =
        |file: &PathBuf| Source::find(&folder.join(file).display().to_string(), folder, &[]);
    let sources: Vec<Arc<Source>> = files.iter().map(source).collect::<Result<_>>()?;
    let cases = files.iter().zip(&sources);
    let drafted = cases.map(|(file, source)| draft_case(file, source, limits, runner));
    Ok(Draft { cases: drafted.collect::<Result<_>>()? })
}

fn draft_case(
    file: &Path,
    source: &Arc<Source>,
    limits: &Limits,
    runner: &TaskRunner,
) -> Result<DraftCase> {
    let times = ReferenceSource::Own(REFINEMENT).times(source)?;
    let task = |job: Job, cloud: u64| Task {
        job,
        source: source.clone(),
        settings: match cloud {
            0 => Vec::new(),
            _ => vec![Setting::number(Knob::Cloud, cloud as f64)],
        },
        times: if job == Job::Solve { times.clone() } else { Vec::new() },
    };
    let first = runner.records(&[task(Job::Solve, 0), task(Job::Patch, 0)])?;
    let [own, patch] = &first[..] else { bail!("{}: a run has no record", source.name) };
    let RunOutcome::Done { warnings, .. } = &own.outcome else {
        bail!("{}: it does not run: {}", source.name, own.failure().unwrap_or_default());
    };
    let (file, patched) = (file.to_path_buf(), patch.failure().is_none());
    let format =
        CaseFormat { file, warnings: warnings.len(), patch: patched, ..CaseFormat::default() };
    let mut drafted = DraftCase { format, reference: None, notes: Vec::new() };
    let mut note = |text: String| drafted.notes.push(format!("{}: {text}", source.name));
    if let Some(reason) = patch.failure() {
        note(format!("no affine patch test: {reason}"));
    }
    let refinement = match refinement(source, own, limits) {
        Ok(refinement) => refinement,
        Err(cpu_s) => {
            let [least, most] = [cpu_s, limits.cpu_s].map(four_digits);
            note(format!(
                "no reference: the coarsest that is of use takes about {least} s of CPU time, more \
                 than the {most} s that are allowed (--truth-budget)"
            ));
            return Ok(drafted);
        }
    };
    let reference = find_reference(&ReferenceSource::Own(refinement), source, &[], runner)?;
    let clouds: Vec<Task> = (0..limits.clouds).map(|cloud| task(Job::Solve, cloud)).collect();
    let records = runner.records(&clouds)?;
    drafted.format.error = bounds(source, &reference, &records);
    drafted.format.reference = Some(format!("{REFERENCES}/{}.json", source.name).into());
    let judged = |group: &Group| drafted.format.error.contains_key(group);
    let given = Group::ALL.into_iter().filter(|group| reference.has(&source.case, *group));
    let too_large = |group: Group| {
        let (name, label) = (&source.name, group.label());
        format!(
            "{name}: the error of the {label} is not judged: that of the reference is too large"
        )
    };
    drafted.notes.extend(given.filter(|group| !judged(group)).map(too_large));
    drafted.reference = Some(own_reference_text(&source.case, &reference));
    Ok(drafted)
}

/// The refinement of a reference that keeps to the limit, or the CPU time of the smallest \[s\].
fn refinement(source: &Source, own: &RunRecord, limits: &Limits) -> Result<f64, f64> {
    if let Some(refinement) = limits.refinement {
        return Ok(refinement);
    }
    let power = GROWTH * source.case.problem.dimension.components() as f64;
    // The coarser of the two runs takes a third of the finer one.
    let cpu_s = |refinement: f64| 4.0 / 3.0 * own.cpu_s() * refinement.powf(power);
    let mut all = [REFINEMENT].into_iter().chain(SMALLER_REFINEMENTS);
    all.find(|refinement| cpu_s(*refinement) <= limits.cpu_s)
        .ok_or_else(|| cpu_s(SMALLER_REFINEMENTS[SMALLER_REFINEMENTS.len() - 1]))
}

/// The largest error over the clouds with a margin and the error of the reference, of each group
/// of which the reference says something.
fn bounds(
    source: &Source,
    reference: &ReferenceSolution,
    records: &[RunRecord],
) -> BTreeMap<Group, f64> {
    let bound = |group: Group| {
        let errors = records
            .iter()
            .filter_map(|record| reference.difference(&source.case, group, record.values()?));
        let (worst, bar) = errors.fold((0.0f64, 0.0f64), |(worst, bar), error| {
            (worst.max(error.rms), bar.max(error.bar))
        });
        let known = reference.has(&source.case, group) && bar < WORST_REFERENCE;
        known.then(|| (group, rounded_up(MARGIN * worst + bar)))
    };
    Group::ALL.into_iter().filter_map(bound).collect()
}

/// The next larger number of two digits.
fn rounded_up(value: f64) -> f64 {
    let unit = 10f64.powf(value.max(1e-12).log10().floor() - 1.0);
    // The decimal that is nearest, so that the file has two digits too.
    format!("{:.1e}", (value / unit).ceil() * unit).parse().unwrap_or(value)
}

impl DraftCase {
    /// Path of its reference, relative to the suite.
    pub fn reference_path(&self) -> Option<&Path> {
        self.format.reference.as_deref()
    }

    /// Its bounds as a line.
    pub fn summary(&self) -> String {
        let bounds: Vec<String> = (self.format.error.iter())
            .map(|(group, bound)| format!("{} {}", group.label(), percent(*bound)))
            .collect();
        let file = self.format.file.display();
        if bounds.is_empty() {
            format!("{file}: no errors are judged")
        } else {
            format!("{file}: errors at most {}", bounds.join(", "))
        }
    }
}

impl Draft {
    /// The text of the suite.
    pub fn text(&self, baseline: &Path) -> Result<String> {
        let case = self.cases.iter().map(|case| case.format.clone()).collect();
        let format = SuiteFormat { baseline: Some(baseline.to_path_buf()), case };
        let tables = toml_edit::ser::to_string_pretty(&format)?;
        Ok(format!("{HEADER}\n{tables}"))
    }
}

const HEADER: &str = "\
# A suite of cases that `mtled verify --suite` judges. Paths are relative to this file.
#
# error: the largest rms error of each group of quantities over its largest value, 0.02 for 2 %;
#   `mtled init` sets it to 1.25 times the largest over some clouds of nodes, and the error of the
#   reference. Groups: displacement, centre_of_mass, force, moment, strain_energy, kinetic_energy.
# reference: finer runs of the case (`mtled init --references` makes them again), or a file in the
#   layout of finite-element references. It belongs to the problem, whatever the recipe is.
# warnings: how many are accepted.
# patch: whether the affine patch test is run on the body with the recipe of the case.
# set: other values under some keys of the case file, such as [\"discretisation.spacing=0.004\"].
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_up_to_two_digits() {
        let rounded = [0.0123, 0.012, 0.0999, 1.234, 0.000_501].map(rounded_up);
        assert_eq!(rounded, [0.013, 0.012, 0.1, 1.3, 0.00051]);
    }

    #[test]
    fn cases_are_found_in_folders_and_other_files_are_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        write("liver.toml", "[geometry]\n[material.tissue]\n");
        write("more/head.toml", "[geometry]\n[material.brain]\n");
        write("Cargo.toml", "[package]\n");
        write("reports/old.toml", "[geometry]\n[material.tissue]\n");
        let found = find_cases(folder.path()).unwrap();
        let names: Vec<_> =
            found.iter().map(|path| path.strip_prefix(folder.path()).unwrap()).collect();
        assert_eq!(names, [Path::new("liver.toml"), Path::new("more/head.toml")]);
    }
}
