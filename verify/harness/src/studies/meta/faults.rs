//! Deliberate faults in the solver, and the checks that detect them.

use crate::studies::workbench::{Workbench, exact};
use anyhow::{Context, Result};
use mtled_checks::study::{Cell, Study, Table, number, text};
use serde::Deserialize;

macro_rules! bundled {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../../faults/", $name, ".toml")))),*]
    };
}

/// (name, text) of every file in `verify/harness/faults`.
pub(crate) const FAULTS: &[(&str, &str)] = bundled![
    "01_sign_of_stress",
    "02_last_point_dropped",
    "03_constant_of_rubber",
    "04_row_sum_split_evenly",
    "05_mass_lost",
    "06_weight_derivative",
    "07_buffer_lost",
    "08_stale_step",
    "09_amplitude_linear",
    "10_component_ignored",
    "11_contact_normal",
    "12_gap_ignored",
    "13_damping_misplaced",
    "14_projected_share",
    "15_tolerance_ignored",
    "16_lanczos_stopped",
    "17_reaction_factor",
    "18_thickness_forgotten",
    "19_no_number_swallowed",
    "20_neighbour_dropped",
    "21_fibre_frame",
    "22_branch_forgotten",
];

/// Number of checks that the table names.
const NAMED: usize = 3;

/// A fault as its file states it.
#[derive(Debug, Deserialize)]
struct Fault {
    change: Vec<Change>,
}

/// A piece of the source and its replacement.
#[derive(Debug, PartialEq, Deserialize)]
struct Change {
    file: String,
    text: String,
    replacement: String,
}

#[derive(Debug, Deserialize)]
struct FaultRecord {
    commit: String,
    date: String,
    /// Studies that take longer \[s\] are skipped once a fault is detected.
    enough: f64,
    faults: Vec<TestedFault>,
}

/// A tested fault with the checks that failed.
#[derive(Debug, Deserialize)]
struct TestedFault {
    name: String,
    title: String,
    changes: Vec<Change>,
    checks: Vec<String>,
    studies: Vec<String>,
    unfinished: Vec<String>,
    seconds: f64,
}

pub(crate) fn faults(_: &Workbench, study: &mut Study) -> Result<()> {
    let record: FaultRecord =
        serde_json::from_str(mtled_reports::FAULTS).context("reports/faults.json")?;
    let stated: Vec<(&str, Fault)> = FAULTS
        .iter()
        .map(|(name, text)| {
            Ok((*name, toml_edit::de::from_str(text).with_context(|| name.to_string())?))
        })
        .collect::<Result<_>>()?;
    add_checks(study, &stated, &record);
    study.tables.push(Table {
        title: "Faults and the checks that detect them".into(),
        columns: vec![
            text("fault"),
            text("where"),
            number("failing checks", "1"),
            number("studies run", "1"),
            text("the first checks"),
            number("time", "s"),
        ],
        rows: record.faults.iter().map(row).collect(),
    });
    study.notes.push(format!(
        "Written by .ci/faults at commit {} on {}: each fault goes into a scratch copy of the solver, whose \
         studies run one by one, the cheapest first. Once a fault is detected, studies that take more \
         than {} s of one thread are skipped, so more checks may detect it than are counted. \
         The changes are in verify/harness/faults and reports/faults.md.",
        record.commit, record.date, record.enough
    ));
    Ok(())
}

fn add_checks(study: &mut Study, stated: &[(&str, Fault)], record: &FaultRecord) {
    let tested = |(name, fault): &(&str, Fault)| {
        record.faults.iter().any(|tested| tested.name == *name && tested.changes == fault.change)
    };
    let untested = stated.iter().filter(|fault| !tested(fault)).count();
    let unknown = |tested: &&TestedFault| !stated.iter().any(|(name, _)| *name == tested.name);
    let unknown = record.faults.iter().filter(unknown).count();
    let missed = record.faults.iter().filter(|tested| tested.checks.is_empty()).count();
    for (id, label, value, source) in [
        (
            "faults/tried",
            "faults whose files differ from what was tested, or that are only in one of the two",
            untested + unknown,
            "a fault that changes has to be tested again: .ci/faults",
        ),
        (
            "faults/missed",
            "faults that no check detects",
            missed,
            "an undetected fault shows that a check is missing",
        ),
    ] {
        study.checks.push(exact(id, label, value as f64, 0.0, source));
    }
}

fn row(tested: &TestedFault) -> Vec<Cell> {
    let mut files: Vec<&str> = tested.changes.iter().map(|change| change.file.as_str()).collect();
    files.dedup();
    let ends = if tested.unfinished.is_empty() {
        String::new()
    } else {
        format!("; did not end: {}", tested.unfinished.join(", "))
    };
    let first: Vec<&str> = tested.checks.iter().take(NAMED).map(String::as_str).collect();
    vec![
        Cell::Text(tested.title.clone()),
        Cell::Text(files.join(", ")),
        Cell::Number(tested.checks.len() as f64),
        Cell::Number(tested.studies.len() as f64),
        Cell::Text(first.join(", ") + &ends),
        Cell::Number(tested.seconds),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_of_the_folder_is_bundled() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/faults");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .filter_map(|name| name.strip_suffix(".toml").map(String::from))
            .collect();
        files.sort();
        let bundled: Vec<&str> = FAULTS.iter().map(|(name, _)| *name).collect();
        assert_eq!(files, bundled);
    }
}
