//! Size of a discretisation and the memory that it takes, estimated before the set-up, or
//! from its counts.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::Discretisation;
use crate::discretisation::nodes::{RequestedSizes, SizeField};
use crate::discretisation::placed_nodes::PANEL;
use crate::discretisation::quadrature::followed_edge;
use crate::discretisation::shape_memory::ShapeMemory;
use crate::geometry::{GeometryError, POINTS, Selector, Shape, merges_voxels};
use crate::problem::defaults::SINGLE_FROM;
use crate::problem::{Cloud, Dimension, GradientStorage, InsideRule, Loads, Problem, Refinement};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Size of a discretisation. From counts the bytes are an upper bound of the peak, within
/// 30 % on all bodies measured (method book, eq. 23.1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Number of nodes.
    pub nodes: f64,
    /// Number of quadrature points.
    pub points: f64,
    /// Mean number of nodes per support.
    pub neighbours: f64,
    /// Number of pieces of the boundary.
    pub panels: f64,
    /// Number of those where displacements are prescribed.
    pub held: f64,
    /// Memory at the peak of set-up and run, without what is recorded.
    pub bytes: f64,
}

/// Bytes of the program itself, 2e6 of them in development builds only; this and the
/// following bytes at the peak are fitted to the measured bodies.
const PROGRAM: f64 = 24.0e6;
const PER_NODE: f64 = 1400.0;
const PER_ENTRY: f64 = 60.0;
/// Of gradients in single precision, half of 24, where the default is double precision.
const PER_SINGLE_ENTRY: f64 = PER_ENTRY - 12.0;
const PER_PANEL: f64 = 710.0;
/// What the audit finds of the surface of a body from an image, in all and per node.
const OF_IMAGE: [f64; 2] = [2e6, 3000.0];
/// What couples the nodes of parts where displacements are prescribed.
const PER_HELD_NODE: f64 = 1500.0;
/// Rows of φ and Grad φ: what stays, and the second copy of so many points for a while.
const PER_ROW_ENTRY: f64 = 36.0;
const BATCH: f64 = 16_384.0;
/// The preconditioner of Newton's method: φ at the nodes and its approximate inverse, the
/// splines and their factor.
const PER_NEWTON_ENTRY: f64 = 55.0;
const PER_BATCH_ENTRY: f64 = 36.0;
/// Panels over the boundary's area divided by their size², and those of an image or a
/// function, which come from tetrahedra.
const PANELS_PER_AREA: [f64; 2] = [1.0, 8.0];

/// Nodes of a graded cloud per spacing² in a plane and per spacing³ in space, measured:
/// nodes are not on a lattice.
const GRADED_DENSITY: [f64; 2] = [1.1, 1.2];

/// Sample points of the body along each axis, in a plane and in space.
const SAMPLES: [usize; 2] = [160, 32];

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
        POINTS.check(points)?;
        let neighbours = sum(|s| s.entries) / points.max(1.0);
        let smallest = match &problem.recipe.cloud {
            Cloud::Graded { refinements, .. } => {
                refinements.iter().map(|refinement| refinement.size).fold(even, f64::min)
            }
            _ => even,
        };
        let panels = samples.panels(problem, smallest);
        let held = panels * samples.held_share(problem);
        let footprint = Footprint { nodes, points, neighbours, panels, held, bytes: 0.0 };
        Ok(footprint.with_bytes(problem))
    }

    /// From the counts of a discretisation.
    pub fn counted(problem: &Problem, discretisation: &Discretisation) -> Footprint {
        let panels = &discretisation.surface.panels;
        let held = panels
            .iter()
            .filter(|p| problem.conditions.iter().any(|c| c.part.contains_panel(p)))
            .count();
        let footprint = Footprint {
            nodes: discretisation.cloud.positions.len() as f64,
            points: discretisation.supports.len() as f64,
            neighbours: discretisation.mean_support(),
            panels: panels.len() as f64,
            held: held as f64,
            bytes: 0.0,
        };
        footprint.with_bytes(problem)
    }

    /// The largest of what is in memory at the same time: images while they are read, the
    /// distances to the refined parts while nodes are chosen, and everything afterwards.
    fn with_bytes(self, problem: &Problem) -> Footprint {
        let shapes = ShapeMemory::of(problem_shapes(problem), problem_selectors(problem));
        let entries = self.points * self.neighbours;
        let single = problem.recipe.gradient_storage == GradientStorage::Single;
        let small = entries < SINGLE_FROM as f64;
        let per_entry = if single && small { PER_SINGLE_ENTRY } else { PER_ENTRY };
        let set_up = PER_NODE * self.nodes
            + per_entry * entries
            + PER_BATCH_ENTRY * self.points.min(BATCH) * self.neighbours
            + PER_PANEL * self.panels
            + PER_HELD_NODE * self.held.min(self.nodes)
            + following(problem) as f64 * self.panels * PER_ROW_ENTRY * self.neighbours
            + if problem.by_newton() {
                PER_NEWTON_ENTRY * self.nodes * self.neighbours
            } else {
                0.0
            }
            + shapes.kept;
        let choosing = shapes.kept + size_field_bytes(problem);
        let image =
            if problem.body.has_labels() { OF_IMAGE[0] + OF_IMAGE[1] * self.nodes } else { 0.0 };
        let bytes = PROGRAM + image + set_up.max(choosing).max(shapes.reading);
        Footprint { bytes, ..self }
    }

    /// Bytes of φ and Grad φ at some more points of the body, and while they are made.
    pub fn rows_bytes(&self, points: f64) -> f64 {
        let entries = points * self.neighbours;
        PER_ROW_ENTRY * entries + PER_BATCH_ENTRY * points.min(BATCH) * self.neighbours
    }
}

/// Parts of the surface at which shape functions are kept.
fn following(problem: &Problem) -> usize {
    let Loads { pressures, springs, cavities, .. } = &problem.loads;
    pressures.len() + springs.len() + cavities.len()
}

/// Every shape of a problem that is not in a selector.
fn problem_shapes(problem: &Problem) -> impl Iterator<Item = &Shape> {
    std::iter::once(&problem.body).chain(problem.obstacles.iter().map(|o| &o.shape))
}

/// Every selector of a problem.
fn problem_selectors(problem: &Problem) -> impl Iterator<Item = &Selector> {
    let refined = match &problem.recipe.cloud {
        Cloud::Graded { refinements, .. } => &refinements[..],
        _ => &[],
    };
    let regions = problem.regions.iter().map(|region| &region.part);
    let conditions = problem.conditions.iter().map(|condition| &condition.part);
    let body_forces = problem.loads.body_forces.iter().map(|body_force| &body_force.part);
    let refined = refined.iter().chain(&problem.recipe.grid.refinements).map(|r| &r.part);
    let surface = problem.loads.parts_of_surface();
    regions.chain(conditions).chain(surface).chain(body_forces).chain(refined)
}

/// Memory while the nodes of a graded cloud are chosen \[bytes\].
fn size_field_bytes(problem: &Problem) -> f64 {
    let Cloud::Graded { spacing, refinements, growth, .. } = &problem.recipe.cloud else {
        return 0.0;
    };
    let requested = RequestedSizes { spacing: *spacing, refinements, growth: *growth };
    let samples = requested.samples(&problem.body, &problem.dimension).unwrap_or(0.0);
    // A distance for each part; while one is made, where its samples came from.
    samples * (8.0 * refinements.len() as f64 + PER_KNOWN_DISTANCE)
}

/// Bytes per sample while distances are propagated: half of the samples in the part.
const PER_KNOWN_DISTANCE: f64 = 40.0;

impl SamplePoints {
    fn of(problem: &Problem) -> Result<SamplePoints, GeometryError> {
        problem.body.validate_body()?;
        let body = problem.body.section(&problem.dimension)?;
        let (lower, upper) = problem.body.bounding_box().ok_or(GeometryError::NoNodes)?;
        let d = problem.dimension.components();
        // Nodes and cut cells count half a spacing beyond the boundary; not further, or no
        // sample would lie inside a slender body.
        let spacing = problem.recipe.spacing().unwrap_or(0.0);
        let largest = 0.05 * (upper - lower).xy().max();
        let beyond = (upper - lower).map(|edge| largest.min((0.05 * edge).max(spacing)));
        let count = SAMPLES[d - 2];
        let step = (upper - lower + 2.0 * beyond) / count as f64;
        let place = |index: usize| {
            let indices = [index % count, index / count % count, index / (count * count)];
            Vector3::from_fn(|k, _| match (k, &problem.dimension) {
                (2, Dimension::PlaneStrain { z, .. }) => *z,
                _ => lower[k] - beyond[k] + (indices[k] as f64 + 0.5) * step[k],
            })
        };
        let positions: Vec<Vector3> = (0..count.pow(d as u32)).map(place).collect();
        let distances = positions.par_iter().map(|X| body.signed_distance(X)).collect();
        Ok(SamplePoints { positions, distances, volume: (0..d).map(|k| step[k]).product() })
    }

    /// The distance \[m\] of samples next to the boundary.
    fn near(&self, d: i32) -> f64 {
        1.5 * self.volume.powf(1.0 / d as f64)
    }

    /// The samples next to the boundary.
    fn near_boundary(&self, d: i32) -> impl Iterator<Item = &Vector3> {
        let near = self.near(d);
        let located = self.positions.iter().zip(&self.distances);
        located.filter(move |(_, distance)| distance.abs() < near).map(|(X, _)| X)
    }

    /// The share of the boundary where displacements are prescribed.
    fn held_share(&self, problem: &Problem) -> f64 {
        let d = problem.dimension.components() as i32;
        let is_held = |X: &&Vector3| problem.conditions.iter().any(|c| c.part.contains(X));
        let held = self.near_boundary(d).filter(is_held).count();
        held as f64 / self.near_boundary(d).count().max(1) as f64
    }

    /// Pieces of the boundary, from the volume next to it.
    fn panels(&self, problem: &Problem, smallest: f64) -> f64 {
        let d = problem.dimension.components() as i32;
        let area = self.near_boundary(d).count() as f64 * self.volume / (2.0 * self.near(d));
        let size = PANEL * smallest;
        if let (Shape::Labels(field), 3) = (&problem.body, d)
            && merges_voxels(field, size)
        {
            // They cost little: the set-up makes them of the same pieces.
            let panels = problem.body.boundary_panels(size, &problem.dimension);
            return panels.map_or(0.0, |panels| panels.len() as f64);
        }
        let (size, crowding, triangles) = match &problem.body {
            Shape::Labels(field) => {
                ((size / 3f64.sqrt()).min(field.voxel()), PANELS_PER_AREA[1], 0.0)
            }
            Shape::Function(_) => (size / 3f64.sqrt(), PANELS_PER_AREA[1], 0.0),
            Shape::Surface(surface) if surface.merges_triangles(size) => {
                (size, 4.0 * PANELS_PER_AREA[0], 0.0)
            }
            Shape::Surface(surface) => {
                (size, 2.0 * PANELS_PER_AREA[0], surface.triangle_count() as f64)
            }
            _ => (size, PANELS_PER_AREA[0], 0.0),
        };
        match d {
            2 => area / size,
            _ => (crowding * area / (size * size)).max(triangles),
        }
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
    let edge = match grid.cells_per_spacing {
        // Nodes that are given have the mean spacing here.
        Some(cells) => {
            let largest = recipe.spacing().unwrap_or(spacing).max(spacing);
            followed_edge(grid.cell.min(largest / cells), spacing / cells)
        }
        None => grid.cell,
    };
    let near = distance.abs() < edge;
    let largest = grid.boundary_cell.filter(|_| near).unwrap_or(edge).min(edge);
    let meets = |refinement: &&Refinement| cell_meets(&refinement.part, X, edge, d);
    let refined = grid.refinements.iter().filter(meets).map(|refinement| refinement.size);
    let halvings = (edge / refined.fold(largest, f64::min)).log2().ceil().max(0.0);
    let cell = edge / halvings.exp2();
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
    let points = if distance < reach { (grid.gauss_points as f64 / cell).powi(d) } else { 0.0 };
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
