//! From a problem to its discretisation and model.

use mtled::algebra::tensor::Vector3;
use mtled::discretisation::{Discretisation, Warning};
use mtled::error::Error;
use mtled::model::Model;
use mtled::model::contact::ContactSurface;
use mtled::model::rigid_motions::{free_pieces, free_rigid_motions};
use mtled::model::zero_energy::refuse_zero_energy_modes;
use mtled::motion::mass_scaling::raise_masses;
use mtled::motion::state::State;
use mtled::problem::{Motion, Problem};
use std::sync::OnceLock;
use std::time::Instant;

/// A problem that has been discretised.
#[derive(Debug)]
pub struct Prepared {
    /// Nodes, supports and quadrature points.
    pub discretisation: Discretisation,
    /// Masses, conditions, loads and contact.
    pub model: Model,
    /// Wall time of the set-up \[s\].
    pub setup_seconds: f64,
    contact_surface: OnceLock<ContactSurface>,
    /// From which a motion goes on, where it does not begin at rest.
    pub start: Option<State>,
}

impl Prepared {
    /// What was discretised in `setup_seconds` \[s\].
    pub fn new(discretisation: Discretisation, model: Model, setup_seconds: f64) -> Prepared {
        Prepared {
            discretisation,
            model,
            setup_seconds,
            contact_surface: OnceLock::new(),
            start: None,
        }
    }

    /// What contact pressures are found with, made when first wanted; nothing without obstacles.
    pub fn contact_surface(&self, problem: &Problem) -> Result<Option<&ContactSurface>, Error> {
        if problem.obstacles.is_empty() {
            return Ok(None);
        }
        if let Some(surface) = self.contact_surface.get() {
            return Ok(Some(surface));
        }
        let surface = ContactSurface::new(problem, &self.discretisation)?;
        Ok(Some(self.contact_surface.get_or_init(|| surface)))
    }

    /// Reasons to doubt a result before it is there.
    pub fn doubts(&self, problem: &Problem) -> Vec<String> {
        let mut doubts: Vec<String> =
            self.discretisation.warnings().iter().map(Warning::to_string).collect();
        doubts.extend(self.model.warnings.iter().map(Warning::to_string));
        doubts.extend(self.not_held(problem).or_else(|| self.free_pieces(problem)));
        doubts
    }

    /// Separate pieces that nothing holds in a static problem without obstacles.
    fn free_pieces(&self, problem: &Problem) -> Option<String> {
        let model = &self.model;
        let is_dynamic = matches!(problem.motion, Motion::Dynamic { .. });
        if is_dynamic || !model.contact.obstacles.is_empty() {
            return None;
        }
        let free = free_pieces(model, problem.motion.end());
        let pieces: Vec<(Vector3, f64)> = free.iter().map(|piece| self.piece(piece.body)).collect();
        let largest = pieces.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let (at, volume) = largest;
        let which = match pieces.len() {
            1 => "a separate piece of the body".to_string(),
            several => format!("{several} separate pieces of the body, the largest"),
        };
        Some(format!(
            "{which} of {volume:.3e} m³ around ({:.4}, {:.4}, {:.4}) can move without resistance, since no condition holds \
             it enough: under loads on it a static problem has no solution; hold it, leave it out of \
             the body, or close the gap around it",
            at.x, at.y, at.z
        ))
    }

    /// Centre \[m\] and volume \[m³\] of a separate piece.
    fn piece(&self, body: u32) -> (Vector3, f64) {
        let Discretisation { quadrature, supports, .. } = &self.discretisation;
        let own = |q: &usize| {
            let first = supports.nodes[supports.starts[*q]];
            self.model.bodies[first as usize] == body
        };
        let (mut moment, mut volume) = (Vector3::zeros(), 0.0);
        for q in (0..supports.len()).filter(own) {
            moment += quadrature.weights[q] * quadrature.positions[q];
            volume += quadrature.weights[q];
        }
        (moment / volume.max(f64::MIN_POSITIVE), volume)
    }

    /// What leaves a static problem without a single solution.
    fn not_held(&self, problem: &Problem) -> Option<String> {
        if matches!(problem.motion, Motion::Dynamic { .. }) {
            return None;
        }
        let (model, load_end) = (&self.model, problem.motion.end());
        let free = match free_rigid_motions(model, load_end, &vec![0.0; model.size()]) {
            0 => return None,
            1 => "a rigid motion".to_string(),
            several => format!("{several} rigid motions"),
        };
        let consequence = if model.contact.obstacles.is_empty() {
            "the result is one of many that differ by such a motion"
        } else {
            "only contact that closes during the run can hold it, and without friction that may \
                 not be enough to converge"
        };
        Some(format!(
            "the conditions, and contacts that are closed at the start, leave {free} of the body \
             free in a static problem: {consequence}"
        ))
    }
}

/// Discretises a problem and builds its model.
pub fn prepare(problem: &Problem) -> Result<Prepared, Error> {
    let start = Instant::now();
    let discretisation = Discretisation::new(problem)?;
    let model = raise_masses(Model::new(problem, &discretisation)?, problem, &discretisation)?;
    Ok(Prepared::new(discretisation, model, start.elapsed().as_secs_f64()))
}

/// As [`prepare`]; a recipe that leaves zero-energy modes is refused.
pub fn prepare_to_run(problem: &Problem) -> Result<Prepared, Error> {
    let prepared = prepare(problem)?;
    refuse_zero_energy_modes(problem, &prepared.discretisation, &prepared.model)?;
    Ok(prepared)
}
