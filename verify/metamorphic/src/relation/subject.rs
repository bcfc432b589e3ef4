//! A relation, and the scene and answer that it is held against.
#![allow(non_snake_case)]

use crate::answer::{Answer, View, answer, difference, steady};
use crate::build::{self, Frame};
use crate::scene::Scene;
use mtled::problem::{Cloud, Gradients, Loads, Motion, Problem};
use mtled::{Discretisation, Vector3};
use std::cell::OnceCell;

/// Something that must hold of any scene of its kind.
#[derive(Debug, Clone, Copy)]
pub struct Relation {
    /// Its name.
    pub name: &'static str,
    /// What it says.
    pub claim: &'static str,
    /// The largest difference that it allows \[–\].
    pub bound: f64,
    /// Why so much.
    pub reason: &'static str,
    /// What is compared; `None` where it says nothing about the scene.
    pub compare: fn(&Subject) -> Option<Compared>,
}

/// What came of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub enum Compared {
    /// Largest difference over the largest value \[–\].
    Difference(f64),
    /// The other problem was refused, or has no solution.
    Refused(String),
    /// It proves nothing here.
    Undecided(String),
}

/// A scene and its answer.
#[derive(Debug)]
pub struct Subject {
    /// The scene.
    pub scene: Scene,
    /// Its answer.
    pub base: Answer,
    given: OnceCell<Option<Answer>>,
}

/// Of steps that are the same in two motions \[–\].
const PART_OF_CRITICAL: f64 = 0.5;
/// Displacements below this fraction of the size are no answer to compare with \[–\].
const NOTHING: f64 = 1e-9;

impl Subject {
    /// A scene that has an answer of which relations say something.
    pub(crate) fn new(scene: &Scene) -> Result<Subject, String> {
        let problem = build::problem(scene).map_err(|error| error.to_string())?;
        let base = answer(problem).map_err(|error| error.to_string())?;
        if base.is_doubtful() {
            return Err("unstable, or nearly without volume somewhere".into());
        }
        if base.is_loose() {
            return Err("nothing holds it, so that it is at rest in many places".into());
        }
        if base.largest() < NOTHING * scene.size {
            return Err("nothing moves".into());
        }
        Ok(Subject { scene: scene.clone(), base, given: OnceCell::new() })
    }

    /// Nodes of the body without conditions: others lie on the edges of held parts, where
    /// round-off would choose whether they are held.
    fn free_nodes(&self) -> Option<Vec<Vector3>> {
        let mut free = self.problem();
        free.conditions.clear();
        free.loads = Loads::default();
        free.recipe.gradients = Gradients::Plain;
        Some(Discretisation::new(&free).ok()?.cloud.positions)
    }

    /// The problem of the scene.
    pub(crate) fn problem(&self) -> Problem {
        self.base.problem.clone()
    }

    /// The same with the nodes given one by one.
    pub(crate) fn given(&self) -> Option<&Answer> {
        let made = || {
            let given = with_nodes(self.problem(), self.free_nodes()?);
            answer(given).ok().filter(|answer| !answer.is_doubtful() && !answer.is_loose())
        };
        self.given.get_or_init(made).as_ref()
    }

    /// Compares the first answer with that to another problem.
    pub(crate) fn with(&self, other: Problem, view: &View) -> Option<Compared> {
        Some(against(&self.base, other, view))
    }

    /// Compares the answer on given nodes with that to another problem on the same.
    pub(crate) fn given_with(&self, mut other: Problem, view: &View) -> Option<Compared> {
        let given = self.given()?;
        if !matches!(other.recipe.cloud, Cloud::Given { .. }) {
            other.recipe.cloud = given.problem.recipe.cloud.clone();
        }
        Some(against(given, other, view))
    }

    /// As [`Subject::given_with`], motions in steps of one length: the critical step is iterated from
    /// random nodal values, which go with the number of a node and do not turn with the body, and
    /// of contact another step makes another motion.
    pub(crate) fn stepped_with(&self, mut other: Problem, view: &View) -> Option<Compared> {
        let given = self.given()?;
        if self.scene.is_static() {
            return self.given_with(other, view);
        }
        let fixed = Some(PART_OF_CRITICAL * given.summary.critical_time_step);
        let mut own = given.problem.clone();
        for motion in [&mut own.motion, &mut other.motion] {
            if let Motion::Dynamic { step, .. } = motion {
                step.fixed = fixed;
            }
        }
        let own = steady(own)?;
        Some(against(&own, other, view))
    }

    /// The problem in another frame with the same nodes, and how its answer is to be seen.
    pub(crate) fn in_frame(&self, frame: &Frame) -> Option<(Problem, View)> {
        let home = Frame::home(&self.scene);
        let moved = build::problem_in(&self.scene, frame).ok()?;
        let nodes = self.given()?.positions().iter();
        let nodes: Vec<Vector3> = nodes.map(|X| frame.point(&home.home_of(X))).collect();
        let about = [home, *frame].map(|frame| frame.point(&frame.middle()));
        Some((with_nodes(moved, nodes), View { turn: frame.turn, about, ..View::default() }))
    }
}

/// A problem whose nodes are given one by one.
pub(crate) fn with_nodes(mut problem: Problem, nodes: Vec<Vector3>) -> Problem {
    problem.recipe.cloud = Cloud::Given { nodes };
    problem
}

/// Compares an answer with that to another problem.
pub(crate) fn against(base: &Answer, other: Problem, view: &View) -> Compared {
    match answer(other) {
        Err(error) => Compared::Refused(error.to_string()),
        Ok(other) if other.is_doubtful() => {
            Compared::Undecided("the other is unstable, or nearly without volume somewhere".into())
        }
        Ok(other) => Compared::Difference(difference(base, &other, view)),
    }
}
