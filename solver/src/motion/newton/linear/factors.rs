//! Cholesky's factors of the tangent, for systems that iterations take long for.
#![allow(non_snake_case)]

use super::coarse_space::Stiffness;
use super::elimination_order::Order;
use super::system::System;
use crate::algebra::block_matrix::BlockMatrix;
use crate::algebra::sparse_cholesky::{Scratch, SparseCholesky};
use crate::algebra::tensor::{Vector3, cofactor};
use crate::force::{Block, Chunk, ChunkTangent, GradientQuad, QUAD, with_gradients};
use crate::model::Model;
use crate::model::following::directions;
use crate::motion::newton::free_space::FreeSpace;
use crate::motion::tangent::Tangent;
use faer::perm::Perm;
use faer::sparse::SparseColMat;
use faer::sparse::linalg::cholesky::SymmetricOrdering;

/// Stiffness of what is prescribed over that of a node \[–\].
const HOLDS: f64 = 1e6;
/// Part of the stiffness of nodes that is added everywhere \[–\]: round-off.
const FLOOR: f64 = 1e-9;
/// Most entries of the factors, for memory.
const MOST_ENTRIES: usize = 8_000_000;
/// Most entries for a neighbour of a point in space, since a solution with factors of bodies that are
/// neither thin nor small costs more than it saves. In a plane the number grows slower, and the other
/// preconditioner does worse.
const MOST_IN_SPACE: f64 = 32.0;
/// What the work for a neighbour of a point in a product with the tangent is worth: operations of a
/// factorisation, and entries of the factors in a solution.
const OPERATIONS: f64 = 100.0;
const ENTRIES: f64 = 4.0;
/// What an entry of the factors costs beside operations, in such work.
const WRITTEN: f64 = 4.0;
/// The tangents of all chunks over the products that they are worth, for each node of a support.
const TANGENTS: f64 = 3.0;

/// The inverse of K + shift D + κ Σ c cᵀ with the rows c of what is prescribed.
pub(super) struct Factors {
    matrix: BlockMatrix,
    order: Order,
    /// What making them costs in products with the tangent.
    pub price: f64,
    /// What a solution costs in products with the tangent.
    pub price_of_solution: f64,
    cholesky: Option<SparseCholesky>,
    /// Entries of the matrix that they were made for.
    places: usize,
    scratch: Scratch,
}

impl Factors {
    /// Without factors yet; `None` where they would have too many entries.
    pub fn new(model: &Model) -> Option<Factors> {
        let order = Order::of(model);
        let pairs = pairs(model);
        let entries = order.entries as f64;
        let in_space = model.components == 3;
        if order.entries > MOST_ENTRIES || in_space && entries > MOST_IN_SPACE * pairs {
            return None;
        }
        let operations = entries * entries / model.size() as f64;
        let of_entries = WRITTEN * entries + operations / OPERATIONS;
        Some(Factors {
            matrix: BlockMatrix::new(model.positions.len(), model.components),
            order,
            price: Factors::least_price(model) + of_entries / pairs,
            price_of_solution: entries / (ENTRIES * pairs),
            cholesky: None,
            places: 0,
            scratch: Scratch::default(),
        })
    }

    /// What the tangents of all points cost in products with the tangent.
    pub fn least_price(model: &Model) -> f64 {
        TANGENTS * pairs(model) / model.point_positions.len() as f64
    }

    /// Makes them for a system; whether its tangent is positive definite.
    pub fn make(&mut self, free: &FreeSpace, at_rest: &Stiffness, system: &mut System) -> bool {
        let Factors { matrix, cholesky, .. } = self;
        let model = system.tangent.model();
        matrix.clear();
        add_tangent(matrix, &mut system.tangent);
        if let Some(turning) = system.tangent.turning() {
            matrix.add(turning, -1.0);
        }
        for (node, stiffness) in at_rest.diagonal.iter().enumerate() {
            matrix.add_to_diagonal(node as u32, (FLOOR + system.shift) * stiffness);
        }
        for (node, springs) in model.following.lumped_springs() {
            for (along, stiffness) in directions(&springs) {
                matrix.add_spring(&[node], &[1.0], &along, stiffness);
            }
        }
        free.for_each_row(|nodes, factors, along| {
            let diagonal = nodes.iter().map(|node| at_rest.diagonal[*node as usize]);
            matrix.add_spring(nodes, factors, along, HOLDS * diagonal.fold(0.0, f64::max));
        });
        let matrix = matrix.assembled();
        if cholesky.is_none() || matrix.compute_nnz() != self.places {
            self.places = matrix.compute_nnz();
            *cholesky = in_order(&matrix, &self.order.nodes, model.components);
        }
        cholesky.as_mut().is_some_and(|cholesky| cholesky.factor_again(&matrix))
    }

    /// Solves with a force \[N\] in place.
    pub fn solve(&mut self, force: &mut [f64]) {
        if let Some(cholesky) = &self.cholesky {
            cholesky.solve(force, &mut self.scratch);
        }
    }
}

/// Without numbers yet, for a matrix and an order of its nodes.
fn in_order(
    lower: &SparseColMat<usize, f64>,
    nodes: &[u32],
    components: usize,
) -> Option<SparseCholesky> {
    let of_node = |node: &u32| components * *node as usize..components * (*node as usize + 1);
    let forward: Box<[usize]> = nodes.iter().flat_map(of_node).collect();
    let mut inverse = vec![0; forward.len()].into_boxed_slice();
    forward.iter().enumerate().for_each(|(rank, unknown)| inverse[*unknown] = rank);
    let order = Perm::new_checked(forward, inverse, lower.ncols());
    SparseCholesky::in_order(lower, SymmetricOrdering::Custom(order.as_ref()))
}

/// Adds the tangent of the body.
fn add_tangent(matrix: &mut BlockMatrix, tangent: &mut Tangent) {
    let components = tangent.model().components;
    tangent.for_each_chunk(|block, chunk, tangent| {
        // Chooses the precision in which gradients are stored.
        with_gradients!(&block.grad_phi, gradients => match components {
            2 => add_chunk::<_, 2>(matrix, (block, gradients), chunk, tangent),
            _ => add_chunk::<_, 3>(matrix, (block, gradients), chunk, tangent),
        });
    });
}

/// Neighbours of all points.
fn pairs(model: &Model) -> f64 {
    model.points.blocks.iter().map(|block| block.places.len() * QUAD).sum::<usize>() as f64
}

/// Adds the tangent of a chunk.
fn add_chunk<G: GradientQuad, const D: usize>(
    matrix: &mut BlockMatrix,
    (block, grad_phi): (&Block, &[G]),
    chunk: &Chunk,
    tangent: &ChunkTangent,
) {
    let mut moments: Vec<(u32, [Vector3; 4])> = Vec::new();
    let points = tangent.points.iter().zip(&tangent.deformation);
    for (lane, (tangent, F)) in chunk.lanes.clone().zip(points) {
        let weight = block.quadrature_weights[lane];
        let mut support: Vec<(u32, Vector3)> = Vec::new();
        for (node, gradient) in block.support::<G, D>(grad_phi, lane) {
            if gradient.iter().any(|g| *g != 0.0) {
                let mut grad = Vector3::zeros();
                (0..D).for_each(|k| grad[k] = gradient[k]);
                support.push((block.nodes[node], grad));
            }
        }
        support.sort_unstable_by_key(|(node, _)| *node);
        matrix.add_tangent(&support, &tangent.map(|row| row.map(|entry| weight * entry)));
        if let Some(projection) = &block.projection {
            let cof = cofactor(F);
            let basis = projection.basis_at(lane).map(|b| weight * b);
            let of_node =
                |(node, gradient): &(u32, Vector3)| (*node, basis.map(|b| b * (cof * gradient)));
            moments.extend(support.iter().map(of_node));
        }
    }
    moments.sort_by_key(|(node, _)| *node);
    moments.dedup_by(|next, sums| {
        let same = next.0 == sums.0;
        if same {
            sums.1.iter_mut().zip(next.1).for_each(|(sum, moment)| *sum += moment);
        }
        same
    });
    matrix.add_squares(&moments, &tangent.patch);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::packed::dot;
    use crate::algebra::random::Random;
    use crate::force::{OwnPressures, Workspace};
    use crate::geometry::Shape;
    use crate::material::{ElasticConstants, Law, Material, NeoHookeanLogJ};
    use crate::problem::{Dimension, Problem, Recipe};
    use crate::simulation::Simulation;

    /// The largest difference of the assembled matrix times a vector from the product with the
    /// tangent, over the largest entry.
    fn difference(poisson_ratio: f64, dimension: Dimension, own_part: Option<f64>) -> f64 {
        let constants = ElasticConstants::from_young_poisson(3000.0, poisson_ratio).unwrap();
        let law = Law::NeoHookeanLogJ(NeoHookeanLogJ::new(constants));
        let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(0.05) };
        let material = Material { density: 1000.0, law };
        let mut problem = Problem::new(body, material, Recipe::with_spacing(0.01));
        problem.dimension = dimension;
        let model = Simulation::new(&problem).unwrap().model;
        let mut random = Random(3);
        let mut field =
            || -> Vec<f64> { (0..model.size()).map(|_| 1e-3 * random.vector(1).x).collect() };
        let (u, v) = (field(), field());
        let mut workspace = Workspace::new(&model.points);
        let own = own_part.map(|most| OwnPressures::zero(&model.points, most));
        let mut tangent = Tangent::new(&model, &u, 0.0, &mut workspace).with_pressures(own);
        let mut matrix = BlockMatrix::new(model.positions.len(), model.components);
        add_tangent(&mut matrix, &mut tangent);
        let lower = matrix.assembled();
        let mut product = vec![0.0; model.size()];
        for entry in lower.triplet_iter() {
            product[entry.row] += entry.val * v[entry.col];
            if entry.row != entry.col {
                product[entry.col] += entry.val * v[entry.row];
            }
        }
        let right = tangent.stiffness_times(&v);
        let largest = dot(&right, &right).sqrt();
        let differences: Vec<f64> = product.iter().zip(&right).map(|(a, b)| a - b).collect();
        dot(&differences, &differences).sqrt() / largest
    }

    #[test]
    fn the_assembled_tangent_is_that_of_products() {
        let plane = Dimension::PlaneStrain { thickness: 0.01, z: 0.025 };
        for poisson_ratio in [0.3, 0.49] {
            for dimension in [Dimension::Three, plane] {
                for own in [None, Some(3.0)] {
                    let difference = difference(poisson_ratio, dimension, own);
                    assert!(difference < 1e-12, "{poisson_ratio}: {difference}");
                }
            }
        }
    }
}
