//! Size of a discretisation and memory of a run, estimated before the set-up.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::nodes::{RequestedSizes, SizeField};
use crate::geometry::{GeometryError, Selector};
use crate::problem::{Cloud, Dimension, InsideRule, Problem, Refinement};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Estimated size of a discretisation. The bytes are 0.9 to 1.15 of the peak of runs
/// on 32 bodies of 343 to 68 921 nodes with supports of 9 to 66, and 0.76 to 1.07 on six
/// graded ones of 10 000 to 30 000.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Number of nodes.
    pub nodes: f64,
    /// Number of quadrature points.
    pub points: f64,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// Memory at the peak, which is that of the set-up.
    pub bytes: f64,
}

/// Bytes of the program itself, 2e6 of them in development builds only; this and the
/// bytes per node and per support entry at the peak are fitted to the measured bodies.
const PROGRAM: f64 = 12.5e6;
const PER_NODE: f64 = 1700.0;
const PER_ENTRY: f64 = 82.0;
/// The supports of this many points are stored twice for a while, which takes
/// `PER_BATCH_ENTRY` bytes more for each entry.
const BATCH: f64 = 16_384.0;
const PER_BATCH_ENTRY: f64 = 62.0;

/// Nodes of a graded cloud per spacing² in a plane and per spacing³ in space, measured:
/// nodes are not on a lattice.
const GRADED_DENSITY: [f64; 2] = [1.1, 1.35];

/// Sample points of the body along each axis, in a plane and in space.
const SAMPLES: [usize; 2] = [256, 40];

/// Points on a lattice over the body and a little beyond.
struct SamplePoints {
    positions: Vec<Vector3>,
    /// Signed distance to the body \[sample\] \[m\].
    distances: Vec<f64>,
    /// Volume of a sample \[m³\], or area in a plane \[m²\].
    volume: f64,
}

/// Nodes, quadrature points and support entries per volume.
#[derive(Debug, Clone, Copy, Default)]
struct Density {
    nodes: f64,
    points: f64,
    entries: f64,
}

impl Footprint {
    /// From the volume of the body, the spacings and the cells in it.
    pub fn of(problem: &Problem) -> Result<Footprint, GeometryError> {
        let samples = SamplePoints::of(problem)?;
        let d = problem.dimension.components();
        let inside = samples.distances.iter().filter(|distance| **distance < 0.0).count();
        let even = match &problem.recipe.cloud {
            Cloud::Given { nodes } => {
                (inside as f64 * samples.volume / nodes.len().max(1) as f64).powf(1.0 / d as f64)
            }
            Cloud::Regular { spacing }
            | Cloud::Jittered { spacing, .. }
            | Cloud::Graded { spacing, .. } => *spacing,
        };
        let located = samples.positions.par_iter().zip(&samples.distances);
        let field = graded(problem)?;
        let spacing = |X: &Vector3| field.as_ref().map_or(even, |field| field.at(X));
        let densities: Vec<Density> =
            located.map(|(X, distance)| density_at(problem, spacing(X), X, *distance)).collect();
        let sum =
            |part: fn(&Density) -> f64| samples.volume * densities.iter().map(part).sum::<f64>();
        let (nodes, points) = (sum(|s| s.nodes), sum(|s| s.points));
        let entries = sum(|s| s.entries);
        let neighbours = entries / points.max(1.0);
        let batch = points.min(BATCH) * neighbours;
        let bytes = PROGRAM + PER_NODE * nodes + PER_ENTRY * entries + PER_BATCH_ENTRY * batch;
        Ok(Footprint { nodes, points, neighbours, bytes })
    }
}

impl SamplePoints {
    fn of(problem: &Problem) -> Result<SamplePoints, GeometryError> {
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
        Ok(SamplePoints { positions, distances, volume: (0..d).map(|k| step[k]).product() })
    }
}

/// The spacings of a graded cloud. None for other clouds, and where a part is too small
/// for the samples.
fn graded(problem: &Problem) -> Result<Option<SizeField<'_>>, GeometryError> {
    let Cloud::Graded { spacing, refinements, growth, .. } = &problem.recipe.cloud else {
        return Ok(None);
    };
    let body = problem.body.section(&problem.dimension)?;
    let d = problem.dimension.components();
    let samples = SAMPLES[d - 2].pow(d as u32) as f64;
    let requested = RequestedSizes { spacing: *spacing, refinements, growth: *growth };
    Ok(SizeField::new(&body, requested, &problem.dimension, samples).ok())
}

/// Density at X, with nodes `spacing` \[m\] apart, at a signed `distance` \[m\].
fn density_at(problem: &Problem, spacing: f64, X: &Vector3, distance: f64) -> Density {
    let (recipe, d) = (&problem.recipe, problem.dimension.components() as i32);
    let grid = &recipe.grid;
    let near = distance.abs() < grid.cell;
    let largest = grid.boundary_cell.filter(|_| near).unwrap_or(grid.cell).min(grid.cell);
    let meets = |refinement: &&Refinement| cell_meets(&refinement.part, X, grid.cell, d);
    let refined = grid.refinements.iter().filter(meets).map(|refinement| refinement.size);
    let halvings = (grid.cell / refined.fold(largest, f64::min)).log2().ceil().max(0.0);
    let cell = grid.cell / halvings.exp2();
    // A cell whose centre is outside counts where its inside part does.
    let reach = match grid.inside {
        InsideRule::Centre => 0.0,
        InsideRule::VolumeFraction => 0.5 * cell,
    };
    let crowding = match recipe.cloud {
        Cloud::Graded { .. } => GRADED_DENSITY[d as usize - 2],
        _ => 1.0,
    };
    let nodes = if distance < 0.5 * spacing { crowding * spacing.powi(-d) } else { 0.0 };
    let points = match distance < reach {
        true => (grid.gauss_points as f64 / cell).powi(d),
        false => 0.0,
    };
    let neighbours = crowding * support(d, recipe.dilation, distance / spacing);
    Density { nodes, points, entries: points * neighbours }
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
