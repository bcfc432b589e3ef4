//! What leaves a static problem without a single solution.

use crate::algebra::tensor::Vector3;
use crate::discretisation::{Discretisation, Warning};
use crate::model::Model;
use crate::model::rigid_motions::{free_pieces, free_rigid_motions};
use crate::problem::{Motion, Problem};

/// The rigid motions that nothing prevents of a static problem, or else its pieces that can move.
pub(crate) fn unheld(
    problem: &Problem,
    discretisation: &Discretisation,
    model: &Model,
) -> Option<Warning> {
    if matches!(problem.motion, Motion::Dynamic { .. }) {
        return None;
    }
    let load_end = problem.motion.end();
    let touches = !model.contact.obstacles.is_empty();
    match free_rigid_motions(model, load_end, &vec![0.0; model.size()]) {
        0 if touches => None,
        0 => unheld_pieces(discretisation, model, load_end),
        motions => Some(Warning::FreeMotions { motions, touches }),
    }
}

/// The pieces of a body of several that can move without resistance.
fn unheld_pieces(discretisation: &Discretisation, model: &Model, load_end: f64) -> Option<Warning> {
    let free = free_pieces(model, load_end);
    let pieces: Vec<(Vector3, f64)> =
        free.iter().map(|piece| centre_and_volume(discretisation, model, piece.body)).collect();
    let &(centre, volume) = pieces.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Warning::FreePieces { pieces: pieces.len(), centre, volume })
}

/// Centre \[m\] and volume \[m³\] of a separate piece.
fn centre_and_volume(discretisation: &Discretisation, model: &Model, body: u32) -> (Vector3, f64) {
    let Discretisation { quadrature, supports, .. } = discretisation;
    let own = |q: &usize| model.bodies[supports.nodes[supports.starts[*q]] as usize] == body;
    let (mut moment, mut volume) = (Vector3::zeros(), 0.0);
    for q in (0..supports.len()).filter(own) {
        moment += quadrature.weights[q] * quadrature.positions[q];
        volume += quadrature.weights[q];
    }
    (moment / volume.max(f64::MIN_POSITIVE), volume)
}
