//! Files that the benches write beside those of Criterion, for `bench-table`.

use criterion::Throughput;
use mtled::discretisation::Discretisation;
use mtled::model::Model;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The body of a benchmark.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct BodySize {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of quadrature points.
    pub points: usize,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// Bytes that one call on one thread reads, where they come from memory.
    pub bytes: Option<usize>,
    /// Largest resident memory of the process up to the end of the first call \[bytes\], if known.
    pub peak: Option<u64>,
}

/// Unit of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// Bytes read and written.
    Bytes,
    /// Floating-point operations.
    Operations,
}

/// Work of one call of a benchmark of the limits of the machine.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Limit {
    /// Amount of work.
    pub amount: f64,
    /// Its unit.
    pub unit: Unit,
}

impl BodySize {
    /// The size of a discretised body.
    pub fn of(discretisation: &Discretisation) -> BodySize {
        BodySize {
            nodes: discretisation.cloud.positions.len(),
            points: discretisation.supports.len(),
            neighbours: discretisation.mean_support(),
            bytes: None,
            peak: None,
        }
    }

    /// Adds the bytes that one evaluation of the internal force reads.
    pub fn streamed(self, model: &Model) -> BodySize {
        BodySize { bytes: Some(model.bytes_per_step()), ..self }
    }
}

/// Two benchmarks of a group that are measured one right after the other, to be compared.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Pair {
    /// What the first and the second are.
    pub label: String,
    /// Name of the benchmark whose time is divided.
    pub first: String,
    /// Name of the benchmark by whose time it is divided.
    pub second: String,
}

/// The group whose benchmarks are of interest as pairs only.
pub const VARIANTS: &str = "variants";

/// What a benchmark works on, which is written to a file of its own kind.
pub trait Note: Serialize {
    /// Name of the file.
    const FILE: &'static str;

    /// Work of one call, for Criterion.
    fn throughput(&self) -> Throughput;
}

impl Note for BodySize {
    const FILE: &'static str = "size.json";

    fn throughput(&self) -> Throughput {
        Throughput::Elements(self.points as u64)
    }
}

impl Note for Limit {
    const FILE: &'static str = "limit.json";

    fn throughput(&self) -> Throughput {
        match self.unit {
            Unit::Bytes => Throughput::Bytes(self.amount as u64),
            Unit::Operations => Throughput::Elements(self.amount as u64),
        }
    }
}

/// File of the pairs of a group.
pub const PAIRS: &str = "pairs.json";

/// Writes `note` to `file` beside Criterion's files of a group or a benchmark; `tmp` is the
/// temporary folder that Cargo provides.
pub fn write_note(tmp: &str, benchmark: &[&str], file: &str, note: &impl Serialize) {
    let mut dir = Path::new(tmp).with_file_name("criterion");
    dir.extend(benchmark);
    let text = serde_json::to_string(note).expect("numbers can be written") + "\n";
    let written = std::fs::create_dir_all(&dir).and_then(|()| std::fs::write(dir.join(file), text));
    written.expect("the target folder is writable");
}
