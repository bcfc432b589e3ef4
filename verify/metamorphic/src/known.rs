//! Faults of the solver that relations have found and that are still there. What is listed here
//! is not counted as a finding again, and is shown in every report.

use crate::relation::Relation;
use crate::scene::{Form, Gradients, Part, Push, Scene};

/// A fault that is known.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// The relations that fail.
    pub relations: &'static [&'static str],
    /// Of what scenes, in words.
    pub scenes: &'static str,
    /// The same as a test.
    pub has: fn(&Scene) -> bool,
    /// The largest difference that is excused \[–\].
    pub largest: f64,
    /// Why.
    pub reason: &'static str,
}

/// Of problems that differ by round-off only.
const PIECES: &[&str] = &[
    "translated",
    "a_hair_larger",
    "lengths_times_thousand",
    "order_of_regions",
    "order_of_members",
];

/// Every known fault.
pub const KNOWN: &[Known] = &[
    Known {
        relations: &["united_with_itself"],
        scenes: "label maps, and unions and intersections with curved members",
        has: |scene| matches!(scene.form, Form::Voxels | Form::Dome | Form::Rounded),
        largest: 1.0,
        reason: "of coinciding faces that are not flat each member keeps about a half, by a distance \
                 that is round-off or that of marching cubes (`geometry::boundary::composite`)",
    },
    Known {
        relations: &["one_material_in_two_regions", "turned_or_mirrored_in_other_pieces"],
        scenes: "boxes with a bore, whose walls are a seventh of a spacing thick",
        has: |scene| scene.form == Form::Bored,
        largest: 1.0,
        reason: "the wall is one point thick or two, as the border has it; the cloud cannot say \
                 which is right",
    },
    Known {
        relations: &["one_material_in_two_regions"],
        scenes: "boxes of three spacings with projected J",
        has: |scene| scene.form == Form::Box && scene.spacings <= 3 && scene.projected,
        largest: 0.5,
        reason: "one or two spacings lie along the shortest edge, and there is a patch for every few points",
    },
    Known {
        relations: &["united_with_itself"],
        scenes: "wedges, corners and cylinders of two materials, and wedges pulled on a part",
        has: |scene| {
            matches!(scene.form, Form::Wedge | Form::Corner | Form::Cylinder)
                && scene.inclusion.is_some()
                || scene.form == Form::Wedge && is_pulled(scene)
        },
        largest: 1e-3,
        reason: "the smallest cells at the re-entrant edge of a wedge are cut by each member in turn, in \
                 other pieces; of corners and cylinders not yet understood",
    },
    Known {
        relations: &["newton_against_relaxation", "relaxation_with_other_masses"],
        scenes: "bodies beside an obstacle",
        has: |scene| scene.obstacle.is_some(),
        largest: 0.01,
        reason: "not yet understood: relaxation and Newton's method differ by 0.94 % in one scene of the corpus, \
                 a corner whose end is moved by more than its spacing beside a wall",
    },
    Known {
        relations: &["turned_or_mirrored"],
        scenes: "static bodies with a traction or a pressure on a disc of a face",
        has: |scene| {
            let on_disc = |push: &Push| {
                matches!(
                    push,
                    Push::Traction(Part::Spot { .. }, _) | Push::Pressure(Part::Spot { .. }, _)
                )
            };
            scene.is_static() && scene.pushes.iter().any(on_disc)
        },
        largest: 4e-4,
        reason: "panels at the edge of the disc are cut in other pieces, which give single nodes 4e-6 of \
                 the load more or less; seen where a held face carries nearly all of it, and the answer \
                 is what is left",
    },
    Known {
        relations: &["translated"],
        scenes: "boxes with rounded edges, with consistent gradients",
        has: |scene| scene.form == Form::Rounded && scene.gradients != Gradients::Plain,
        largest: 1e-3,
        reason: "not yet understood: points are the same to 4e-14 of the size, masses of nodes to 7e-8",
    },
    Known {
        relations: &["volume_of_a_flat_body"],
        scenes: "boxes with a part held on the surface that ends within a face",
        has: |scene| scene.holds.iter().any(|hold| !hold.inner && ends_within_a_face(&hold.part)),
        largest: 4e-3,
        reason: "shares of panels that the edge of what is held cuts stand at nodes beside it, and \
                 weights are scaled to the volume that these enclose",
    },
    Known {
        relations: &["prescribed_values_are_taken"],
        scenes: "motions with an obstacle beside what is held",
        has: |scene| !scene.is_static() && scene.obstacle.is_some(),
        largest: 4e-3,
        reason: "obstacles push nodes after conditions were imposed, and the value at a held node \
                 is a mean over its neighbours; the audit doubts the run where it matters",
    },
    Known {
        relations: &["prescribed_values_are_taken"],
        scenes: "motions with an obstacle that moves",
        has: |scene| !scene.is_static() && scene.obstacle.is_some_and(|wall| wall.drift.is_some()),
        largest: 0.03,
        reason: "the same where the obstacle is driven in beside what is held: 0.011 were seen",
    },
    Known {
        relations: &["turned_or_mirrored_in_other_pieces"],
        scenes: "bodies with curved faces that have up to three spacings along their shortest edge",
        has: |scene| {
            let shortest = scene.edges.into_iter().fold(1.0, f64::min);
            f64::from(scene.spacings) * shortest <= 3.0 && scene.form != Form::Box
        },
        largest: 1.5,
        reason: "a pressure on panels of half a spacing, or springs there, move such a body as these are cut",
    },
    Known {
        relations: &["turned_or_mirrored_in_other_pieces"],
        scenes: "hollow bodies in space of five or six spacings",
        has: |scene| scene.form.has_hole() && scene.components() == 3 && scene.spacings <= 6,
        largest: 0.5,
        reason: "the hole is two spacings wide and the wall about one thick; 0.34 were seen",
    },
    Known {
        relations: &["cloud_of_a_moved_body", "cloud_of_a_hair_larger_body"],
        scenes: "domes and rounded boxes with a held end",
        has: |scene| {
            matches!(scene.form, Form::Dome | Form::Rounded)
                && scene.holds.iter().any(|hold| ends_within_a_face(&hold.part))
        },
        largest: 1e-7,
        reason: "not yet understood: a node beside the edge of what is held lies elsewhere by 1.4e-8 of \
                 the size, in one scene by 4.8e-8; finer tolerances of projections and of clipped panels changed \
                 nothing",
    },
    Known {
        relations: &["a_hair_larger", "lengths_times_thousand", "translated"],
        scenes: "domes with a held end",
        has: ends_on_a_dome,
        largest: 1e-5,
        reason: "not yet understood; points, panels and gradients are the same to 1e-13 of the size",
    },
    Known {
        relations: &["turned_or_mirrored"],
        scenes: "boxes with a bore, and corners of two materials",
        has: |scene| {
            scene.form == Form::Bored || scene.form == Form::Corner && scene.inclusion.is_some()
        },
        largest: 0.04,
        reason: "of a bore whose radius is half a spacing it hangs on the last digit whether two points in \
                 72 see a node at the end of its wall; of corners (0.00003) not yet understood",
    },
    Known {
        relations: PIECES,
        scenes: "wedges, domes and boxes with a bore, of two materials",
        has: |scene| {
            matches!(scene.form, Form::Wedge | Form::Dome | Form::Bored)
                && scene.inclusion.is_some()
        },
        largest: 4e-5,
        reason: "where the border between the materials meets a wall, round-off chooses whether the smallest cells are cut \
                 as planes or in tetrahedra: of some cells 5e-4 to 1e-2 of the weight lies elsewhere",
    },
    Known {
        relations: PIECES,
        scenes: "domes of two materials with projected J",
        has: |scene| scene.form == Form::Dome && scene.inclusion.is_some() && scene.has_patches(),
        largest: 4e-3,
        reason: "the same; a patch of few points takes what lies elsewhere for a change of volume: 2e-3 were \
                 seen, springs or none",
    },
    Known {
        relations: PIECES,
        scenes: "motions of domes and wedges that nothing holds",
        has: flies_cut_off,
        largest: 4e-6,
        reason: "not yet understood; the nodes are the same to 1e-9 of the size",
    },
    Known {
        relations: &["turned_or_mirrored"],
        scenes: "corners that are pulled on a part",
        has: is_a_pulled_corner,
        largest: 4e-5,
        reason: "not yet understood; seen at 1.1e-5",
    },
    Known {
        relations: PIECES,
        scenes: "corners that are pulled on a part",
        has: is_a_pulled_corner,
        largest: 4e-6,
        reason: "not yet understood; seen at 1.2e-6",
    },
    Known {
        relations: &["one_material_in_two_regions"],
        scenes: "wedges that are held on a part of a face",
        has: |scene| {
            scene.form == Form::Wedge
                && scene.holds.iter().any(|hold| ends_within_a_face(&hold.part))
        },
        largest: 0.4,
        reason: "one to three spacings lie between what is held and the edge; seen once, at 0.34",
    },
    Known {
        relations: &["turned_or_mirrored"],
        scenes: "domes with a held end",
        has: ends_on_a_dome,
        largest: 0.02,
        reason: "seen once, of a cloud of about a point a node whose softest motion has a twentieth of the \
                 energy that it should have, so that round-off between nodes and points is amplified",
    },
];

fn ends_on_a_dome(scene: &Scene) -> bool {
    scene.form == Form::Dome && scene.holds.iter().any(|hold| ends_within_a_face(&hold.part))
}

fn flies_cut_off(scene: &Scene) -> bool {
    matches!(scene.form, Form::Dome | Form::Wedge) && !scene.is_static() && scene.holds.is_empty()
}

fn is_a_pulled_corner(scene: &Scene) -> bool {
    scene.form == Form::Corner && is_pulled(scene)
}

fn is_pulled(scene: &Scene) -> bool {
    scene.pushes.iter().any(|push| matches!(push, Push::Pull(..)))
}

fn ends_within_a_face(part: &Part) -> bool {
    match part {
        Part::End { depth, .. } => *depth > 1e-3,
        Part::Spot { .. } => true,
        Part::Whole | Part::Hole => false,
    }
}

/// The known fault by which a relation fails for a scene with this difference. A larger one has
/// another reason.
pub(crate) fn known(relation: &Relation, scene: &Scene, difference: f64) -> Option<&'static Known> {
    KNOWN.iter().find(|known| {
        known.relations.contains(&relation.name)
            && difference <= known.largest
            && (known.has)(scene)
    })
}
