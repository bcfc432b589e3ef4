//! The diagonal of the stiffness at rest.

use crate::algebra::lanes::LANES;
use crate::model::blocks::{Block, StoredNumber, with_gradients};

/// The moduli of a block at rest \[Pa\].
#[derive(Debug, Clone, Copy)]
pub struct ModuliAtRest {
    /// μ
    pub shear: f64,
    /// λ − s U''(1), which acts at every point.
    pub pointwise: f64,
    /// s U''(1), which acts on J projected on patches.
    pub projected: f64,
}

impl ModuliAtRest {
    /// Of a block of quadrature points.
    pub fn of(block: &Block) -> ModuliAtRest {
        let constants = block.law.constants();
        // U'' at rest as a difference; U is smooth there.
        let bulk = (block.law.bulk_slope(1.0 + 1e-6) - block.law.bulk_slope(1.0 - 1e-6)) / 2e-6;
        let projected =
            block.projection.as_ref().map_or(0.0, |projection| projection.fraction * bulk);
        let pointwise = constants.lame_modulus() - projected;
        ModuliAtRest { shear: constants.shear_modulus, pointwise, projected }
    }
}

/// Diagonal of K at rest, the mean over the components of a node \[node\]
/// \[N/m\] (method book, eq. 13.3). A point adds w |Grad φ|² (μ + (λ − s U''(1) +
/// μ)/d), a patch s U''(1) Σ_b |Σ_q w B_b Grad φ|²/d.
pub fn stiffness_diagonal(blocks: &[Block], components: usize, nodes: usize) -> Vec<f64> {
    let mut diagonal = vec![0.0; nodes];
    for block in blocks {
        let local = with_gradients!(&block.grad_phi, gradients => match components {
            2 => block_diagonal::<_, 2>(block, gradients),
            _ => block_diagonal::<_, 3>(block, gradients),
        });
        for (&node, value) in block.nodes.iter().zip(local) {
            diagonal[node as usize] += value;
        }
    }
    diagonal
}

fn block_diagonal<G: StoredNumber, const D: usize>(block: &Block, grad_phi: &[G]) -> Vec<f64> {
    let ModuliAtRest { shear, pointwise, projected } = ModuliAtRest::of(block);
    let modulus = shear + (pointwise + shear) / D as f64;
    let mut diagonal = vec![0.0; block.nodes.len()];
    for (point, weight) in block.quadrature_weights.iter().enumerate() {
        let (nodes, gradients) = block.support::<G, D>(grad_phi, point);
        for (&node, gradient) in nodes.iter().zip(gradients) {
            let square: f64 = gradient.map(Into::into).iter().map(|g| g * g).sum();
            diagonal[node as usize] += weight * modulus * square;
        }
    }
    add_projected::<G, D>(block, grad_phi, projected / D as f64, &mut diagonal);
    diagonal
}

/// modulus · Σ_b |Σ_q w B_b Grad φ_a|² of every patch.
fn add_projected<G: StoredNumber, const D: usize>(
    block: &Block,
    grad_phi: &[G],
    modulus: f64,
    diagonal: &mut [f64],
) {
    let Some(projection) = &block.projection else { return };
    let mut moments = vec![[[0.0; D]; 4]; diagonal.len()];
    for patch in block.chunks() {
        for (i, point) in patch.points.clone().enumerate() {
            let (nodes, gradients) = block.support::<G, D>(grad_phi, point);
            let block_of_points = &projection.blocks[patch.groups.start + i / LANES];
            for (&node, gradient) in nodes.iter().zip(gradients) {
                for (moment, basis) in moments[node as usize].iter_mut().zip(&block_of_points.basis)
                {
                    let factor = block.quadrature_weights[point] * basis.0[i % LANES];
                    let gradient = gradient.map(Into::into);
                    moment.iter_mut().zip(gradient).for_each(|(m, g): (_, f64)| *m += factor * g);
                }
            }
        }
        for point in patch.points {
            for &node in block.support::<G, D>(grad_phi, point).0 {
                // Reset, so that a node in several supports is counted once.
                let moment = std::mem::replace(&mut moments[node as usize], [[0.0; D]; 4]);
                let square: f64 = moment.iter().flatten().map(|m| m * m).sum();
                diagonal[node as usize] += modulus * square;
            }
        }
    }
}
