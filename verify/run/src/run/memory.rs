//! Memory that a run takes, and refusal of cases that need more than is available.

use crate::display::expected_boxes;
use crate::machine::{available_memory, peak_memory};
use crate::run::record::Sample;
use crate::run::solved::Solved;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::{Discretisation, Footprint};
use mtled::model::essential::Reaction;
use mtled::model::zero_energy::tested_points;
use mtled_case::scene::Case;
use mtled_checks::report::four_digits;

/// A problem that needs more memory than is available.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "about {} nodes and {} quadrature points with {} nodes in each support need about {} GB of memory, and {} GB are \
     available: use a larger spacing, fewer cells per spacing or a smaller dilation, or a machine with more memory",
    four_digits(.footprint.nodes), four_digits(.footprint.points), four_digits(.footprint.neighbours),
    four_digits(.footprint.bytes / 1e9), four_digits(*.available / 1e9)
)]
pub struct MemoryShortage {
    /// What the problem needs.
    pub footprint: Footprint,
    /// \[bytes\]
    pub available: f64,
}

/// Refuses a case that needs more memory than is available. A body that cannot be
/// sampled is left to the set-up, which says why.
pub fn refuse_beyond_memory(case: &Case) -> Result<(), MemoryShortage> {
    match (Footprint::of(&case.problem), available_memory()) {
        (Ok(footprint), Some(available)) => {
            let bytes = footprint.bytes + recorded_bytes(case, &footprint);
            refuse_beyond(Footprint { bytes, ..footprint }, available as f64)
        }
        _ => Ok(()),
    }
}

/// Memory \[bytes\] at the peak of a run whose discretisation is known: an upper bound.
pub fn estimated_memory(case: &Case, discretisation: &Discretisation) -> f64 {
    let footprint = Footprint::counted(&case.problem, discretisation);
    let recorded = recorded_bytes(case, &footprint);
    // Recording begins when recipes have been tested.
    footprint.bytes + recorded.max(footprint.rows_bytes(tested_points(discretisation)))
}

/// Bytes of a position in `result.json`, with the numbers as text and as values.
const PER_WRITTEN_POSITION: f64 = 900.0;

/// Vertices of the display mesh per box of its lattice \[–\].
const VERTICES_PER_BOX: f64 = 1.4;
/// Fields and cells of the display mesh \[bytes per vertex\].
const PER_VERTEX: f64 = 450.0;

/// The display mesh, its fields, and what interpolates to its vertices \[bytes\].
fn display_bytes(footprint: &Footprint) -> f64 {
    let vertices = VERTICES_PER_BOX * expected_boxes(footprint.nodes);
    let entry = (size_of::<u32>() + size_of::<f64>()) as f64;
    vertices * (PER_VERTEX + entry * footprint.neighbours)
}

/// Frames and samples of a run, and what evaluates or writes them \[bytes\].
fn recorded_bytes(case: &Case, footprint: &Footprint) -> f64 {
    let (problem, outputs) = (&case.problem, &case.outputs);
    let number = size_of::<f64>() as f64;
    let parameters = problem.dimension.components() as f64 * footprint.nodes;
    let frames = outputs.frames as f64 * number * parameters;
    let positions: f64 = case.probes.iter().map(|probe| probe.kind.count() as f64).sum();
    let sample = size_of::<Vector3>() as f64 * (positions + case.probes.len() as f64)
        + size_of::<Reaction>() as f64 * problem.conditions.len() as f64
        + size_of::<Sample>() as f64;
    let samples = (outputs.history as f64 + 1.0) * sample;
    let display = if outputs.frames > 0 { display_bytes(footprint) } else { 0.0 };
    frames
        + display
        + samples
        + footprint.rows_bytes(positions).max(PER_WRITTEN_POSITION * positions)
}

/// Refuses where more is needed than available \[bytes\].
fn refuse_beyond(footprint: Footprint, available: f64) -> Result<(), MemoryShortage> {
    // An estimate that overflows is NaN.
    if footprint.bytes <= available { Ok(()) } else { Err(MemoryShortage { footprint, available }) }
}

/// Peak memory, in total, per point and per node, beside the estimate.
pub(crate) fn memory_text(case: &Case, solved: &Solved) -> Option<String> {
    let peak = peak_memory()? as f64;
    let (d, model) = (&solved.simulation.discretisation, &solved.simulation.model);
    let (nodes, points) = (model.positions.len() as f64, d.supports.len() as f64);
    let estimate = estimated_memory(case, d);
    Some(format!(
        "  {:.0} MB of memory at the peak ({:.0} estimated): {:.0} bytes per point, {:.0} per node; {:.0} bytes \
         per point are read in each step",
        peak / 1e6,
        estimate / 1e6,
        peak / points,
        peak / nodes,
        model.bytes_per_step() as f64 / points
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mtled::Simulation;
    use mtled::problem::Problem;
    use mtled_case::scene::read_case;

    fn bundled(name: &str) -> Problem {
        let folder = tempfile::tempdir().unwrap();
        let cases = mtled_case::bundled::unpack(folder.path()).unwrap();
        read_case(&cases.join(format!("{name}.toml"))).unwrap().problem
    }

    #[test]
    fn sizes_are_estimated_before_the_set_up() {
        for name in [
            "cube_compression",
            "cook_membrane",
            "sphere_gravity",
            "brain_slice",
            "indented_block",
            "soft_inclusion",
        ] {
            let problem = bundled(name);
            let footprint = Footprint::of(&problem).unwrap();
            let made = Simulation::with_any_recipe(&problem).unwrap();
            let nodes = made.model.positions.len() as f64;
            let points = made.model.point_positions.len() as f64;
            let neighbours = made.discretisation.mean_support();
            for (what, estimate, real) in [
                ("nodes", footprint.nodes, nodes),
                ("points", footprint.points, points),
                ("neighbours", footprint.neighbours, neighbours),
            ] {
                let ratio = estimate / real;
                assert!((0.8..1.25).contains(&ratio), "{name}: {what} {estimate} for {real}");
            }
        }
    }

    #[test]
    fn a_body_that_does_not_fit_is_refused_with_its_numbers() {
        let (nodes, points, neighbours) = (1e6, 2e6, 30.0);
        let (panels, held, bytes) = (1e5, 1e3, 12e9);
        let footprint = Footprint { nodes, points, neighbours, panels, held, bytes };
        assert!(refuse_beyond(footprint, 13e9).is_ok());
        let message = refuse_beyond(footprint, 8e9).unwrap_err().to_string();
        assert!(message.contains("about 12 GB") && message.contains("and 8 GB"), "{message}");
        assert!(message.contains("use a larger spacing"), "{message}");
    }
}
