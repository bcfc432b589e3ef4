//! The order in which things are stated.

use super::sameness::changed;
use super::subject::{Relation, Subject, with_nodes};
use crate::answer::View;
use crate::scene::Form;
use mtled::Vector3;
use mtled::geometry::{Selector, Shape};
use mtled::problem::{BodyForce, Pressure, Region, Spring, Traction};

const SUMS: &str = "Sums in another order differ by round-off, 1e-16 of their largest member, \
                    times a condition of up to 1e5; Newton's method ends at 1e-12 of the largest force";

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "order_of_nodes",
        claim: "Nodes in another order have the same displacements",
        bound: 1e-6,
        reason: SUMS,
        compare: |subject| {
            let nodes = subject.given()?.positions();
            let order = shuffled(nodes.len());
            let mut place = vec![0; nodes.len()];
            order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
            let other = order.iter().map(|&node| nodes[node]).collect();
            let view = View { nodes: Some(place), ..View::default() };
            subject.stepped_with(with_nodes(subject.problem(), other), &view)
        },
    },
    Relation {
        name: "order_of_conditions",
        claim: "Conditions in another order hold the same nodes",
        bound: 1e-6,
        reason: SUMS,
        compare: |subject| {
            let reversed = changed(subject, |problem| problem.conditions.reverse());
            let view = View { each_reaction: false, ..View::default() };
            // On the same nodes: those on the edges of held parts are numbered by condition.
            (subject.scene.holds.len() > 1).then(|| subject.given_with(reversed, &view))?
        },
    },
    Relation {
        name: "order_of_loads",
        claim: "Loads in another order are the same loads",
        bound: 1e-6,
        reason: SUMS,
        compare: |subject| {
            let reversed = changed(subject, |problem| {
                problem.loads.body_forces.reverse();
                problem.loads.tractions.reverse();
                problem.loads.pressures.reverse();
            });
            (subject.scene.pushes.len() > 1).then(|| subject.with(reversed, &View::default()))?
        },
    },
    Relation {
        name: "order_of_regions",
        claim: "Two regions that fill the body do so in either order",
        bound: 1e-6,
        reason: SUMS,
        compare: |subject| {
            subject.scene.inclusion?;
            let swapped = changed(subject, |problem| {
                let half = problem.regions[0].part.clone();
                problem.regions[1].part = Selector::Not(Box::new(half));
                problem.regions.swap(0, 1);
            });
            subject.with(swapped, &View::default())
        },
    },
    Relation {
        name: "order_of_members",
        claim: "Members of a union or an intersection in another order make the same body",
        bound: 1e-6,
        reason: SUMS,
        compare: |subject| {
            let mut other = subject.problem();
            match &mut other.body {
                Shape::Union(members) | Shape::Intersection(members) => members.reverse(),
                _ => return None,
            }
            subject.given_with(other, &View::default())
        },
    },
    Relation {
        name: "order_of_triangles",
        claim: "Triangles of a surface in another order enclose the same body",
        bound: 1e-6,
        reason: SUMS,
        compare: |subject| {
            if subject.scene.form != Form::Wedge {
                return None;
            }
            let mut other = subject.problem();
            other.body = crate::build::wedge_in_another_order(&subject.scene).ok()?;
            subject.with(other, &View::default())
        },
    },
    Relation {
        name: "load_in_two_parts",
        claim: "A load or a spring stated as a third and two thirds of it is the same load",
        bound: 1e-6,
        reason: SUMS,
        compare: in_two_parts,
    },
    Relation {
        name: "a_region_in_front_of_itself",
        claim: "A material that is stated twice is the same material",
        bound: 1e-6,
        reason: SUMS,
        compare: |subject| {
            let other = changed(subject, |problem| {
                let last = problem.regions.len() - 1;
                let again = problem.regions[last].clone();
                problem.regions.push(Region { name: "again".into(), ..again });
            });
            subject.with(other, &View::default())
        },
    },
];

/// A shuffle of so many numbers, always the same one.
fn shuffled(count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    fastrand::Rng::with_seed(count as u64).shuffle(&mut order);
    order
}

/// Every load in two parts.
fn in_two_parts(subject: &Subject) -> Option<super::subject::Compared> {
    let mut other = subject.problem();
    let loads = &mut other.loads;
    let scaled = |field: &mtled::problem::Field, factor: f64| {
        mtled::problem::Field::from(factor * field.at(&Vector3::zeros()))
    };
    let parts = [1.0 / 3.0, 2.0 / 3.0];
    loads.body_forces = (loads.body_forces.iter())
        .flat_map(|load| {
            parts.map(|part| BodyForce {
                acceleration: scaled(&load.acceleration, part),
                ..load.clone()
            })
        })
        .collect();
    loads.tractions = (loads.tractions.iter())
        .flat_map(|load| {
            parts.map(|part| Traction { traction: scaled(&load.traction, part), ..load.clone() })
        })
        .collect();
    loads.pressures = (loads.pressures.iter())
        .flat_map(|load| {
            parts.map(|part| Pressure { pressure: part * load.pressure, ..load.clone() })
        })
        .collect();
    loads.springs = (loads.springs.iter())
        .flat_map(|load| {
            parts.map(|part| Spring {
                normal: part * load.normal,
                tangential: part * load.tangential,
                ..load.clone()
            })
        })
        .collect();
    let counts = [loads.body_forces.len(), loads.tractions.len(), loads.pressures.len()];
    (counts.iter().sum::<usize>() + loads.springs.len() > 0)
        .then(|| subject.with(other, &View::default()))?
}
