//! Work of a run in counts that do not depend on the machine.

use super::solved::Solved;
use mtled_checks::report::four_digits;
use serde::{Deserialize, Serialize};

/// Counts of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Work {
    /// Time steps.
    pub steps: usize,
    /// Evaluations of the internal force.
    pub force_evaluations: usize,
    /// Those of them for the critical time step.
    pub lanczos_evaluations: usize,
    /// Iterations for consistent gradients.
    pub correction_iterations: usize,
    /// Quadrature points of all evaluations.
    pub point_evaluations: usize,
    /// Support entries of all evaluations.
    pub neighbour_visits: usize,
    /// Bytes of gradients and indices read by all evaluations.
    pub bytes_streamed: usize,
}

impl Work {
    /// The counts of a solved problem.
    pub fn of(solved: &Solved) -> Work {
        let (summary, simulation) = (&solved.summary, &solved.simulation);
        let supports = &simulation.discretisation.supports;
        let evaluations = summary.force_evaluations;
        Work {
            steps: summary.steps,
            force_evaluations: evaluations,
            lanczos_evaluations: summary.lanczos_evaluations,
            correction_iterations: simulation.discretisation.correction.map_or(0, |c| c.iterations),
            point_evaluations: evaluations * supports.len(),
            neighbour_visits: evaluations * supports.nodes.len(),
            bytes_streamed: evaluations * simulation.model.bytes_per_step(),
        }
    }

    /// A line for people.
    pub(crate) fn text(&self) -> String {
        format!(
            "  {} evaluations of the internal force ({} for the critical step), {:.2e} points and {:.2e} \
             neighbours visited, {} GB read; {} iterations for the gradients",
            self.force_evaluations,
            self.lanczos_evaluations,
            self.point_evaluations as f64,
            self.neighbour_visits as f64,
            four_digits(self.bytes_streamed as f64 / 1e9),
            self.correction_iterations
        )
    }
}
