//! The body that is measured, a cube of brain tissue of any size and support, and its variants.

use crate::limits::caches;
use anyhow::ensure;
use mtled::algebra::random::Random;
use mtled::discretisation::Discretisation;
use mtled::discretisation::nodes::node_cloud;
use mtled::force::{Workspace, internal_force};
use mtled::material::{Law, Material, MooneyRivlin};
use mtled::model::Model;
use mtled::problem::{
    BackgroundGrid, Cloud, Dimension, GradientStorage, Gradients, Motion, Problem, StepControl,
    VolumetricProjection, defaults,
};
use mtled_run::specimens::simple::{SIZE, block_shape, free_body, recipe};

/// Cells per nodal spacing, which gives two points per node \[–\].
const CELLS_PER_SPACING: f64 = 1.26;
/// Largest random shift of a node over the spacing \[–\].
const JITTER: f64 = 0.2;

/// The part of the memory where the gradients and indices of one evaluation fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MemoryLevel {
    /// Second cache of a core.
    SecondCache,
    /// Last cache of the processor.
    LastCache,
    /// No cache.
    Memory,
}

impl MemoryLevel {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            MemoryLevel::SecondCache => "L2",
            MemoryLevel::LastCache => "L3",
            MemoryLevel::Memory => "DRAM",
        }
    }

    /// Cells per edge of a cube whose evaluation, at 28 bytes per point and neighbour, fills
    /// 0.6 of the second cache of a core, 0.4 of the last cache, or more than any cache: four
    /// times the last one and, unless `quick`, at least 300 000 points.
    pub fn cells(self, neighbours: f64, quick: bool) -> usize {
        let (second, last) = caches();
        let edge = |points: f64| points.cbrt();
        let filling = |bytes: f64| edge(bytes / (28.0 * neighbours));
        let cells = match self {
            MemoryLevel::SecondCache => filling(0.6 * second as f64).floor(),
            MemoryLevel::LastCache => filling(0.4 * last as f64).floor(),
            MemoryLevel::Memory => {
                let beyond = filling(4.0 * last as f64);
                if quick { beyond.ceil() } else { beyond.max(edge(300_000.0)).ceil() }
            }
        };
        cells as usize
    }
}

/// A jittered cube of brain tissue with `cells` cells per edge, one point each, and about
/// this mean number of `neighbours` per support, with plain gradients in double precision.
pub fn cube(cells: usize, neighbours: f64) -> Problem {
    let spacings = (cells as f64 / CELLS_PER_SPACING).round().max(2.0);
    let mut recipe = recipe(SIZE / spacings, JITTER, 5);
    recipe.dilation = dilation(cells, spacings, neighbours);
    recipe.grid = BackgroundGrid::with_cell(SIZE / cells as f64);
    recipe.gradients = Gradients::Plain;
    recipe.gradient_storage = GradientStorage::Double;
    let mut problem = free_body(Dimension::Three, block_shape(), brain(), recipe);
    problem.motion = Motion::Dynamic { end: 1.0, step: StepControl::default(), damping: 10.0 };
    problem
}

/// The same problem with the recommended gradients.
pub fn recommended(mut problem: Problem) -> Problem {
    problem.recipe.gradients = defaults::GRADIENTS;
    problem.recipe.gradient_storage = defaults::GRADIENT_STORAGE;
    problem
}

/// The same problem with J at each point instead of its projection.
pub fn pointwise(mut problem: Problem) -> Problem {
    problem.recipe.volumetric_projection = VolumetricProjection::None;
    problem
}

/// The same problem with gradients stored in single precision.
pub fn in_single_precision(mut problem: Problem) -> Problem {
    problem.recipe.gradient_storage = GradientStorage::Single;
    problem
}

/// The same problem with its nodes given one by one, in their order.
pub fn with_given_nodes(mut problem: Problem) -> anyhow::Result<Problem> {
    let (body, recipe) = (&problem.body, &mut problem.recipe);
    let nodes = node_cloud(body, &recipe.cloud, &problem.dimension)?.positions;
    recipe.cloud = Cloud::Given { nodes };
    Ok(problem)
}

/// The same problem with given nodes in random order.
pub fn shuffled(mut problem: Problem) -> Problem {
    if let Cloud::Given { nodes } = &mut problem.recipe.cloud {
        let mut random = Random(7);
        for i in (1..nodes.len()).rev() {
            let other = (0.5 * (random.symmetric() + 1.0) * (i + 1) as f64) as usize;
            nodes.swap(i, other.min(i));
        }
    }
    problem
}

/// Brain tissue of (Horton 2007, section 3.3): A = 1052 Pa, ν = 0.49, 1000 kg/m³.
fn brain() -> Material {
    let law = MooneyRivlin::new(1052.0, 0.0, 0.49).expect("these constants are valid");
    Material { density: 1000.0, law: Law::MooneyRivlin(law) }
}

/// The dilation with which the supports of the cell centres have this mean number of lattice
/// nodes, by bisection.
fn dilation(cells: usize, spacings: f64, neighbours: f64) -> f64 {
    let (mut low, mut high) = (1.2, 6.0);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        let few = mean_support(cells, spacings, middle) < neighbours;
        if few { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Mean number of lattice nodes within `dilation` spacings of a point, over a sample of points
/// with its due fraction of faces, edges and corners.
fn mean_support(cells: usize, spacings: f64, dilation: f64) -> f64 {
    let stride = cells.div_ceil(9);
    let sample: Vec<f64> =
        (0..cells).step_by(stride).map(|i| (i as f64 + 0.5) / cells as f64 * spacings).collect();
    let near = |x: f64| {
        let low = (x - dilation).ceil().max(0.0) as usize;
        let high = (x + dilation).floor().min(spacings) as usize;
        (low..=high).map(move |node| (node as f64 - x).powi(2))
    };
    let mut count = 0;
    for &x in &sample {
        for &y in &sample {
            for &z in &sample {
                let squares = near(x).flat_map(|a| near(y).map(move |b| a + b));
                let all = squares.flat_map(|ab| near(z).map(move |c| ab + c));
                count += all.filter(|square| *square < dilation * dilation).count();
            }
        }
    }
    count as f64 / sample.len().pow(3) as f64
}

/// Elongation with some shear and bending, far from rest and from inversion \[m\].
pub fn deformed(model: &Model) -> Vec<f64> {
    let bend = |x: f64, y: f64, z: f64| [0.05 * x + 0.1 * y * z, 0.02 * z, -0.04 * z + 0.1 * x * x];
    let moved = model.positions.iter().map(|p| bend(p.x, p.y, p.z));
    moved.flat_map(|u| u.into_iter().take(model.components)).collect()
}

/// A model in a deformed state.
pub struct DeformedModel {
    /// The model.
    pub model: Model,
    /// Displacements, component by component of each node \[m\].
    pub u: Vec<f64>,
    /// Internal forces of the last evaluation, likewise \[N\].
    pub f: Vec<f64>,
    workspace: Workspace,
}

impl DeformedModel {
    /// The model of a problem.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
    ) -> anyhow::Result<DeformedModel> {
        Ok(DeformedModel::of(Model::new(problem, discretisation)?))
    }

    /// A model that exists already.
    pub fn of(model: Model) -> DeformedModel {
        let (u, f) = (deformed(&model), vec![0.0; model.size()]);
        let workspace = Workspace::new(&model.points);
        DeformedModel { model, u, f, workspace }
    }

    /// One evaluation of the internal force.
    pub fn evaluate(&mut self) {
        internal_force(&self.model.points, &self.u, &mut self.workspace, &mut self.f);
    }
}

/// The components of a force by size, so that forces at nodes in another order can be compared.
pub fn in_order(f: &[f64]) -> Vec<f64> {
    let mut components = f.to_vec();
    components.sort_by(f64::total_cmp);
    components
}

/// Refuses a comparison of forces that differ by more than a fraction of the largest.
pub fn same_force(f: &[f64], other: &[f64], tolerance: f64) -> anyhow::Result<()> {
    let largest = other.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    let difference = f.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let finite = f.iter().chain(other).all(|x| x.is_finite());
    ensure!(
        finite && f.len() == other.len() && largest > 0.0 && difference <= tolerance * largest,
        "two forces that are compared differ by {difference:.1e} of {largest:.1e} N"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn different_forces_are_not_compared() {
        assert!(same_force(&[1.0, 2.0], &[1.0, 2.0 + 1e-12], 1e-9).is_ok());
        assert!(same_force(&[1.0, 2.0], &[1.0, 2.1], 1e-9).is_err());
        assert!(same_force(&[f64::NAN, 2.0], &[1.0, 2.0], 1e-9).is_err());
        assert!(same_force(&[0.0], &[0.0], 1e-9).is_err(), "nothing was evaluated");
        assert!(same_force(&[2.0], &[2.0, 2.0], 1e-9).is_err());
    }

    #[test]
    fn shuffled_nodes_are_the_same_nodes_in_another_order() {
        let sorted = with_given_nodes(cube(6, 30.0)).unwrap();
        let evaluated = |problem: &Problem| {
            let discretisation = Discretisation::new(problem).unwrap();
            let mut model = DeformedModel::new(problem, &discretisation).unwrap();
            model.evaluate();
            model
        };
        let (first, second) = (evaluated(&shuffled(sorted.clone())), evaluated(&sorted));
        assert_ne!(first.u, second.u);
        same_force(&in_order(&first.f), &in_order(&second.f), 1e-9).unwrap();
    }

    #[test]
    fn supports_have_the_requested_size() {
        for (cells, neighbours) in [(9, 30.0), (16, 30.0), (12, 70.0)] {
            let problem = cube(cells, neighbours);
            let discretisation = Discretisation::new(&problem).unwrap();
            assert_eq!(discretisation.supports.len(), cells.pow(3));
            let mean = discretisation.mean_support();
            assert!((mean / neighbours - 1.0).abs() < 0.1, "{cells} cells: {mean}");
        }
    }

    #[test]
    fn a_larger_memory_holds_more_points() {
        for neighbours in [30.0, 70.0] {
            let cells = [MemoryLevel::SecondCache, MemoryLevel::LastCache, MemoryLevel::Memory]
                .map(|level| level.cells(neighbours, true));
            assert!(cells[0] < cells[1] && cells[1] < cells[2], "{cells:?}");
        }
    }
}
