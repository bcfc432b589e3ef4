//! What `mtled bench` measures.

use mtled_checks::study::Provenance;
use rayon::ThreadPool;
use serde::Serialize;

/// Version of the layout of the JSON document.
pub const SCHEMA_VERSION: u32 = 2;

/// All measurements: medians of the CPU time of work on one thread and of the wall time of
/// work on several.
#[derive(Debug, Clone, Serialize)]
pub struct Figures {
    /// Version of the layout.
    pub schema_version: u32,
    /// Program and machine.
    pub provenance: Provenance,
    /// Of the minute before the measurement.
    pub load_average: Option<f64>,
    /// Second cache of a core and last cache \[bytes\].
    pub caches: (usize, usize),
    /// Whether smaller bodies were measured.
    pub quick: bool,
    /// Samples per median.
    pub rounds: usize,
    /// Limits of the machine.
    pub limits: Limits,
    /// The internal force by size and support.
    pub force: Vec<ForceRow>,
    /// The internal force in two variants.
    pub ratios: Vec<RatioRow>,
    /// Parts of the set-up.
    pub set_up: SetUp,
    /// Time steps.
    pub steps: Vec<StepRow>,
    /// A large body.
    pub large: MemoryRow,
    /// Bundled cases from their file to their result.
    pub cases: Vec<CaseRow>,
}

/// Limits of the machine.
#[derive(Debug, Clone, Serialize)]
pub struct Limits {
    /// Triad on one thread and on all \[B/s\].
    pub triad: [f64; 2],
    /// Multiply-adds of one thread, two operations each \[flop/s\].
    pub multiply_adds: f64,
    /// Numbers per SIMD vector.
    pub lanes: usize,
}

/// One evaluation of the internal force on one thread.
#[derive(Debug, Clone, Serialize)]
pub struct ForceRow {
    /// The memory that holds its data.
    pub memory: &'static str,
    /// Whether J is projected on patches.
    pub projected: bool,
    /// Number of quadrature points.
    pub points: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// Bytes that one evaluation reads.
    pub bytes: usize,
    /// Time per point and neighbour \[ns\].
    pub nanoseconds_per_neighbour: f64,
    /// The same of the plain loop \[ns\].
    pub plain_nanoseconds_per_neighbour: f64,
    /// Time of the plain loop over that of the solver, in the same rounds \[–\].
    pub plain_over_solver: f64,
    /// Bytes read over time \[B/s\].
    pub bytes_per_second: f64,
    /// Its fraction of the triad in the same rounds, where memory is the limit \[–\].
    pub fraction_of_triad: Option<f64>,
}

/// Operations per point and neighbour: nine multiply-adds for F and nine for the force;
/// those of the law are not counted.
const OPERATIONS: f64 = 36.0;

impl ForceRow {
    /// Fraction of a rate of multiply-adds \[flop/s\] that is reached \[–\].
    pub fn fraction_of(&self, multiply_adds: f64) -> f64 {
        1e9 * OPERATIONS / self.nanoseconds_per_neighbour / multiply_adds
    }
}

/// Two variants of one evaluation of the internal force.
#[derive(Debug, Clone, Serialize)]
pub struct RatioRow {
    /// The first over the second variant.
    pub label: &'static str,
    /// Number of quadrature points.
    pub points: usize,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// Times of the first and of the second \[s\].
    pub seconds: [f64; 2],
    /// The first over the second, in the same rounds \[–\].
    pub ratio: f64,
}

/// CPU time of each part of the set-up on one thread \[s\].
#[derive(Debug, Clone, Serialize)]
pub struct SetUp {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of quadrature points.
    pub points: usize,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// Node cloud \[s\].
    pub node_cloud: f64,
    /// Quadrature points \[s\].
    pub quadrature: f64,
    /// Neighbours, patches, φ and Grad φ of all points \[s\].
    pub shape_functions: f64,
    /// Consistent gradients minus plain ones, boundary panels included \[s\].
    pub correction: f64,
    /// Its iterations.
    pub correction_iterations: usize,
    /// Masses, conditions, loads and blocks \[s\].
    pub model: f64,
    /// Critical time step \[s\].
    pub critical_step: f64,
    /// Evaluations of the internal force for it.
    pub critical_step_evaluations: usize,
    /// One evaluation of the internal force \[s\].
    pub force_evaluation: f64,
}

impl SetUp {
    /// Sum of the parts \[s\].
    pub fn total(&self) -> f64 {
        let discretisation = self.node_cloud + self.quadrature + self.shape_functions;
        discretisation + self.correction + self.model + self.critical_step
    }
}

/// Time steps of a body.
#[derive(Debug, Clone, Serialize)]
pub struct StepRow {
    /// The body.
    pub label: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of quadrature points.
    pub points: usize,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// One step: CPU time on one thread, wall time on all \[s\].
    pub seconds: [f64; 2],
}

/// A large body.
#[derive(Debug, Clone, Serialize)]
pub struct MemoryRow {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of quadrature points.
    pub points: usize,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// Wall time of the set-up on all threads \[s\].
    pub set_up_seconds: f64,
    /// Largest resident memory of the process until the first step \[bytes\].
    pub peak_bytes: Option<u64>,
    /// Bytes read per point and evaluation of the internal force.
    pub bytes_streamed_per_point: f64,
    /// Wall time of one step on all threads \[s\].
    pub step_seconds: f64,
}

/// A bundled case from its file to its result, on one thread.
#[derive(Debug, Clone, Serialize)]
pub struct CaseRow {
    /// Its name.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of quadrature points.
    pub points: usize,
    /// Evaluations of the internal force.
    pub force_evaluations: usize,
    /// Wall time of the set-up \[s\].
    pub set_up_seconds: f64,
    /// Wall time of the simulation \[s\].
    pub solve_seconds: f64,
    /// CPU time of both \[s\].
    pub cpu_seconds: f64,
}

/// How to measure.
pub struct BenchSettings {
    /// Samples per median.
    pub rounds: usize,
    /// Whether to measure smaller bodies.
    pub quick: bool,
    /// A pool of one thread.
    pub one: ThreadPool,
    /// A pool of all threads.
    pub all: ThreadPool,
}
