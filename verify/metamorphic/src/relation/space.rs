//! Place, direction and units.

use super::{Compared, Relation, Subject, against};
use crate::answer::View;
use crate::build::{self, Frame};
use crate::scene::Scene;
use mtled::Vector3;

const ROUND_OFF: &str = "Coordinates are rounded to 1e-16 of their size, times a condition of up to \
                         1e6; no cell, node or panel may hang on the last digit";

pub const RELATIONS: &[Relation] = &[
    Relation {
        name: "translated",
        claim: "The same nodes elsewhere in space move in the same way",
        bound: 1e-6,
        reason: ROUND_OFF,
        compare: |subject| {
            let shift = Vector3::new(3.1, -2.3, 1.7);
            in_frame(subject, &Frame { shift, ..Frame::home(&subject.scene) })
        },
    },
    Relation {
        name: "turned_or_mirrored",
        claim: "The same nodes turned by right angles or in a mirror move in the same way",
        bound: 1e-6,
        reason: ROUND_OFF,
        compare: |subject| (!subject.scene.has_patches()).then(|| turned(subject))?,
    },
    Relation {
        name: "turned_or_mirrored_with_patches",
        claim: "The same with J projected on patches, which follow the axes, hardly differs",
        bound: 0.1,
        reason: "Patches of some ten points are cut along the axes one after the other, and another \
                 cut is another discretisation of the same order: the error of a coarse cloud",
        compare: |subject| subject.scene.has_patches().then(|| turned(subject))?,
    },
    Relation {
        name: "lengths_times_four",
        claim: "In a unit of length a quarter as long the same bits result",
        bound: 1e-13,
        reason: "Powers of two are exact in binary numbers; only a length in metres in the program \
                 could tell them apart",
        compare: |subject| in_units(subject, [4.0, 1.0, 1.0]),
    },
    Relation {
        name: "forces_times_two",
        claim: "In other units of force and mass the same bits result",
        bound: 1e-13,
        reason: "Powers of two are exact in binary numbers; only a stress or a density in the \
                 program could tell them apart",
        compare: |subject| in_units(subject, [1.0, 1024.0, 16.0]),
    },
    Relation {
        name: "lengths_times_thousand",
        claim: "In millimetres the same displacements result",
        bound: 1e-6,
        reason: ROUND_OFF,
        compare: |subject| in_units(subject, [1000.0, 1.0, 1.0]),
    },
    Relation {
        name: "a_hair_larger",
        claim: "A body that is larger by 1e-13 moves in the same way",
        bound: 1e-6,
        reason: ROUND_OFF,
        compare: |subject| in_units(subject, [1.0 + 1e-13, 1.0, 1.0]),
    },
    Relation {
        name: "thickness_of_a_slice",
        claim: "The thickness of a slice in plane strain scales forces and nothing else",
        bound: 1e-6,
        reason: ROUND_OFF,
        compare: |subject| {
            let thickness = subject.scene.thickness?;
            let factor = 0.013;
            let thin = Scene { thickness: Some(factor * thickness), ..subject.scene.clone() };
            let view = View { force: factor, ..View::default() };
            subject.with(build::problem(&thin).ok()?, &view)
        },
    },
];

fn in_frame(subject: &Subject, frame: &Frame) -> Option<Compared> {
    let (problem, view) = subject.in_frame(frame)?;
    subject.given_with(problem, &view)
}

/// In one of the frames, by the seed of the scene; the first is a mirror image.
fn turned(subject: &Subject) -> Option<Compared> {
    let which = 1 + subject.scene.seed as usize;
    in_frame(subject, &Frame::turned(&subject.scene, which))
}

/// With lengths, stresses and densities times a factor each.
fn in_units(subject: &Subject, [length, stress, density]: [f64; 3]) -> Option<Compared> {
    let scene = &subject.scene;
    let other = Scene {
        size: length * scene.size,
        young_modulus: stress * scene.young_modulus,
        density: density * scene.density,
        ..scene.clone()
    };
    let view = View { length, force: stress * length * length, ..View::default() };
    Some(against(&subject.base, build::problem(&other).ok()?, &view))
}
