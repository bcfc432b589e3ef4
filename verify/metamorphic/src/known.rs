//! Faults of the solver that relations have found and that are still there. What is listed here
//! is not counted as a finding again, and is shown in every report.

use crate::relation::Relation;
use crate::scene::{Form, Part, Scene};

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
        relation: "cloud_of_a_moved_body",
        scenes: "scenes with a part held on the surface that may end within a face",
        has: |scene| {
            scene.holds.iter().any(|hold| !hold.inner && may_end_within_a_face(&hold.part))
        },
        figure: "0.01",
        reason: "some nodes along the edge of what is held (`discretisation::nodes::held_edges`) hang on the \
                 last digit; on which choice there is not found yet",
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

fn may_end_within_a_face(part: &Part) -> bool {
    match part {
        Part::End { depth, .. } => *depth > 1e-3,
        Part::Spot { .. } => true,
        Part::Whole => false,
    }
}

/// The known fault by which a relation fails for a scene.
pub fn known(relation: &Relation, scene: &Scene) -> Option<&'static Known> {
    KNOWN.iter().find(|known| known.relation == relation.name && (known.has)(scene))
}
