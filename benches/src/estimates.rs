//! Criterion's files, and the notes beside them.

use anyhow::{Context, Result};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// `new/benchmark.json`.
#[derive(Deserialize)]
pub struct Benchmark {
    /// Group and name.
    pub full_id: String,
}

/// `new/estimates.json`; times in ns.
#[derive(Deserialize)]
pub struct Estimates {
    /// Of the time of one call.
    pub median: Estimate,
}

/// An estimate with its confidence interval.
#[derive(Deserialize)]
pub struct Estimate {
    /// The best estimate.
    pub point_estimate: f64,
    /// Where it lies with 95 % confidence.
    pub confidence_interval: Interval,
}

/// An interval.
#[derive(Deserialize)]
pub struct Interval {
    /// Its lower end.
    pub lower_bound: f64,
    /// Its upper end.
    pub upper_bound: f64,
}

impl Estimate {
    /// Half-width of the interval over the estimate \[–\].
    pub fn half_width(&self) -> f64 {
        let interval = &self.confidence_interval;
        0.5 * (interval.upper_bound - interval.lower_bound) / self.point_estimate
    }
}

/// Group and name of the benchmark in this folder.
pub fn full_id(benchmark: &Path) -> Result<String> {
    Ok(read::<Benchmark>(&benchmark.join("new/benchmark.json"))?.full_id)
}

/// The median of the benchmark in this folder.
pub fn median(benchmark: &Path) -> Result<Estimate> {
    Ok(read::<Estimates>(&benchmark.join("new/estimates.json"))?.median)
}

/// Folders with a file of this name under a folder, sorted.
pub fn folders_with(file: &str, root: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    find(file, root, &mut found)?;
    found.sort();
    Ok(found)
}

/// Folders of the benchmarks under a folder that have a note of this name and were measured: those
/// that a filter left out have notes only.
pub fn measured(note: &str, root: &Path) -> Result<Vec<PathBuf>> {
    let mut found = folders_with(note, root)?;
    found.retain(|benchmark| is_measured(benchmark));
    Ok(found)
}

/// Whether the benchmark in this folder was measured.
pub fn is_measured(benchmark: &Path) -> bool {
    benchmark.join("new/estimates.json").exists()
}

fn find(file: &str, folder: &Path, found: &mut Vec<PathBuf>) -> Result<()> {
    let entries = std::fs::read_dir(folder)
        .with_context(|| format!("cannot read {}; run `cargo bench` first", folder.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            find(file, &path, found)?;
        } else if path.file_name().is_some_and(|name| name == file) {
            found.push(folder.to_path_buf());
        }
    }
    Ok(())
}

/// A JSON file.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let context = || format!("cannot use {}", path.display());
    let text = std::fs::read_to_string(path).with_context(context)?;
    serde_json::from_str(&text).with_context(context)
}

/// A time in ns with a suitable unit.
pub fn time(ns: f64) -> String {
    match ns {
        ns if ns < 1e3 => format!("{ns:.1} ns"),
        ns if ns < 1e6 => format!("{:.1} µs", ns / 1e3),
        ns if ns < 1e9 => format!("{:.2} ms", ns / 1e6),
        ns => format!("{:.2} s", ns / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_a_suitable_unit() {
        assert_eq!(time(12.34), "12.3 ns");
        assert_eq!(time(2.5e6), "2.50 ms");
        assert_eq!(time(2.5e9), "2.50 s");
    }
}
