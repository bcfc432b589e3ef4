//! The tables of benchmarks from Criterion's files.

use crate::estimates::{Estimate, full_id, measured, median, read, time};
use crate::pairs;
use anyhow::{Result, ensure};
use mtled_benches::notes::{BodySize, Limit, Note, Unit, VARIANTS};
use mtled_run::machine::provenance;
use std::fmt::Write;
use std::path::Path;

/// Every benchmark under Criterion's folder, pairs of them, and the limits of the machine.
pub fn tables(criterion: &Path) -> Result<String> {
    let (rows, pairs) = (benchmarks(criterion)?, pairs::table(criterion)?);
    let p = provenance();
    Ok(format!(
        "{}, {} threads, features: {}; mtled {} ({}), {}, {}. Medians of wall time with the \
         half-width of their 95 % interval.\n\n{rows}\n{pairs}{}",
        p.processor,
        p.threads,
        p.processor_features,
        p.version,
        p.commit,
        p.compiler,
        p.date,
        notes(criterion)?
    ))
}

/// A row for every benchmark but those that are of interest as pairs only.
fn benchmarks(criterion: &Path) -> Result<String> {
    let triad = match criterion.join("limits/triad") {
        triad if measured(Limit::FILE, criterion)?.contains(&triad) => Some(rate(&triad)?),
        _ => None,
    };
    let mut text = String::from(
        "| bench | nodes | points | neighbours | median | points per second | ns per point and neighbour | of the triad |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let found = measured(BodySize::FILE, criterion)?;
    ensure!(!found.is_empty(), "no measurement under {}; run `cargo bench`", criterion.display());
    for benchmark in found.iter().filter(|path| !path.starts_with(criterion.join(VARIANTS))) {
        let size = read(&benchmark.join(BodySize::FILE))?;
        text += &row(&full_id(benchmark)?, &size, &median(benchmark)?, triad);
    }
    Ok(text)
}

/// The limits of the machine, measured in the same run, and peaks of memory.
fn notes(criterion: &Path) -> Result<String> {
    let mut text = String::new();
    for limit in measured(Limit::FILE, criterion)? {
        let unit = match read::<Limit>(&limit.join(Limit::FILE))?.unit {
            Unit::Bytes => "GB/s",
            Unit::Operations => "Gflop/s",
        };
        let _ = writeln!(text, "\n{}: {:.1} {unit}.", full_id(&limit)?, rate(&limit)?);
    }
    for benchmark in measured(BodySize::FILE, criterion)? {
        let size: BodySize = read(&benchmark.join(BodySize::FILE))?;
        if let Some(peak) = size.peak {
            let (megabytes, each) = (peak as f64 / 1e6, peak as f64 / size.nodes as f64);
            let name = full_id(&benchmark)?;
            let _ = writeln!(
                text,
                "\n{name}: peak of the memory {megabytes:.0} MB, {each:.0} bytes per node."
            );
        }
    }
    Ok(text)
}

/// Rate of a limit \[10⁹/s\].
fn rate(limit: &Path) -> Result<f64> {
    Ok(read::<Limit>(&limit.join(Limit::FILE))?.amount / median(limit)?.point_estimate)
}

/// A row of the table; `triad` is in GB/s, on one thread.
fn row(name: &str, size: &BodySize, median: &Estimate, triad: Option<f64>) -> String {
    let (ns, half) = (median.point_estimate, 100.0 * median.half_width());
    let fraction = match (size.bytes, triad) {
        (Some(bytes), Some(triad)) => format!("{:.2}", bytes as f64 / ns / triad),
        _ => "–".into(),
    };
    format!(
        "| {name} | {} | {} | {:.1} | {} ± {half:.1} % | {:.2} M | {:.2} | {fraction} |\n",
        size.nodes,
        size.points,
        size.neighbours,
        time(ns),
        1e3 * size.points as f64 / ns,
        ns / (size.points as f64 * size.neighbours),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimates::Interval;
    use mtled_benches::notes::{PAIRS, Pair};

    #[test]
    fn a_row_states_rates_per_point_and_per_neighbour() {
        let size = BodySize {
            nodes: 700,
            points: 1000,
            neighbours: 20.0,
            bytes: Some(500_000),
            peak: None,
        };
        let interval = Interval { lower_bound: 99e3, upper_bound: 101e3 };
        let median = Estimate { point_estimate: 100e3, confidence_interval: interval };
        let row = row("internal_force/cube", &size, &median, Some(10.0));
        let expected = "| internal_force/cube | 700 | 1000 | 20.0 | 100.0 µs ± 1.0 % | 10.00 M | 5.00 | 0.50 |\n";
        assert_eq!(row, expected);
    }

    /// Files of a benchmark as Criterion writes them, and their note.
    fn write(criterion: &Path, id: &str, ns: f64, note: &impl Note) {
        write_note(criterion, id, note);
        let new = criterion.join(id).join("new");
        std::fs::create_dir_all(&new).unwrap();
        let benchmark = serde_json::json!({ "full_id": id });
        let interval = serde_json::json!({ "lower_bound": 0.99 * ns, "upper_bound": 1.01 * ns });
        let median = serde_json::json!({ "point_estimate": ns, "confidence_interval": interval });
        let estimates = serde_json::json!({ "median": median });
        std::fs::write(new.join("benchmark.json"), benchmark.to_string()).unwrap();
        std::fs::write(new.join("estimates.json"), estimates.to_string()).unwrap();
    }

    fn write_note<N: Note>(criterion: &Path, id: &str, note: &N) {
        let text = serde_json::to_string(note).unwrap();
        std::fs::create_dir_all(criterion.join(id)).unwrap();
        std::fs::write(criterion.join(id).join(N::FILE), text).unwrap();
    }

    #[test]
    fn variants_stand_in_the_table_of_pairs_only_and_what_was_not_measured_nowhere() {
        let folder = tempfile::tempdir().unwrap();
        let size = BodySize { nodes: 50, points: 99, neighbours: 9.0, bytes: None, peak: None };
        let triad = Limit { amount: 2e9, unit: Unit::Bytes };
        write(folder.path(), "limits/triad", 1e8, &triad);
        write(folder.path(), "set_up/large", 1e9, &BodySize { peak: Some(5_000_000), ..size });
        write(folder.path(), "variants/double", 3e6, &size);
        write(folder.path(), "variants/single", 2e6, &size);
        write_note(folder.path(), "step/left_out", &size);
        let pair = |first: &str, second: &str| {
            let [label, first, second] = ["a over b", first, second].map(str::to_string);
            Pair { label, first, second }
        };
        let pairs = vec![pair("double", "single"), pair("double", "not_measured")];
        let pairs = serde_json::to_string(&pairs).unwrap();
        std::fs::write(folder.path().join("variants").join(PAIRS), pairs).unwrap();
        let text = tables(folder.path()).unwrap();
        assert_eq!(
            text.matches("| a over b | 99 | 9.0 | 3.00 ms | 2.00 ms | 1.50 ± 1.4 % |").count(),
            1
        );
        assert_eq!(text.lines().filter(|line| line.contains("set_up/large |")).count(), 1);
        assert!(!text.contains("variants/") && !text.contains("left_out"), "{text}");
        assert!(text.contains("limits/triad: 20.0 GB/s."), "{text}");
        assert!(text.contains("peak of the memory 5 MB, 100000 bytes per node"), "{text}");
    }
}
