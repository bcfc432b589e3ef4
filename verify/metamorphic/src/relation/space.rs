//! Place, direction and units.
#![allow(non_snake_case)]

use super::subject::{Compared, Relation, Subject, with_nodes};
use crate::answer::{View, relative};
use crate::build::{self, Frame};
use crate::scene::{Form, Gradients, Scene};
use mtled::problem::Problem;
use mtled::{Discretisation, Vector3};

const ROUND_OFF: &str = "Coordinates are rounded to 1e-16 of their size, times a condition of up to \
                         1e6; no cell, node or panel may hang on the last digit";

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "translated",
        claim: "The same nodes elsewhere in space move in the same way",
        bound: 1e-6,
        reason: ROUND_OFF,
        compare: |subject| in_frame(subject, &elsewhere(&subject.scene)),
    },
    Relation {
        name: "turned_or_mirrored",
        claim: "The same nodes turned by right angles or in a mirror move in the same way",
        bound: 1e-6,
        reason: ROUND_OFF,
        compare: |subject| keeps_its_directions(&subject.scene).then(|| turned(subject))?,
    },
    Relation {
        name: "turned_or_mirrored_in_other_pieces",
        claim: "Where patches of points or panels of the boundary follow the axes, turned ones \
                come to rest nearly alike",
        bound: 0.3,
        reason: "Patches of some ten points, and panels of half a spacing, are cut along the axes one \
                 after the other; another cut is another discretisation of the same order, and clouds \
                 here are as coarse as three spacings",
        compare: |subject| {
            let scene = &subject.scene;
            (scene.is_static() && !keeps_its_directions(scene)).then(|| turned(subject))?
        },
    },
    Relation {
        name: "lengths_times_four",
        claim: "In a unit of length a quarter as long the same digits result",
        bound: 1e-9,
        reason: "Powers of two are exact in binary numbers, but for roots and sums of powers; only a length in metres in the program \
                 could tell them apart",
        compare: |subject| in_units(subject, [4.0, 1.0, 1.0]),
    },
    Relation {
        name: "forces_times_two",
        claim: "In other units of force and mass the same digits result",
        bound: 1e-9,
        reason: "Powers of two are exact in binary numbers, but for roots and sums of powers; only a stress or a density in the \
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
        name: "cloud_of_a_hair_larger_body",
        claim: "A body that is larger by 1e-13 has the same nodes",
        bound: 1e-9,
        reason: "Coordinates are rounded to 1e-16 of the size; whether there is a node may not hang \
                 on the last digit",
        compare: |subject| {
            let scene = &subject.scene;
            let larger = Scene { size: (1.0 + 1e-13) * scene.size, ..scene.clone() };
            Some(cloud_against(subject, &build::problem(&larger).ok()?, |X| *X))
        },
    },
    Relation {
        name: "cloud_of_a_moved_body",
        claim: "A body elsewhere in space has the same nodes there",
        bound: 1e-9,
        reason: "Coordinates are rounded to 1e-16 of their size; whether there is a node, or how many \
                 stand on an edge, may not hang on the last digit",
        compare: |subject| {
            let home = Frame::home(&subject.scene);
            let frame = elsewhere(&subject.scene);
            let moved = build::problem_in(&subject.scene, &frame).ok()?;
            Some(cloud_against(subject, &moved, |X| home.point(&frame.home_of(X))))
        },
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
            subject.given_with(build::problem(&thin).ok()?, &view)
        },
    },
];

/// Whether nothing in the discretisation follows the axes: of all forms only boxes have
/// panels that do not, and clouds without consistent gradients and surface loads have none.
fn keeps_its_directions(scene: &Scene) -> bool {
    let has_panels = scene.gradients != Gradients::Plain || scene.loads_surface();
    !scene.has_patches() && (scene.form == Form::Box || !has_panels)
}

fn in_frame(subject: &Subject, frame: &Frame) -> Option<Compared> {
    let (problem, view) = subject.in_frame(frame)?;
    subject.given_with(problem, &view)
}

/// In one of the frames, by the random number of the scene; the first is a mirror image.
fn turned(subject: &Subject) -> Option<Compared> {
    let which = 1 + subject.scene.seed as usize;
    let (problem, view) = subject.in_frame(&Frame::turned(&subject.scene, which))?;
    subject.stepped_with(problem, &view)
}

/// Moved by a few times the size.
fn elsewhere(scene: &Scene) -> Frame {
    Frame { shift: Vector3::new(3.1, -2.3, 1.7), ..Frame::home(scene) }
}

/// The nodes of a subject against those that another problem has, brought back.
fn cloud_against(
    subject: &Subject,
    other: &Problem,
    back: impl Fn(&Vector3) -> Vector3,
) -> Compared {
    match Discretisation::new(other) {
        Err(error) => Compared::Refused(error.to_string()),
        Ok(other) => {
            let nodes: Vec<Vector3> = other.cloud.positions.iter().map(back).collect();
            nodes_moved(subject.base.positions(), &nodes)
        }
    }
}

/// Largest distance between nodes of the same number over the size of the cloud \[–\].
fn nodes_moved(nodes: &[Vector3], others: &[Vector3]) -> Compared {
    if nodes.len() != others.len() {
        return Compared::Difference(f64::INFINITY);
    }
    Compared::Difference(relative(nodes, others, 0.0))
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
    let about = [scene, &other].map(|scene| scene.size * Frame::home(scene).middle());
    let view = View { length, force: stress * length * length, about, ..View::default() };
    let nodes = subject.given()?.positions().iter().map(|X| length * X).collect();
    subject.given_with(with_nodes(build::problem(&other).ok()?, nodes), &view)
}
