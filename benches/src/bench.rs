//! The table of benchmarks from Criterion's files.

use anyhow::{Context, Result, ensure};
use mtled_benches::{BodySize, Limit, Unit};
use mtled_verify::machine::provenance;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// `new/benchmark.json`.
#[derive(Deserialize)]
struct Benchmark {
    full_id: String,
}

/// `new/estimates.json`; times in ns.
#[derive(Deserialize)]
struct Estimates {
    median: Estimate,
}

#[derive(Deserialize)]
struct Estimate {
    point_estimate: f64,
    confidence_interval: Interval,
}

#[derive(Deserialize)]
struct Interval {
    lower_bound: f64,
    upper_bound: f64,
}

/// A Markdown table of every benchmark under `criterion`.
pub fn table(criterion: &Path) -> Result<String> {
    let mut sizes = Vec::new();
    find("size.json", criterion, &mut sizes)?;
    sizes.sort();
    let triad = match criterion.join("limits/triad/limit.json") {
        limit if limit.with_file_name("new").exists() => Some(rate(&limit)?),
        _ => None,
    };
    let mut text = String::from(
        "| bench | nodes | points | neighbours | median | points per second | ns per point and neighbour | of the triad |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let mut rows = 0;
    for size in sizes {
        let dir = size.with_file_name("new");
        // A smoke test writes a size without a measurement.
        if dir.join("estimates.json").exists() {
            text.push_str(&row(
                &read(&dir.join("benchmark.json"))?,
                &read(&size)?,
                &read(&dir.join("estimates.json"))?,
                triad,
            ));
            rows += 1;
        }
    }
    ensure!(rows > 0, "no measurement under {}; run `cargo bench`", criterion.display());
    text.push_str(&limits(criterion)?);
    let p = provenance();
    let _ = writeln!(
        text,
        "\nMedians of wall time with the half-width of their 95 % interval, {} with {} threads, mtled {} ({}), {}, {}.",
        p.processor, p.threads, p.version, p.commit, p.compiler, p.date
    );
    Ok(text)
}

/// The limits of the machine, measured in the same run.
fn limits(criterion: &Path) -> Result<String> {
    let mut found = Vec::new();
    find("limit.json", criterion, &mut found)?;
    found.sort();
    let mut text = String::new();
    for file in found.iter().filter(|file| file.with_file_name("new").exists()) {
        let unit = match read::<Limit>(file)?.unit {
            Unit::Bytes => "GB/s",
            Unit::Operations => "Gflop/s",
        };
        let name = read::<Benchmark>(&file.with_file_name("new").join("benchmark.json"))?.full_id;
        let _ = writeln!(text, "\n{name}: {:.1} {unit}.", rate(file)?);
    }
    Ok(text)
}

/// Rate of a limit \[10⁹/s\].
fn rate(limit: &Path) -> Result<f64> {
    let estimates: Estimates = read(&limit.with_file_name("new").join("estimates.json"))?;
    Ok(read::<Limit>(limit)?.amount / estimates.median.point_estimate)
}

/// A row of the table; `triad` is in GB/s.
fn row(
    benchmark: &Benchmark,
    size: &BodySize,
    estimates: &Estimates,
    triad: Option<f64>,
) -> String {
    let median = estimates.median.point_estimate;
    let interval = &estimates.median.confidence_interval;
    let half = 50.0 * (interval.upper_bound - interval.lower_bound) / median;
    let visits = size.points as f64 * size.neighbours;
    // The triad was measured on one thread.
    let one_thread = benchmark.full_id.starts_with("internal_force/");
    let fraction = match (size.bytes, triad) {
        (Some(bytes), Some(triad)) if one_thread => format!("{:.2}", bytes as f64 / median / triad),
        _ => "–".into(),
    };
    format!(
        "| {} | {} | {} | {:.1} | {} ± {half:.1} % | {:.2} M | {:.2} | {fraction} |\n",
        benchmark.full_id,
        size.nodes,
        size.points,
        size.neighbours,
        time(median),
        1e3 * size.points as f64 / median,
        median / visits,
    )
}

/// A time in ns with a suitable unit.
fn time(ns: f64) -> String {
    match ns {
        ns if ns < 1e3 => format!("{ns:.1} ns"),
        ns if ns < 1e6 => format!("{:.1} µs", ns / 1e3),
        ns if ns < 1e9 => format!("{:.2} ms", ns / 1e6),
        ns => format!("{:.2} s", ns / 1e9),
    }
}

/// All files of a name under a folder.
fn find(file: &str, dir: &Path, found: &mut Vec<PathBuf>) -> Result<()> {
    let entries = std::fs::read_dir(dir)
        .with_context(|| format!("cannot read {}; run `cargo bench` first", dir.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            find(file, &path, found)?;
        } else if path.file_name().is_some_and(|name| name == file) {
            found.push(path);
        }
    }
    Ok(())
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let context = || format!("cannot use {}", path.display());
    let text = std::fs::read_to_string(path).with_context(context)?;
    serde_json::from_str(&text).with_context(context)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_states_rates_per_point_and_per_neighbour() {
        let benchmark = Benchmark { full_id: "internal_force/cube".into() };
        let size = BodySize { nodes: 700, points: 1000, neighbours: 20.0, bytes: Some(500_000) };
        let interval = Interval { lower_bound: 99e3, upper_bound: 101e3 };
        let median = Estimate { point_estimate: 100e3, confidence_interval: interval };
        let row = row(&benchmark, &size, &Estimates { median }, Some(10.0));
        let expected = "| internal_force/cube | 700 | 1000 | 20.0 | 100.0 µs ± 1.0 % | 10.00 M | 5.00 | 0.50 |\n";
        assert_eq!(row, expected);
    }

    #[test]
    fn times_have_a_suitable_unit() {
        assert_eq!(time(12.34), "12.3 ns");
        assert_eq!(time(2.5e6), "2.50 ms");
        assert_eq!(time(2.5e9), "2.50 s");
    }
}
