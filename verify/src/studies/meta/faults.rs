//! Faults put into the solver on purpose, and the checks that noticed.

use crate::studies::workbench::Workbench;
use anyhow::{Context, Result};
use mtled_checks::study::shorthand::{number, text};
use mtled_checks::study::{Bound, Cell, Check, Kind, Study, Table};
use serde::Deserialize;

macro_rules! carried {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../../faults/", $name, ".toml")))),*]
    };
}

/// (name, text) of every file in `verify/faults`.
pub const FAULTS: &[(&str, &str)] = carried![
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
];

/// What `.ci/faults` wrote.
const RECORD: &str = include_str!("../../../../reports/faults.json");
/// Checks that are named in the table.
const NAMED: usize = 3;

/// A fault as it is stated.
#[derive(Debug, Deserialize)]
struct Fault {
    change: Vec<Change>,
}

/// A piece of the source and what stood in its place.
#[derive(Debug, PartialEq, Deserialize)]
struct Change {
    file: String,
    text: String,
    replacement: String,
}

#[derive(Debug, Deserialize)]
struct Record {
    commit: String,
    date: String,
    /// Seconds of a study that is left out once a fault is caught.
    enough: f64,
    faults: Vec<Tried>,
}

/// A fault that was tried, with the checks that failed.
#[derive(Debug, Deserialize)]
struct Tried {
    name: String,
    title: String,
    changes: Vec<Change>,
    checks: Vec<String>,
    studies: Vec<String>,
    unfinished: Vec<String>,
    seconds: f64,
}

pub fn faults(_: &Workbench, study: &mut Study) -> Result<()> {
    let record: Record = serde_json::from_str(RECORD).context("reports/faults.json")?;
    let stated: Vec<(&str, Fault)> = FAULTS
        .iter()
        .map(|(name, text)| Ok((*name, toml::from_str(text).with_context(|| name.to_string())?)))
        .collect::<Result<_>>()?;
    add_checks(study, &stated, &record);
    study.tables.push(Table {
        title: "Faults and the checks that noticed".into(),
        columns: vec![
            text("fault"),
            text("where"),
            number("failing checks", "1"),
            number("studies run", "1"),
            text("the first of them"),
            number("time", "s"),
        ],
        rows: record.faults.iter().map(row).collect(),
    });
    study.notes.push(format!(
        "Written by .ci/faults at commit {} on {}: each fault goes into a scratch copy of the solver, whose \
         studies run one by one, the cheapest first. Once a fault is caught, studies that take more \
         than {} s of one thread are left out, so it may be caught by more checks than are counted. \
         What was changed stands in verify/faults and reports/faults.md.",
        record.commit, record.date, record.enough
    ));
    Ok(())
}

fn add_checks(study: &mut Study, stated: &[(&str, Fault)], record: &Record) {
    let tried = |(name, fault): &(&str, Fault)| {
        record.faults.iter().any(|tried| tried.name == *name && tried.changes == fault.change)
    };
    let untried = stated.iter().filter(|fault| !tried(fault)).count();
    let unknown = |tried: &&Tried| !stated.iter().any(|(name, _)| *name == tried.name);
    let unknown = record.faults.iter().filter(unknown).count();
    let missed = record.faults.iter().filter(|tried| tried.checks.is_empty()).count();
    for (id, words, value, source) in [
        (
            "faults/tried",
            "faults that are stated otherwise than they were tried, or in one place only",
            untried + unknown,
            "a fault that changes has to be tried again: .ci/faults",
        ),
        (
            "faults/missed",
            "faults that no check noticed",
            missed,
            "a fault that nobody notices shows that a check is missing",
        ),
    ] {
        let bound = Bound::AtMost(0.0);
        study.checks.push(Check::new(id, words, Kind::Exact, value as f64, bound, "1", source));
    }
}

fn row(tried: &Tried) -> Vec<Cell> {
    let mut files: Vec<&str> = tried.changes.iter().map(|change| change.file.as_str()).collect();
    files.dedup();
    let ends = match tried.unfinished.is_empty() {
        true => String::new(),
        false => format!("; did not end: {}", tried.unfinished.join(", ")),
    };
    let first: Vec<&str> = tried.checks.iter().take(NAMED).map(String::as_str).collect();
    vec![
        Cell::Text(tried.title.clone()),
        Cell::Text(files.join(", ")),
        Cell::Number(tried.checks.len() as f64),
        Cell::Number(tried.studies.len() as f64),
        Cell::Text(first.join(", ") + &ends),
        Cell::Number(tried.seconds),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_of_the_folder_is_carried() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/faults");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .filter_map(|name| name.strip_suffix(".toml").map(String::from))
            .collect();
        files.sort();
        let carried: Vec<&str> = FAULTS.iter().map(|(name, _)| *name).collect();
        assert_eq!(files, carried);
    }
}
