//! What a run will need of the memory, before any of it is made.
#![allow(non_snake_case)]

use crate::machine::available_memory;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::nodes::{SizeField, WantedSizes};
use mtled::geometry::GeometryError;
use mtled::geometry::selection::Selector;
use mtled::problem::{Cloud, Dimension, InsideRule, Problem, Refinement};
use mtled_checks::report::four_digits;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Estimated size of a discretisation. The bytes are 0.9 to 1.15 of the peak of runs
/// on 32 bodies of 343 to 68 921 nodes with supports of 9 to 66, and 0.76 to 1.07 on six
/// graded ones of 10 000 to 30 000.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    pub nodes: f64,
    pub points: f64,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// At the peak, which is that of the set-up.
    pub bytes: f64,
}

/// A problem that needs more memory than there is.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "about {} nodes and {} quadrature points with {} nodes in each support need about {} GB of memory, and {} GB are \
     available: use a larger spacing, fewer cells per spacing or a smaller dilation, or a machine with more memory",
    four_digits(.footprint.nodes), four_digits(.footprint.points), four_digits(.footprint.neighbours),
    four_digits(.footprint.bytes / 1e9), four_digits(*.available / 1e9)
)]
pub struct MemoryShortage {
    pub footprint: Footprint,
    /// \[bytes\]
    pub available: f64,
}

/// Bytes of the program itself, of which the build for development keeps 2e6 more in
/// memory than the optimised one, and of each node and entry of a support at the
/// peak, fitted to the measured bodies.
const PROGRAM: f64 = 12.5e6;
const PER_NODE: f64 = 1700.0;
const PER_ENTRY: f64 = 82.0;
/// The supports of so many points stand in memory twice for a while, which takes
/// so many bytes more for each entry.
const BATCH: f64 = 16_384.0;
const PER_BATCH_ENTRY: f64 = 62.0;

/// Nodes of a graded cloud per spacing² in a plane and per spacing³ in space, measured:
/// they are taken where they fit, not on a lattice.
const GRADED_DENSITY: [f64; 2] = [1.1, 1.35];

/// The body is looked at in so many places along each axis, in a plane or in
/// space.
const SAMPLES: [usize; 2] = [256, 40];

/// Refuses a problem that needs more memory than the machine has to give. A
/// body that cannot be looked at is left to the set-up, which says why.
pub fn refuse_beyond_memory(problem: &Problem) -> Result<(), MemoryShortage> {
    match (Footprint::of(problem), available_memory()) {
        (Ok(footprint), Some(available)) => footprint.refuse_beyond(available as f64),
        _ => Ok(()),
    }
}

/// Places spread evenly over the body and a little beyond.
struct Places {
    positions: Vec<Vector3>,
    /// Signed distance to the body \[place\] \[m\].
    distances: Vec<f64>,
    /// Volume, or area in a plane, that a place stands for.
    volume: f64,
}

/// Nodes, points and support entries that one place stands for.
#[derive(Debug, Clone, Copy, Default)]
struct Share {
    nodes: f64,
    points: f64,
    entries: f64,
}

impl Footprint {
    /// From the volume of the body, the spacings and the cells in it.
    pub fn of(problem: &Problem) -> Result<Footprint, GeometryError> {
        let places = Places::of(problem)?;
        let d = problem.dimension.components();
        let inside = places.distances.iter().filter(|distance| **distance < 0.0).count();
        let even = match &problem.recipe.cloud {
            Cloud::Given { nodes } => {
                (inside as f64 * places.volume / nodes.len().max(1) as f64).powf(1.0 / d as f64)
            }
            Cloud::Regular { spacing }
            | Cloud::Jittered { spacing, .. }
            | Cloud::Graded { spacing, .. } => *spacing,
        };
        let shares = places.positions.par_iter().zip(&places.distances);
        let field = graded(problem)?;
        let spacing = |X: &Vector3| field.as_ref().map_or(even, |field| field.at(X));
        let shares: Vec<Share> =
            shares.map(|(X, distance)| share(problem, spacing(X), X, *distance)).collect();
        let sum = |part: fn(&Share) -> f64| places.volume * shares.iter().map(part).sum::<f64>();
        let (nodes, points) = (sum(|s| s.nodes), sum(|s| s.points));
        let entries = sum(|s| s.entries);
        let neighbours = entries / points.max(1.0);
        let batch = points.min(BATCH) * neighbours;
        let bytes = PROGRAM + PER_NODE * nodes + PER_ENTRY * entries + PER_BATCH_ENTRY * batch;
        Ok(Footprint { nodes, points, neighbours, bytes })
    }

    /// Refuses where more is needed than there is \[bytes\].
    fn refuse_beyond(self, available: f64) -> Result<(), MemoryShortage> {
        match self.bytes > available {
            true => Err(MemoryShortage { footprint: self, available }),
            false => Ok(()),
        }
    }
}

impl Places {
    fn of(problem: &Problem) -> Result<Places, GeometryError> {
        problem.body.validate_body()?;
        let body = problem.body.section(&problem.dimension)?;
        let (lower, upper) = problem.body.bounding_box().ok_or(GeometryError::NoNodes)?;
        let d = problem.dimension.components();
        // Nodes and cut cells count half a spacing beyond the boundary.
        let beyond = 0.05 * (upper - lower).xy().max();
        let count = SAMPLES[d - 2];
        let step = (upper - lower).map(|edge| (edge + 2.0 * beyond) / count as f64);
        let place = |index: usize| {
            let indices = [index % count, index / count % count, index / (count * count)];
            Vector3::from_fn(|k, _| match (k, &problem.dimension) {
                (2, Dimension::PlaneStrain { z, .. }) => *z,
                _ => lower[k] - beyond + (indices[k] as f64 + 0.5) * step[k],
            })
        };
        let positions: Vec<Vector3> = (0..count.pow(d as u32)).map(place).collect();
        let distances = positions.par_iter().map(|X| body.signed_distance(X)).collect();
        Ok(Places { positions, distances, volume: (0..d).map(|k| step[k]).product() })
    }
}

/// The spacings that a graded cloud wants. None for other clouds, and where a part is
/// too small to be met by a place.
fn graded(problem: &Problem) -> Result<Option<SizeField<'_>>, GeometryError> {
    let Cloud::Graded { spacing, refinements, growth, .. } = &problem.recipe.cloud else {
        return Ok(None);
    };
    let body = problem.body.section(&problem.dimension)?;
    let d = problem.dimension.components();
    let places = SAMPLES[d - 2].pow(d as u32) as f64;
    let wanted = WantedSizes { spacing: *spacing, refinements, growth: *growth };
    Ok(SizeField::new(&body, wanted, &problem.dimension, places).ok())
}

/// What a place with nodes `spacing` \[m\] apart and at a signed `distance` \[m\] adds per volume.
fn share(problem: &Problem, spacing: f64, X: &Vector3, distance: f64) -> Share {
    let (recipe, d) = (&problem.recipe, problem.dimension.components() as i32);
    let grid = &recipe.grid;
    let near = distance.abs() < grid.cell;
    let wanted = grid.boundary_cell.filter(|_| near).unwrap_or(grid.cell).min(grid.cell);
    let meets = |refinement: &&Refinement| cell_meets(&refinement.part, X, grid.cell, d);
    let refined = grid.refinements.iter().filter(meets).map(|refinement| refinement.size);
    let halvings = (grid.cell / refined.fold(wanted, f64::min)).log2().ceil().max(0.0);
    let cell = grid.cell / halvings.exp2();
    // A cell whose centre is outside counts where its inside part does.
    let reach = match grid.inside {
        InsideRule::Centre => 0.0,
        InsideRule::VolumeFraction => 0.5 * cell,
    };
    let density = match recipe.cloud {
        Cloud::Graded { .. } => GRADED_DENSITY[d as usize - 2],
        _ => 1.0,
    };
    let nodes = if distance < 0.5 * spacing { density * spacing.powi(-d) } else { 0.0 };
    let points = match distance < reach {
        true => (grid.gauss_points as f64 / cell).powi(d),
        false => 0.0,
    };
    let neighbours = density * support(d, recipe.dilation, distance / spacing);
    Share { nodes, points, entries: points * neighbours }
}

/// Whether a cell of the unrefined grid about X meets a part, which refines it as a whole.
fn cell_meets(part: &Selector, X: &Vector3, cell: f64, d: i32) -> bool {
    let half = |n: u32, k: usize| (n / 3u32.pow(k as u32) % 3) as f64 - 1.0;
    let offset = |n: u32| Vector3::from_fn(|k, _| if k < d as usize { half(n, k) } else { 0.0 });
    (0..3u32.pow(d as u32)).any(|n| part.contains(&(X + 0.5 * cell * offset(n))))
}

/// Nodes within `dilation` spacings of a point at a signed distance \[spacing\]
/// of a flat boundary: a ball, or a disc, with a cap cut off half a spacing
/// beyond the boundary.
fn support(d: i32, dilation: f64, distance: f64) -> f64 {
    let s = ((0.5 - distance) / dilation).clamp(0.0, 1.0);
    match d {
        2 => dilation.powi(2) * (PI - s.acos() + s * (1.0 - s * s).sqrt()),
        _ => PI * dilation.powi(3) * (2.0 + 3.0 * s - s.powi(3)) / 3.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::prepare;
    use crate::scene::read_case;

    fn carried(name: &str) -> Problem {
        let folder = tempfile::tempdir().unwrap();
        let cases = crate::bundled::unpack(folder.path()).unwrap();
        read_case(&cases.join(format!("{name}.toml"))).unwrap().problem
    }

    #[test]
    fn sizes_are_known_before_anything_is_made() {
        for name in [
            "cube_compression",
            "cook_membrane",
            "sphere_gravity",
            "brain_slice",
            "indented_block",
            "soft_inclusion",
        ] {
            let problem = carried(name);
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
        assert!(footprint.refuse_beyond(13e9).is_ok());
        let said = footprint.refuse_beyond(8e9).unwrap_err().to_string();
        assert!(said.contains("about 12 GB") && said.contains("and 8 GB"), "{said}");
        assert!(said.contains("use a larger spacing"), "{said}");
    }
}
