//! Moduli and the diagonal of the stiffness at rest.

use crate::force::layout::{Block, GradientQuad, PackedPoints, with_gradients};

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

    /// With the projected one no more than `most` times μ.
    pub fn capped(self, most: f64) -> ModuliAtRest {
        ModuliAtRest { projected: self.projected.min(most * self.shear), ..self }
    }

    /// The part of the projected modulus that is no more than `most` μ; all of none \[–\].
    pub fn part_within(self, most: f64) -> f64 {
        (most * self.shear / self.projected).min(1.0)
    }
}

/// Diagonal of K at rest, the mean over the components of a node \[node\]
/// \[N/m\] (method book, eq. 13.3). A point adds w |Grad φ|² (μ + (λ − s U''(1) +
/// μ)/d), a patch s U''(1) Σ_b |Σ_q w B_b Grad φ|²/d, its modulus no more than `most` μ. Nodes
/// without points lie within held volumes: they get the mean of the others, which matters to no
/// result.
pub fn stiffness_diagonal(points: &PackedPoints, nodes: usize, most: f64) -> Vec<f64> {
    let mut diagonal = vec![0.0; nodes];
    for block in &points.blocks {
        // Chooses the precision in which gradients are stored.
        let local = with_gradients!(&block.grad_phi, gradients => match points.components {
            2 => block_diagonal::<_, 2>(block, gradients, most),
            _ => block_diagonal::<_, 3>(block, gradients, most),
        });
        for (&node, value) in block.nodes.iter().zip(local) {
            diagonal[node as usize] += value;
        }
    }
    let filled = diagonal.iter().filter(|value| **value != 0.0).count();
    if (1..nodes).contains(&filled) {
        let mean = diagonal.iter().sum::<f64>() / filled as f64;
        diagonal.iter_mut().filter(|value| **value == 0.0).for_each(|value| *value = mean);
    }
    diagonal
}

fn block_diagonal<G: GradientQuad, const D: usize>(
    block: &Block,
    grad_phi: &[G],
    most: f64,
) -> Vec<f64> {
    let ModuliAtRest { shear, pointwise, projected } = ModuliAtRest::of(block).capped(most);
    let modulus = shear + (pointwise + shear) / D as f64;
    let mut diagonal = vec![0.0; block.nodes.len()];
    for lane in block.occupied() {
        let factor = block.quadrature_weights[lane] * modulus;
        for (node, gradient) in block.support::<G, D>(grad_phi, lane) {
            diagonal[node] += factor * gradient.iter().map(|g| g * g).sum::<f64>();
        }
    }
    add_projected::<G, D>(block, grad_phi, projected / D as f64, &mut diagonal);
    diagonal
}

/// modulus · Σ_b |Σ_q w B_b Grad φ_a|² of every patch.
fn add_projected<G: GradientQuad, const D: usize>(
    block: &Block,
    grad_phi: &[G],
    modulus: f64,
    diagonal: &mut [f64],
) {
    let Some(projection) = &block.projection else { return };
    let mut moments = vec![[[0.0; D]; 4]; diagonal.len()];
    for patch in &block.chunks {
        for lane in patch.lanes.clone() {
            let basis = projection.basis_at(lane);
            for (node, gradient) in block.support::<G, D>(grad_phi, lane) {
                for (moment, basis) in moments[node].iter_mut().zip(basis) {
                    let factor = block.quadrature_weights[lane] * basis;
                    moment.iter_mut().zip(gradient).for_each(|(m, g)| *m += factor * g);
                }
            }
        }
        for lane in patch.lanes.clone() {
            for (node, _) in block.support::<G, D>(grad_phi, lane) {
                // Reset, so that a node in several supports is counted once.
                let moment = std::mem::replace(&mut moments[node], [[0.0; D]; 4]);
                let square: f64 = moment.iter().flatten().map(|m| m * m).sum();
                diagonal[node] += modulus * square;
            }
        }
    }
}
