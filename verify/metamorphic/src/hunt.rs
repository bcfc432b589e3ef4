//! All relations on scene after scene, and the smallest scene that shows a fault.

use crate::known::known;
use crate::relation::{Compared, Relation, Subject, all};
use crate::scene::Scene;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a relation says of a scene.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// The relation.
    pub relation: &'static Relation,
    /// What came of it; `None` where it says nothing about the scene.
    pub compared: Option<Compared>,
    /// Whether it fails by a fault that is known.
    pub known: bool,
}

impl Verdict {
    /// Whether the relation does not hold.
    pub fn is_broken(&self) -> bool {
        match &self.compared {
            Some(Compared::Difference(d)) => d.is_nan() || *d > self.relation.bound,
            Some(Compared::Refused(_)) => true,
            Some(Compared::Undecided(_)) | None => false,
        }
    }

    /// Whether it does not hold, and nobody knew.
    pub fn is_finding(&self) -> bool {
        self.is_broken() && !self.known
    }

    /// In a word.
    pub fn text(&self) -> String {
        match &self.compared {
            Some(Compared::Difference(d)) => {
                format!("differs by {d:.2e}, allowed {:.0e}", self.relation.bound)
            }
            Some(Compared::Refused(why)) => format!("the other is refused: {why}"),
            Some(Compared::Undecided(why)) => format!("undecided: {why}"),
            None => "says nothing".into(),
        }
    }
}

/// What all relations say of a scene, or why it has no answer.
pub fn examine(scene: &Scene, chosen: &dyn Fn(&Relation) -> bool) -> Result<Vec<Verdict>, String> {
    let subject = Subject::new(scene)?;
    Ok(all()
        .filter(|relation| chosen(relation))
        .map(|relation| {
            let compared = (relation.compare)(&subject);
            let known = match &compared {
                Some(Compared::Difference(d)) => known(relation, scene, *d).is_some(),
                _ => false,
            };
            Verdict { relation, compared, known }
        })
        .collect())
}

/// Most scenes that are tried on the way to a smaller one.
const MOST_TRIED: usize = 400;

/// The smallest scene found for which the relation is broken in the same way.
pub fn smallest(scene: &Scene, verdict: &Verdict) -> Scene {
    let refused = matches!(verdict.compared, Some(Compared::Refused(_)));
    let fails = |scene: &Scene| {
        let examined = catch_unwind(AssertUnwindSafe(|| {
            examine(scene, &|relation| relation.name == verdict.relation.name)
        }));
        let Ok(Ok(verdicts)) = examined else { return false };
        verdicts.iter().any(|verdict| {
            verdict.is_finding()
                && refused == matches!(verdict.compared, Some(Compared::Refused(_)))
        })
    };
    let (mut best, mut tried) = (scene.clone(), 0);
    'smaller: loop {
        for next in best.smaller() {
            tried += 1;
            if tried > MOST_TRIED {
                return best;
            }
            if fails(&next) {
                best = next;
                continue 'smaller;
            }
        }
        return best;
    }
}
