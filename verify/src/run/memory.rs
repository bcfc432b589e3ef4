//! Refusal of problems that need more memory than is available.

use crate::machine::available_memory;
use mtled::discretisation::Footprint;
use mtled::problem::Problem;
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

/// Refuses a problem that needs more memory than is available. A body that cannot be
/// sampled is left to the set-up, which says why.
pub fn refuse_beyond_memory(problem: &Problem) -> Result<(), MemoryShortage> {
    match (Footprint::of(problem), available_memory()) {
        (Ok(footprint), Some(available)) => refuse_beyond(footprint, available as f64),
        _ => Ok(()),
    }
}

/// Refuses where more is needed than available \[bytes\].
fn refuse_beyond(footprint: Footprint, available: f64) -> Result<(), MemoryShortage> {
    match footprint.bytes > available {
        true => Err(MemoryShortage { footprint, available }),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::prepare::prepare;
    use crate::scene::read_case;

    fn bundled(name: &str) -> Problem {
        let folder = tempfile::tempdir().unwrap();
        let cases = crate::bundled::unpack(folder.path()).unwrap();
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
            let made = prepare(&problem).unwrap();
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
        let footprint = Footprint { nodes: 1e6, points: 2e6, neighbours: 30.0, bytes: 12e9 };
        assert!(refuse_beyond(footprint, 13e9).is_ok());
        let message = refuse_beyond(footprint, 8e9).unwrap_err().to_string();
        assert!(message.contains("about 12 GB") && message.contains("and 8 GB"), "{message}");
        assert!(message.contains("use a larger spacing"), "{message}");
    }
}
