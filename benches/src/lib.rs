//! Files that the benches write beside those of Criterion, for `bench-table`.

use criterion::Criterion;
use mtled::discretisation::Discretisation;
use mtled::model::Model;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Duration;

/// The body of a benchmark.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct BodySize {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of quadrature points.
    pub points: usize,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// Bytes that one call reads, if known.
    pub bytes: Option<usize>,
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
        }
    }

    /// Adds the bytes that one evaluation of the internal force reads.
    pub fn streamed(self, model: &Model) -> BodySize {
        BodySize { bytes: Some(model.bytes_per_step()), ..self }
    }
}

/// Writes `note` to `file` beside Criterion's files of a benchmark; `tmp` is the temporary
/// folder that Cargo provides.
pub fn write_note(tmp: &str, benchmark: [&str; 2], file: &str, note: &impl Serialize) {
    let [group, name] = benchmark;
    let dir = Path::new(tmp).with_file_name("criterion").join(group).join(name);
    let text = serde_json::to_string(note).expect("numbers can be written") + "\n";
    let written = std::fs::create_dir_all(&dir).and_then(|()| std::fs::write(dir.join(file), text));
    written.expect("the target folder is writable");
}

/// Whether every benchmark is run once only, as a test.
pub fn smoke() -> bool {
    std::env::args().any(|argument| argument == "--test")
}

/// Settings of all benchmarks.
pub fn settings() -> Criterion {
    Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
}
