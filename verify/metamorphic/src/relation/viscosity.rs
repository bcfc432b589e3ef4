//! Stresses that relax: at once, never, and in two terms instead of one.

use super::subject::{Compared, Relation, Subject, against};
use crate::answer::{View, steady};
use crate::build;
use crate::scene::{Memory, Scene};
use mtled::material::{PronySeries, PronyTerm};

/// Relaxation time over that of the run, of what does not relax in it \[–\].
const NEVER: f64 = 1e12;

pub(crate) const RELATIONS: &[Relation] = &[
    Relation {
        name: "term_in_two_halves",
        claim: "Two terms of half the size and of the same time relax as one does",
        bound: 1e-6,
        reason: "Terms are added up; Newton's method ends at 1e-12 of the largest force at each time, times \
                 a condition of up to 1e5",
        compare: in_two_halves,
    },
    Relation {
        name: "relaxes_never",
        claim: "What relaxes in a time far longer than the run is as stiff as without memory",
        bound: 1e-6,
        reason: "1e-12 of the stress has relaxed; Newton's method ends at 1e-12 of the largest force, times \
                 a condition of up to 1e5",
        compare: |subject| {
            let scene = remembering(&subject.scene, NEVER)?;
            let without = Scene { memory: None, ..scene.clone() };
            let elastic = steady(build::problem(&without).ok()?)?;
            Some(against(&elastic, build::problem(&scene).ok()?, &View::default()))
        },
    },
    Relation {
        name: "relaxes_at_once",
        claim: "What relaxes in a time far shorter than the run is as soft as in the end",
        bound: 1e-6,
        reason: "As before: 1e-12 of the stress has not relaxed",
        compare: |subject| {
            let scene = remembering(&subject.scene, 1.0 / NEVER)?;
            // What is projected on patches goes with the ratio of both moduli.
            let scene = Scene { projected: false, ..scene };
            if !scene.is_static() {
                return None;
            }
            let mut elastic = build::problem(&scene).ok()?;
            let parts = build::relaxed_materials(&scene).ok()?;
            for (region, material) in elastic.regions.iter_mut().zip(parts) {
                (region.material, region.viscosity) = (material, None);
            }
            let elastic = steady(elastic)?;
            Some(against(&elastic, build::problem(&scene).ok()?, &View::default()))
        },
    },
];

/// The scene with a stress that relaxes, where the law has one and only that remembers.
fn remembering(scene: &Scene, time: f64) -> Option<Scene> {
    let part = scene.memory.map_or(0.5, |memory| memory.part);
    let scene = Scene { memory: None, ..scene.clone() };
    let fit = scene.law.is_split() && !scene.depends_on_way();
    fit.then_some(Scene { memory: Some(Memory { part, time }), ..scene })
}

fn in_two_halves(subject: &Subject) -> Option<Compared> {
    subject.scene.memory?;
    let mut other = subject.problem();
    for region in &mut other.regions {
        let series = region.viscosity?;
        let halves = series.terms().iter().flat_map(|term| {
            let half = PronyTerm { g: 0.5 * term.g, ..*term };
            [half, half]
        });
        let halves: Vec<PronyTerm> = halves.collect();
        region.viscosity = Some(PronySeries::new(&halves).ok()?);
    }
    subject.with(other, &View::default())
}
