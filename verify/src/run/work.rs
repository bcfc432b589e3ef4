//! What a run has done, counted: figures that do not depend on the machine.

use super::Solved;
use serde::{Deserialize, Serialize};

/// Counters of a run; all may be compared between machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Work {
    pub steps: usize,
    /// Evaluations of the internal force.
    pub force_evaluations: usize,
    /// Those of them that looked for the critical step.
    pub lanczos_evaluations: usize,
    /// Iterations that made the gradients consistent.
    pub correction_iterations: usize,
    /// Quadrature points that all evaluations have visited.
    pub point_evaluations: usize,
    /// Support entries that all evaluations have visited.
    pub neighbour_visits: usize,
    /// Bytes of gradients and indices that all evaluations have read.
    pub bytes_streamed: usize,
}

impl Work {
    pub fn of(solved: &Solved) -> Work {
        let (summary, prepared) = (&solved.summary, &solved.prepared);
        let supports = &prepared.discretisation.supports;
        let evaluations = summary.force_evaluations;
        Work {
            steps: summary.steps,
            force_evaluations: evaluations,
            lanczos_evaluations: summary.lanczos_evaluations,
            correction_iterations: prepared.discretisation.correction.map_or(0, |c| c.iterations),
            point_evaluations: evaluations * supports.len(),
            neighbour_visits: evaluations * supports.nodes.len(),
            bytes_streamed: evaluations * prepared.model.bytes_per_step(),
        }
    }
}
