//! What the benches leave beside Criterion's files for `bench-table`.

use criterion::Criterion;
use mtled::discretisation::Discretisation;
use mtled::model::Model;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Duration;

/// The body that a benchmark works on.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Size {
    pub nodes: usize,
    pub points: usize,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// Bytes that one call streams, where that is known.
    pub bytes: Option<usize>,
}

/// What a limit is counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    Bytes,
    Operations,
}

/// What one call of a benchmark of the machine's limits does.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Limit {
    pub amount: f64,
    pub unit: Unit,
}

impl Size {
    pub fn of(discretisation: &Discretisation) -> Size {
        Size {
            nodes: discretisation.cloud.positions.len(),
            points: discretisation.supports.len(),
            neighbours: discretisation.mean_support(),
            bytes: None,
        }
    }

    /// With the bytes that one evaluation of the internal force streams.
    pub fn streamed(self, model: &Model) -> Size {
        Size { bytes: Some(model.bytes_per_step()), ..self }
    }
}

/// Writes `what` to `file` beside what Criterion writes about a benchmark;
/// `tmp` is the folder that Cargo gives to benches.
pub fn note(tmp: &str, benchmark: [&str; 2], file: &str, what: &impl Serialize) {
    let [group, name] = benchmark;
    let dir = Path::new(tmp).with_file_name("criterion").join(group).join(name);
    let text = serde_json::to_string(what).expect("numbers can be written") + "\n";
    let written = std::fs::create_dir_all(&dir).and_then(|()| std::fs::write(dir.join(file), text));
    written.expect("the target folder is writable");
}

/// Whether benches are only to be run once each.
pub fn smoke() -> bool {
    std::env::args().any(|argument| argument == "--test")
}

pub fn settings() -> Criterion {
    Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
}
