//! The diagonal of the stiffness at rest.

use crate::model::blocks::{Block, Held, with_stored};

/// Diagonal of K at rest, the mean over the components of a node \[node\]
/// \[N/m\]. A point adds w |Grad φ|² (μ + (λ + μ)/d) with λ less what is
/// projected; a patch adds s U''(1) Σ_b |Σ_q w B_b Grad φ|²/d.
pub fn stiffness_diagonal(blocks: &[Block], components: usize, nodes: usize) -> Vec<f64> {
    let mut diagonal = vec![0.0; nodes];
    for block in blocks {
        let local = with_stored!(&block.grad_phi, held => match components {
            2 => block_diagonal::<_, 2>(block, held),
            _ => block_diagonal::<_, 3>(block, held),
        });
        for (&node, value) in block.nodes.iter().zip(local) {
            diagonal[node as usize] += value;
        }
    }
    diagonal
}

fn block_diagonal<G: Held, const D: usize>(block: &Block, grad_phi: &[G]) -> Vec<f64> {
    let constants = block.law.constants();
    let shear = constants.shear_modulus;
    // U'' at rest as a difference; U is smooth there.
    let bulk = (block.law.bulk_slope(1.0 + 1e-6) - block.law.bulk_slope(1.0 - 1e-6)) / 2e-6;
    let projected = block.projection.as_ref().map_or(0.0, |projection| projection.share * bulk);
    let pointwise = constants.lame_modulus() - projected;
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
fn add_projected<G: Held, const D: usize>(
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
            let eight = &projection.eights[patch.eights.start + i / 8];
            for (&node, gradient) in nodes.iter().zip(gradients) {
                for (moment, basis) in moments[node as usize].iter_mut().zip(&eight.basis) {
                    let factor = block.quadrature_weights[point] * basis.0[i % 8];
                    let gradient = gradient.map(Into::into);
                    moment.iter_mut().zip(gradient).for_each(|(m, g): (_, f64)| *m += factor * g);
                }
            }
        }
        for point in patch.points {
            for &node in block.support::<G, D>(grad_phi, point).0 {
                // Taken once: a node that comes again finds nothing.
                let taken = std::mem::replace(&mut moments[node as usize], [[0.0; D]; 4]);
                let square: f64 = taken.iter().flatten().map(|m| m * m).sum();
                diagonal[node as usize] += modulus * square;
            }
        }
    }
}
