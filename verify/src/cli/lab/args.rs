//! Options that several commands share.

use anyhow::{Context, Result};
use clap::Args;
use mtled_checks::escape::file_name;
use mtled_checks::report::ensure_writable;
use mtled_lab::lab::store::{JobPlan, Store};
use mtled_lab::lab::sweep::{REFINEMENT, ReferenceSource};
use mtled_run::accuracy::Group;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct StoreArgs {
    /// Folder of the records; stored runs are not repeated.
    #[arg(long, default_value = "reports/runs", value_name = "DIR", help_heading = "Files")]
    pub store: PathBuf,
}

impl StoreArgs {
    /// The store, which can be made where it is missing. One that is there may be one that
    /// can only be read.
    pub(crate) fn open(&self) -> Result<Store> {
        if !self.store.is_dir() {
            let there = self.store.ancestors().find(|folder| folder.exists());
            ensure_writable(there.unwrap_or(Path::new(".")))
                .with_context(|| format!("cannot make the store {}", self.store.display()))?;
        }
        Ok(Store::new(&self.store))
    }
}

/// Runs that other machines perform.
#[derive(Debug, Args)]
pub(crate) struct JobArgs {
    /// Write the runs that are not stored yet into this folder, in parts, with workflows for
    /// Snakemake and Slurm that perform them, and end; the same command goes on afterwards.
    #[arg(long, value_name = "DIR", help_heading = "Files")]
    plan_jobs: Option<PathBuf>,
    /// Parts into which the runs are dealt, at most.
    #[arg(long, value_name = "N", default_value_t = 32, requires = "plan_jobs",
          value_parser = clap::value_parser!(u16).range(1..=9999), help_heading = "Files")]
    parts: u16,
}

impl JobArgs {
    /// Where runs are planned, if they are.
    pub(crate) fn plan(&self) -> Option<JobPlan> {
        let folder = self.plan_jobs.clone()?;
        Some(JobPlan { folder, parts: self.parts.into() })
    }
}

/// How errors are measured and where files go.
#[derive(Debug, Args)]
pub(crate) struct ErrorArgs {
    /// Reference solution: "any" (the bundled reference of the problem, else finer runs of the
    /// solver), "own" (finer runs of the solver), or a reference file.
    #[arg(long, alias = "truth", default_value = "any", value_name = "any|own|FILE")]
    reference: String,
    /// Quantities whose error is measured [default: the first that the case has].
    #[arg(long, value_enum)]
    pub quantity: Option<Group>,
    #[command(flatten)]
    pub store: StoreArgs,
    #[command(flatten)]
    pub jobs: JobArgs,
    /// Folder for index.html, results.json and figures
    /// [default: reports/ and the name of the study or of the command and the case].
    #[arg(long, value_name = "DIR", help_heading = "Files")]
    out: Option<PathBuf>,
}

impl ErrorArgs {
    /// Where the reference solution comes from.
    pub(crate) fn reference(&self) -> ReferenceSource {
        match self.reference.as_str() {
            "any" => ReferenceSource::Any,
            "own" => ReferenceSource::Own(REFINEMENT),
            file => ReferenceSource::File(PathBuf::from(file)),
        }
    }

    /// Folder of the report, by default `path` below `reports`.
    pub(crate) fn out(&self, path: &[&str]) -> PathBuf {
        let preset =
            || path.iter().fold(PathBuf::from("reports"), |to, part| to.join(file_name(part)));
        self.out.clone().unwrap_or_else(preset)
    }
}

/// `1%` or `0.01`.
pub(crate) fn fraction(text: &str) -> Result<f64, String> {
    let fraction = with_unit(text, &[("%", 0.01)]).filter(|fraction| *fraction < 1.0);
    fraction.ok_or_else(|| format!("{text} is not a fraction such as 1% or 0.01"))
}

/// `2s`, `500ms`, `3min` or `2`.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let time = with_unit(text, &[("ms", 1e-3), ("min", 60.0), ("s", 1.0)]);
    time.ok_or_else(|| format!("{text} is not a time such as 2s, 500ms or 3min"))
}

/// A positive number with the first unit that fits, or without one.
fn with_unit(text: &str, units: &[(&str, f64)]) -> Option<f64> {
    let mut parts = units.iter().filter_map(|(unit, size)| Some((text.strip_suffix(unit)?, *size)));
    let (number, size) = parts.next().unwrap_or((text, 1.0));
    let value = number.trim().parse::<f64>().ok()? * size;
    (value > 0.0 && value.is_finite()).then_some(value)
}
