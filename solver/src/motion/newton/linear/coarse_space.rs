//! The stiffness at rest of smooth displacements.
#![allow(non_snake_case)]

use crate::algebra::block_matrix::BlockMatrix;
use crate::algebra::sparse::{Combine, Padded, Sparse, pad, unpad};
use crate::algebra::sparse_cholesky::{Scratch, SparseCholesky};
use crate::algebra::spline_lattice::Lattice;
use crate::algebra::tensor::Vector3;
use crate::force::{Block, Chunk, ModuliAtRest, stiffness_diagonal};
use crate::model::Model;
use crate::model::following::directions;
use std::collections::BTreeMap;

/// The stiffness at rest that a preconditioner inverts.
pub(super) struct Stiffness {
    /// Diagonal \[node\] \[N/m\].
    pub diagonal: Vec<f64>,
    /// Largest projected bulk modulus over the shear modulus \[–\].
    pub most: f64,
}

impl Stiffness {
    pub fn new(model: &Model, most: f64) -> Stiffness {
        let (d, nodes) = (model.components, model.positions.len());
        if most.is_infinite() {
            return Stiffness { diagonal: model.stiffness.clone(), most };
        }
        let mut diagonal = stiffness_diagonal(&model.points, nodes, most);
        model.following.add_to_diagonal(d, &mut diagonal);
        Stiffness { diagonal, most }
    }
}

/// Spacing of the lattice over that of the nodes \[–\], at most.
const SPACING: f64 = 4.5;
/// Points of a lattice cell along each axis, to which quadrature points are lumped.
const LUMPS: f64 = 3.0;
/// Part of the stiffness of nodes that is added everywhere \[–\]: round-off.
const FLOOR: f64 = 1e-9;
/// Least stiffness of a function over the median, each over its values at the nodes \[–\].
const TAIL: f64 = 0.5;

/// P A₀⁻¹ Pᵀ with quadratic splines on a coarse lattice, P their values at the nodes and
/// A₀ their stiffness at rest (method book, eq. 21.7). Held displacements are stiff
/// springs of A₀, so that the functions end there.
pub(super) struct CoarseSpace {
    /// P and Pᵀ.
    values: [Sparse; 2],
    /// Without held displacements.
    free: BlockMatrix,
    cholesky: Option<SparseCholesky>,
    scratch: Scratch,
}

/// A displacement of a node that is held, and the stiffness of that \[N/m\].
pub(super) struct Held {
    pub node: u32,
    /// Unit vector.
    pub along: Vector3,
    pub stiffness: f64,
}

impl CoarseSpace {
    pub fn new(model: &Model, at_rest: &Stiffness) -> CoarseSpace {
        let d = model.components;
        let volume: f64 = model.points.blocks.iter().flat_map(|b| &b.quadrature_weights).sum();
        let spacing = (volume / model.positions.len() as f64).powf(1.0 / d as f64);
        let lattice = Lattice::of_cells(&model.positions, SPACING * spacing, d);
        let mut numbers = Numbers { of: vec![None; lattice.len()], count: 0 };
        let mut rows = Vec::with_capacity(model.positions.len());
        for X in &model.positions {
            let mut row = Vec::with_capacity(27);
            lattice.at(X).for_each(|function, value| {
                if value != 0.0 {
                    row.push((numbers.number(function), value));
                }
            });
            rows.push(row);
        }
        let values = Sparse::from_rows(rows);
        let count = numbers.count as usize;
        let transposed = values.transposed(count);
        let functions = Functions { lattice, numbers };
        let mut free = BlockMatrix::new(count, d);
        (0..model.positions.len()).for_each(|node| free.reserve(row_of(&values, node).0));
        functions.add_stiffness(model, at_rest.most, &mut free);
        add_springs(model, &values, &mut free);
        add_to_nodes(&at_rest.diagonal, &values, FLOOR, &mut free);
        stiffen_tails(&at_rest.diagonal, &values, &mut free);
        CoarseSpace {
            values: [values, transposed],
            free,
            cholesky: None,
            scratch: Scratch::default(),
        }
    }

    /// Factors A₀ with some displacements held and `shift` times the stiffness of every
    /// node added.
    pub fn factor(&mut self, at_rest: &Stiffness, held: &[Held], shift: f64) {
        let mut matrix = self.free.clone();
        for Held { node, along, stiffness } in held {
            let (columns, values) = row_of(&self.values[0], *node as usize);
            matrix.add_spring(columns, values, along, *stiffness);
        }
        if shift > 0.0 {
            add_to_nodes(&at_rest.diagonal, &self.values[0], shift, &mut matrix);
        }
        let matrix = matrix.assembled();
        let again = self.cholesky.as_mut().is_some_and(|cholesky| cholesky.factor_again(&matrix));
        if !again {
            self.cholesky = SparseCholesky::new(&matrix);
        }
    }

    /// P A₀⁻¹ Pᵀ r into `result`.
    pub fn apply(&mut self, components: usize, r: &[Padded], result: &mut Vec<Padded>) {
        result.resize(r.len(), [0.0; 4]);
        let Some(cholesky) = &self.cholesky else { return result.fill([0.0; 4]) };
        let mut moments = vec![[0.0; 4]; self.free.len()];
        self.values[1].product(r, &mut moments, Combine::Replace);
        let mut right = Vec::with_capacity(components * moments.len());
        unpad(&moments, components, &mut right);
        cholesky.solve(&mut right, &mut self.scratch);
        pad(&right, components, &mut moments);
        self.values[0].product(&moments, result, Combine::Replace);
    }
}

/// Adds a part of the stiffness of every node, lumped to the functions that reach it.
fn add_to_nodes(diagonal: &[f64], values: &Sparse, part: f64, matrix: &mut BlockMatrix) {
    for (node, stiffness) in diagonal.iter().enumerate() {
        let (columns, values) = row_of(values, node);
        for (&i, &value) in columns.iter().zip(values) {
            matrix.add_to_diagonal(i, part * stiffness * f64::from(value));
        }
    }
}

/// Adds the springs of the surface, lumped to nodes.
fn add_springs(model: &Model, values: &Sparse, matrix: &mut BlockMatrix) {
    for (node, springs) in model.following.lumped_springs() {
        let (columns, values) = row_of(values, node as usize);
        for (along, stiffness) in directions(&springs) {
            matrix.add_spring(columns, values, &along, stiffness);
        }
    }
}

/// Functions of which only a tail reaches the body may bend almost without a point that
/// sees it: their stiffness over Σ_a k_a N(X_a)² is raised to a part of the median.
fn stiffen_tails(diagonal: &[f64], values: &Sparse, matrix: &mut BlockMatrix) {
    let mut sums = vec![0.0; matrix.len()];
    for (node, stiffness) in diagonal.iter().enumerate() {
        let (columns, values) = row_of(values, node);
        for (&i, &value) in columns.iter().zip(values) {
            sums[i as usize] += stiffness * f64::from(value).powi(2);
        }
    }
    let ratios: Vec<f64> =
        (sums.iter().enumerate()).map(|(i, sum)| matrix.mean_diagonal(i as u32) / sum).collect();
    let mut sorted = ratios.clone();
    sorted.sort_by(f64::total_cmp);
    let least = TAIL * sorted[sorted.len() / 2];
    for ((i, sum), ratio) in sums.iter().enumerate().zip(&ratios) {
        if *ratio < least {
            matrix.add_to_diagonal(i as u32, (least - ratio) * sum);
        }
    }
}

fn row_of(matrix: &Sparse, row: usize) -> (&[u32], &[f32]) {
    let entries = matrix.starts[row]..matrix.starts[row + 1];
    (&matrix.columns[entries.clone()], &matrix.values[entries])
}

/// Numbers of the functions that reach a node.
struct Numbers {
    of: Vec<Option<u32>>,
    count: u32,
}

impl Numbers {
    fn number(&mut self, function: usize) -> u32 {
        *self.of[function].get_or_insert_with(|| {
            self.count += 1;
            self.count - 1
        })
    }
}

struct Functions {
    lattice: Lattice,
    numbers: Numbers,
}

impl Functions {
    /// The functions at X that reach a node, and their gradients \[1/m\].
    fn at(&self, X: &Vector3, found: &mut Vec<(u32, Vector3)>) {
        found.clear();
        let mut gradients = self.lattice.gradients(X);
        self.lattice.at(X).for_each(|function, _| {
            let gradient = gradients.next().unwrap_or_default();
            found.extend(self.numbers.of[function].map(|number| (number, gradient)));
        });
    }

    fn add_stiffness(&self, model: &Model, most: f64, matrix: &mut BlockMatrix) {
        let mut found = Vec::new();
        for block in &model.points.blocks {
            let moduli = ModuliAtRest::of(block).capped(most);
            for (weight, X) in self.lumps(model, block) {
                self.at(&X, &mut found);
                matrix.add_elastic(&found, weight * moduli.shear, weight * moduli.pointwise);
            }
            if moduli.projected > 0.0 {
                let mut stiffness = [[0.0; 4]; 4];
                (0..4).for_each(|b| stiffness[b][b] = moduli.projected);
                for chunk in &block.chunks {
                    let moments = self.patch_moments(model, block, chunk);
                    matrix.add_squares(&moments, &stiffness);
                }
            }
        }
    }

    /// Weights \[m³\] and centres \[m\] of the points of a block, a few for each cell.
    fn lumps(&self, model: &Model, block: &Block) -> Vec<(f64, Vector3)> {
        let mut lumps: BTreeMap<[u32; 3], (f64, Vector3)> = BTreeMap::new();
        for lane in block.occupied() {
            let (weight, X) =
                (block.quadrature_weights[lane], &model.point_positions[block.point(lane)]);
            let (sum, moment) = lumps.entry(self.lattice.subcell(X, LUMPS)).or_default();
            *sum += weight;
            *moment += weight * X;
        }
        lumps.into_values().map(|(weight, moment)| (weight, moment / weight)).collect()
    }

    /// Σ_q w_q B_b Grad N over the points of a patch for each function N and basis B_b.
    fn patch_moments(
        &self,
        model: &Model,
        block: &Block,
        chunk: &Chunk,
    ) -> Vec<(u32, [Vector3; 4])> {
        let mut moments: BTreeMap<u32, [Vector3; 4]> = BTreeMap::new();
        let Some(projection) = &block.projection else { return Vec::new() };
        let mut found = Vec::new();
        for lane in chunk.lanes.clone() {
            let factors = projection.basis_at(lane).map(|b| block.quadrature_weights[lane] * b);
            self.at(&model.point_positions[block.point(lane)], &mut found);
            for (number, gradient) in &found {
                let sums = moments.entry(*number).or_default();
                sums.iter_mut().zip(factors).for_each(|(sum, factor)| *sum += factor * gradient);
            }
        }
        moments.into_iter().collect()
    }
}
