//! The same body in other words.

use super::subject::{Compared, Relation, Subject, against, with_nodes};
use crate::answer::{View, answer};
use crate::build::{self, Frame};
use crate::scene::{Form, Part};
use mtled::Vector3;
use mtled::geometry::{Selector, Shape};
use mtled::problem::Region;

const SAME_BODY: &str = "Distances, panels and cells are those of the one body, to round-off, times a \
                         condition of up to 1e5";

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "united_with_itself",
        claim: "A ∪ A is A",
        bound: 1e-5,
        reason: "The smallest cells in which the distance has a kink are cut by each member in \
                 turn, the second time in other pieces: 4e-6 were seen at a re-entrant edge",
        compare: |subject| with_body(subject, |body, _| Shape::Union(vec![body.clone(), body])),
    },
    Relation {
        name: "without_what_is_elsewhere",
        claim: "A without a ball beside it is A",
        bound: 1e-6,
        reason: SAME_BODY,
        compare: |subject| {
            with_body(subject, |body, size| {
                let centre = Vector3::repeat(-2.0 * size);
                Shape::Difference(Box::new(body), Box::new(Shape::Sphere { centre, radius: size }))
            })
        },
    },
    Relation {
        name: "in_something_larger",
        claim: "A ∩ a box around it is A",
        bound: 1e-6,
        reason: SAME_BODY,
        compare: |subject| {
            with_body(subject, |body, size| {
                let corner = Vector3::repeat(3.0 * size);
                Shape::Intersection(vec![body, Shape::Box { min: -corner, max: corner }])
            })
        },
    },
    Relation {
        name: "as_triangles",
        claim: "A box of triangles moves like the box",
        bound: 0.3,
        reason: "The body is the same to round-off, but triangles are cut into other panels than \
                 rectangles, another discretisation of the same order on clouds as coarse as three spacings",
        compare: |subject| {
            let surface = build::as_surface(&subject.scene, &Frame::home(&subject.scene))?;
            let mut other = subject.problem();
            other.body = surface.ok()?;
            subject.given_with(other, &View::default())
        },
    },
    Relation {
        name: "as_voxels",
        claim: "A box of voxels comes to rest nearly like the box",
        bound: 0.3,
        reason: "The surface of voxels is smoothed over 0.7 of them, a twentieth of the size: its \
                 edges are rounded, with up to a tenth of what is held there",
        compare: as_voxels,
    },
    Relation {
        name: "part_in_other_words",
        claim: "A part, twice its complement, or united with itself selects the same",
        bound: 1e-6,
        reason: SAME_BODY,
        compare: |subject| {
            let mut other = subject.problem();
            let not = |part: &Selector| Selector::Not(Box::new(part.clone()));
            for condition in &mut other.conditions {
                condition.part = not(&not(&condition.part));
            }
            for traction in &mut other.loads.tractions {
                traction.part = Selector::Union(vec![traction.part.clone(), traction.part.clone()]);
            }
            for pressure in &mut other.loads.pressures {
                pressure.part = Selector::Intersection(vec![Selector::All, pressure.part.clone()]);
            }
            for force in &mut other.loads.body_forces {
                force.part = not(&not(&force.part));
            }
            for spring in &mut other.loads.springs {
                spring.part = Selector::Union(vec![spring.part.clone(), spring.part.clone()]);
            }
            for cavity in &mut other.loads.cavities {
                cavity.part = not(&not(&cavity.part));
            }
            subject.with(other, &View::default())
        },
    },
    Relation {
        name: "one_material_in_two_regions",
        claim: "A body of one material comes to rest like one of two regions of that material",
        bound: 0.3,
        reason: "Cells that the border cuts have a point on either side of it: another quadrature \
                 of the same order on clouds as coarse as three spacings",
        compare: |subject| {
            let mut other = subject.problem();
            let rest = other.regions.last()?.clone();
            let end = Part::End { axis: 0, upper: false, depth: 0.47 };
            let part = build::part(&subject.scene, &Frame::home(&subject.scene), &end);
            let at = other.regions.len() - 1;
            other.regions.insert(at, Region { name: "the same".into(), part, ..rest });
            let says = subject.scene.inclusion.is_none() && subject.scene.is_static();
            says.then(|| subject.with(other, &View::default()))?
        },
    },
];

/// Held in the volume, since nodes at the edges are not on the rounded surface.
fn as_voxels(subject: &Subject) -> Option<Compared> {
    let mut scene = subject.scene.clone();
    // Of a motion in a few steps over three to six spacings another cloud makes another wave.
    if scene.form != Form::Box
        || !scene.is_static()
        || scene.components() == 2
        || scene.loads_surface()
    {
        return None;
    }
    scene.holds.iter_mut().for_each(|hold| hold.inner = true);
    let nodes = subject.given()?.positions().to_vec();
    let solid = with_nodes(build::problem(&scene).ok()?, nodes);
    let mut voxels = solid.clone();
    voxels.body = build::as_voxels(&scene, &Frame::home(&scene)).ok()?;
    Some(against(&answer(solid).ok()?, voxels, &View::default()))
}

/// With another body on the same nodes.
fn with_body(subject: &Subject, change: impl FnOnce(Shape, f64) -> Shape) -> Option<Compared> {
    let mut other = subject.problem();
    other.body = change(other.body, subject.scene.size);
    subject.given_with(other, &View::default())
}
