//! The answer to a problem, and the difference between two of them.

use mtled::algebra::tensor::Matrix3;
use mtled::error::Error;
use mtled::model::essential::Reaction;
use mtled::model::rigid_motions::free_rigid_motions;
use mtled::motion::summary::Summary;
use mtled::problem::{Motion, Problem};
use mtled::{Observer, Simulation, Unobserved, Vector3};

/// A solved problem.
#[derive(Debug)]
pub struct Answer {
    /// What was asked.
    pub problem: Problem,
    /// Discretisation, model and last state.
    pub simulation: Simulation,
    /// How it ended.
    pub summary: Summary,
}

/// Solves a problem.
pub(crate) fn answer(problem: Problem) -> Result<Answer, Error> {
    observed(problem, &mut Unobserved)
}

/// The answer to a problem, if it has a stable one.
pub(crate) fn steady(problem: Problem) -> Option<Answer> {
    answer(problem).ok().filter(|answer| !answer.is_doubtful())
}

/// Solves a problem that somebody looks at.
pub(crate) fn observed(problem: Problem, observer: &mut dyn Observer) -> Result<Answer, Error> {
    let simulation = Simulation::new(&problem)?;
    finished(problem, simulation, observer)
}

/// Solves a problem that is set up.
pub(crate) fn finished(
    problem: Problem,
    mut simulation: Simulation,
    observer: &mut dyn Observer,
) -> Result<Answer, Error> {
    let summary = simulation.run(observer)?;
    Ok(Answer { problem, simulation, summary })
}

impl Answer {
    /// Reference positions \[node\] \[m\].
    pub(crate) fn positions(&self) -> &[Vector3] {
        &self.simulation.model.positions
    }

    /// Nodal parameters \[node\] \[m\].
    pub(crate) fn displacements(&self) -> Vec<Vector3> {
        let d = self.simulation.model.components;
        (0..self.positions().len())
            .map(|node| self.simulation.state.displacement_of(node, d))
            .collect()
    }

    /// Force and moment of each condition about a place \[m\].
    pub(crate) fn reactions(&self, about: &Vector3) -> Vec<Reaction> {
        self.simulation.reactions(about)
    }

    /// Largest displacement \[m\].
    pub(crate) fn largest(&self) -> f64 {
        self.displacements().iter().map(Vector3::norm).fold(0.0, f64::max)
    }

    /// Whether the equilibrium may be one of several, as where a body buckles.
    pub(crate) fn is_doubtful(&self) -> bool {
        self.summary.instability.is_some()
            || self.summary.smallest_jacobian.jacobian < SMALLEST_JACOBIAN
            || self.simulation.state.displacement.iter().any(|u| !u.is_finite())
    }
}

impl Answer {
    /// Whether it is at rest and could be so after a rigid motion too.
    pub(crate) fn is_loose(&self) -> bool {
        let Simulation { model, state, .. } = &self.simulation;
        let at_rest = !matches!(self.problem.motion, Motion::Dynamic { .. });
        let end = self.problem.motion.end();
        at_rest && free_rigid_motions(model, end, &state.displacement) > 0
    }
}

/// Where points have so little of their volume left, other equilibria are near \[–\].
const SMALLEST_JACOBIAN: f64 = 0.3;

/// How another answer is to be seen, so that it is the same: it is of the first one turned,
/// grown, and with other numbers of nodes.
#[derive(Debug, Clone)]
pub struct View {
    /// Rotation or mirror image.
    pub turn: Matrix3,
    /// Lengths over those of the first \[–\].
    pub length: f64,
    /// Forces over those of the first \[–\].
    pub force: f64,
    /// Where moments are taken in the first and the other \[m\].
    pub about: [Vector3; 2],
    /// The other's number of each node of the first; `None` where they are the same.
    pub nodes: Option<Vec<usize>>,
    /// Whether each condition has its own force: where several hold a node, the first has it.
    pub each_reaction: bool,
}

impl Default for View {
    fn default() -> Self {
        View {
            turn: Matrix3::identity(),
            length: 1.0,
            force: 1.0,
            about: [Vector3::zeros(); 2],
            nodes: None,
            each_reaction: true,
        }
    }
}

/// Largest difference of nodal displacements over the largest displacement, and of forces and
/// moments over the largest force \[–\]; NaN is not hidden.
pub fn difference(first: &Answer, other: &Answer, view: &View) -> f64 {
    let (u, v) = (first.displacements(), other.displacements());
    if u.len() != v.len() {
        return f64::INFINITY;
    }
    let back = view.turn.transpose() / view.length;
    let number = |node: usize| view.nodes.as_ref().map_or(node, |nodes| nodes[node]);
    let seen: Vec<Vector3> = (0..u.len()).map(|node| back * v[number(node)]).collect();
    let displacements = relative(&u, &seen, 0.0);
    let reactions = reaction_difference(first, other, view);
    if displacements.is_nan() || displacements > reactions { displacements } else { reactions }
}

/// max |a − b| over the largest of both, or over a `floor` \[–\]; 0 where all is 0.
pub(crate) fn relative(a: &[Vector3], b: &[Vector3], floor: f64) -> f64 {
    let size = a.iter().chain(b).map(Vector3::norm).fold(floor, f64::max);
    let mut largest = 0.0;
    for (a, b) in a.iter().zip(b) {
        let difference = (a - b).norm();
        if difference.is_nan() {
            return f64::NAN;
        }
        largest = f64::max(largest, difference);
    }
    if size == 0.0 { largest } else { largest / size }
}

/// Largest difference of forces and moments of conditions over the largest force \[–\].
pub(crate) fn reaction_difference(first: &Answer, other: &Answer, view: &View) -> f64 {
    let [mut own, mut others] = [first.reactions(&view.about[0]), other.reactions(&view.about[1])];
    if own.len() != others.len() {
        return f64::INFINITY;
    }
    if !view.each_reaction {
        (own, others) = (vec![sum(&own)], vec![sum(&others)]);
    }
    let back = view.turn.transpose() / view.force;
    let forces: Vec<Vector3> = own.iter().map(|r| r.force).collect();
    let seen: Vec<Vector3> = others.iter().map(|r| back * r.force).collect();
    // A moment is an axial vector.
    let back = back * view.turn.determinant() / view.length;
    let moments: Vec<Vector3> = own.iter().map(|r| r.moment).collect();
    let seen_moments: Vec<Vector3> = others.iter().map(|r| back * r.moment).collect();
    let floor = force_scale(first);
    let moments = relative(&moments, &seen_moments, floor * first.simulation.model.extent);
    f64::max(relative(&forces, &seen, floor), moments)
}

/// Sum of reactions.
pub(crate) fn sum(reactions: &[Reaction]) -> Reaction {
    let mut sum = Reaction::default();
    for reaction in reactions {
        sum.force += reaction.force;
        sum.moment += reaction.moment;
        sum.sizes += reaction.sizes;
    }
    sum
}

/// A force that is not small in an answer \[N\]: the largest nodal stiffness times the largest
/// displacement, or the largest nodal load.
pub(crate) fn force_scale(answer: &Answer) -> f64 {
    let model = &answer.simulation.model;
    let stiffness = model.stiffness.iter().copied().fold(0.0, f64::max);
    let loads = model.loads.iter().flat_map(|load| &load.force).fold(0.0, |a, b| b.abs().max(a));
    f64::max(0.1 * stiffness * answer.largest(), loads)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::problem;
    use crate::scene::{
        Basis, Cloud, Drift, Form, Gradients, Hold, Inclusion, Law, Part, Piece, Place, Rubs,
        Scene, Wall, Way,
    };
    use mtled::problem::Newton;

    /// A cylinder whose stiff core and upper end a moving wall pushes aside until it buckles: contacts of
    /// the unstable state are left with the forces of others once its way to a stable one fails.
    fn pushed_cylinder() -> Scene {
        let end = |upper, depth| Part::End { axis: 2, upper, depth };
        let hold = |part, to| Hold { part, inner: false, to, release: None };
        Scene {
            size: 1300.0,
            young_modulus: 1e7,
            poisson_ratio: 0.499,
            density: 1.0,
            law: Law::StVenantKirchhoff,
            form: Form::Cylinder,
            edges: [1.0, 0.8, 0.8],
            thickness: None,
            spacings: 3,
            cloud: Cloud::Lattice,
            seed: 168,
            basis: Basis::Linear,
            gradients: Gradients::Plain,
            direct: false,
            even_mass: false,
            projected: true,
            way: Way::Newton,
            inclusion: Some(Inclusion { axis: 1, stiffness: 3.0, piece: Piece::Ball(0.23) }),
            obstacle: Some(Wall {
                round: true,
                gap: 0.05,
                drift: Some(Drift { by: [0.038, 0.063, 0.0], turn: 0.0 }),
                rubs: Rubs::Free,
            }),
            holds: vec![
                hold(end(false, 0.348), Place::Still),
                hold(end(true, 0.19), Place::Roller(1)),
            ],
            pushes: Vec::new(),
            bed: None,
            filling: None,
            memory: None,
            tension: None,
        }
    }

    #[test]
    fn a_body_that_buckles_under_a_moving_wall_ends_in_words() {
        let mut problem = problem(&pushed_cylinder()).unwrap();
        let load_end = problem.motion.end();
        problem.motion = Motion::Newton(Newton { load_end, ..Newton::default() });
        let why = answer(problem).unwrap_err().to_string();
        assert!(why.contains("no equilibrium beyond"), "{why}");
    }
}
