//! Faults of the solver that relations have found and that are still there. What is listed here
//! is not counted as a finding again, and is shown in every report.

use crate::relation::Relation;
use crate::scene::{Form, Scene};

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
pub const KNOWN: &[Known] = &[
    Known {
        relation: "united_with_itself",
        scenes: "label maps, and unions and intersections with curved members",
        has: |scene| matches!(scene.form, Form::Voxels | Form::Dome | Form::Rounded),
        figure: "0.8",
        reason: "of coinciding faces that are not flat each member keeps about a half, by a distance \
                 that is round-off or that of marching cubes (`geometry::boundary::composite`)",
    },
    Known {
        relation: "one_material_in_two_regions",
        scenes: "boxes with a bore, whose walls are a seventh of a spacing thick",
        has: |scene| scene.form == Form::Bored,
        figure: "0.7",
        reason: "the wall is one point thick or two, as the border has it; the cloud cannot say \
                 which is right",
    },
    Known {
        relation: "prescribed_values_are_taken",
        scenes: "motions with an obstacle beside what is held",
        has: |scene| !scene.is_static() && scene.obstacle.is_some(),
        figure: "0.002",
        reason: "obstacles push nodes after conditions were imposed, and the value at a held node \
                 is a mean over its neighbours; the audit doubts the run where it matters",
    },
];

/// The known fault by which a relation fails for a scene.
pub fn known(relation: &Relation, scene: &Scene) -> Option<&'static Known> {
    KNOWN.iter().find(|known| known.relation == relation.name && (known.has)(scene))
}
