//! Faults of the solver that relations have found and that are still there. What is listed here
//! is not counted as a finding again, and is shown in every report.

use crate::relation::Relation;
use crate::scene::Scene;

/// A fault that is known.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// The relation that fails.
    pub relation: &'static str,
    /// Of what scenes, in words.
    pub scenes: &'static str,
    /// The same as a test.
    pub has: fn(&Scene) -> bool,
    /// The largest difference that was seen.
    pub figure: &'static str,
    /// Why.
    pub reason: &'static str,
}

/// Every known fault.
pub const KNOWN: &[Known] = &[];

/// The known fault by which a relation fails for a scene.
pub fn known(relation: &Relation, scene: &Scene) -> Option<&'static Known> {
    KNOWN.iter().find(|known| known.relation == relation.name && (known.has)(scene))
}
