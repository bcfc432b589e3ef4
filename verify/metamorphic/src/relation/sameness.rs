//! What must not change anything.

use super::subject::{Compared, Relation, Subject};
use crate::answer::{Answer, View, answer, observed};
use crate::build::solid;
use mtled::motion::observe;
use mtled::problem::Problem;
use mtled::{Continue, Observer, Shape, Vector3};

const EXACT: &str = "The same operations in the same order";

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "obstacle_out_of_reach",
        claim: "An obstacle that the body never comes near changes nothing",
        bound: 1e-6,
        reason: "No force comes from it; Newton's method may take the load in other parts, and \
                 ends at 1e-12 of the largest force, times a condition of up to 1e5",
        compare: |subject| {
            let mut other = subject.problem();
            let size = subject.scene.size;
            let point = Vector3::new(0.0, -7.0 * size, 0.0);
            let far = Shape::HalfSpace { point, normal: Vector3::y() };
            other.obstacles.push(solid("far", far));
            subject.with(other, &View::default())
        },
    },
    Relation {
        name: "again",
        claim: "The same problem twice has the same bits",
        bound: 0.0,
        reason: EXACT,
        compare: |subject| same_bits(subject, answer(subject.problem())),
    },
    Relation {
        name: "threads",
        claim: "One thread or three: the same bits",
        bound: 0.0,
        reason: "Sums are in an order of their own, whoever computes the summands",
        compare: |subject| {
            let on = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()?;
                let problem = subject.problem();
                Some(pool.install(|| answer(problem)))
            };
            let three = on(3)?;
            match on(1)? {
                Ok(one) => three.as_ref().ok().map(|three| bits(&one, three)),
                Err(_) => same_bits(subject, three),
            }
        },
    },
    Relation {
        name: "looked_at",
        claim: "Who looks at every step, its energies and its reactions changes nothing",
        bound: 0.0,
        reason: EXACT,
        compare: |subject| same_bits(subject, observed(subject.problem(), &mut Looks::default())),
    },
];

/// Looks at everything.
#[derive(Debug, Default)]
struct Looks {
    seen: f64,
}

impl Observer for Looks {
    fn observe(&mut self, view: &mut observe::View) -> Continue {
        self.seen += view.energies().kinetic;
        let forces = view.reactions(&Vector3::zeros());
        self.seen += forces.iter().map(|reaction| reaction.force.norm()).sum::<f64>();
        Continue::Yes
    }

    fn tracks_work(&self) -> bool {
        true
    }
}

fn same_bits(subject: &Subject, other: Result<Answer, mtled::Error>) -> Option<Compared> {
    Some(match other {
        Ok(other) => bits(&subject.base, &other),
        Err(error) => Compared::Refused(error.to_string()),
    })
}

/// Number of values that are not the same.
fn bits(first: &Answer, other: &Answer) -> Compared {
    let (u, v) = (&first.simulation.state.displacement, &other.simulation.state.displacement);
    let unlike = u.iter().zip(v).filter(|(u, v)| u.to_bits() != v.to_bits()).count();
    Compared::Difference((unlike + u.len().abs_diff(v.len())) as f64)
}

/// A problem with one thing changed.
pub(crate) fn changed(subject: &Subject, change: impl FnOnce(&mut Problem)) -> Problem {
    let mut problem = subject.problem();
    change(&mut problem);
    problem
}
