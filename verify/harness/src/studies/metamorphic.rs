//! Relations that must hold of any scene, on random ones.

use crate::studies::workbench::{Workbench, exact};
use anyhow::Result;
use mtled_checks::study::{Cell, Check, Study, Table, number, text};
use mtled_metamorphic::hunt::{Verdict, examine, smallest};
use mtled_metamorphic::known::KNOWN;
use mtled_metamorphic::relation::{Compared, Relation, all};
use mtled_metamorphic::scene::Scene;
use std::collections::BTreeMap;

/// Of the random scenes.
const SEED: u64 = 38;
/// One of so many relations is tried on each scene, another one on the next.
const STRIDE: usize = 5;

/// What scenes say of a relation.
#[derive(Default)]
struct Tried {
    scenes: usize,
    known: usize,
    undecided: usize,
    /// Largest difference but for known faults \[–\].
    largest: f64,
    /// The first scene that breaks it.
    broken: Option<(Scene, Verdict)>,
}

/// Draws scenes and holds all relations against them.
pub(crate) fn metamorphic(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut rng = fastrand::Rng::with_seed(bench.seed(SEED));
    let mut tried: BTreeMap<&str, Tried> = BTreeMap::new();
    let (mut scenes, mut without_answer) = (0, 0);
    while scenes < bench.pick(SCENES, SCENES_OF_FULL_SUITE) {
        let scene = Scene::draw(&mut rng);
        let turn = scenes;
        let chosen = |relation: &Relation| group(relation) == turn % STRIDE;
        match examine(&scene, &chosen) {
            Ok(verdicts) => {
                scenes += 1;
                verdicts.into_iter().for_each(|verdict| count(&mut tried, &scene, verdict));
            }
            Err(_) => without_answer += 1,
        }
    }
    try_the_rest(&mut tried, &mut rng);
    let empty = Tried::default();
    for relation in all() {
        study.checks.push(check(relation, tried.get(relation.name).unwrap_or(&empty)));
    }
    study.tables.push(counts(&tried));
    study.tables.push(known_faults());
    study.notes.push(format!(
        "{scenes} scenes with an answer; {without_answer} others were refused, move nothing or are \
         unstable, and say nothing."
    ));
    Ok(())
}

/// By the name alone, so that a new relation leaves the others their scenes.
fn group(relation: &Relation) -> usize {
    relation.name.bytes().map(usize::from).sum::<usize>() % STRIDE
}

/// Scenes with an answer.
const SCENES: usize = 40;
const SCENES_OF_FULL_SUITE: usize = 800;
/// Most scenes besides, for relations that few scenes are fit for.
const MORE_SCENES: usize = 200;

/// Draws more scenes for those relations that say nothing about any so far.
fn try_the_rest(tried: &mut BTreeMap<&str, Tried>, rng: &mut fastrand::Rng) {
    for _ in 0..MORE_SCENES {
        let silent =
            |relation: &Relation| tried.get(relation.name).is_none_or(|tried| tried.scenes == 0);
        if !all().any(silent) {
            break;
        }
        let scene = Scene::draw(rng);
        if let Ok(verdicts) = examine(&scene, &silent) {
            verdicts.into_iter().for_each(|verdict| count(tried, &scene, verdict));
        }
    }
}

fn count(tried: &mut BTreeMap<&str, Tried>, scene: &Scene, verdict: Verdict) {
    let own = tried.entry(verdict.relation.name).or_default();
    let difference = match &verdict.compared {
        None => return,
        Some(Compared::Undecided(_)) => {
            own.undecided += 1;
            return;
        }
        Some(Compared::Refused(_)) => f64::INFINITY,
        Some(Compared::Difference(difference)) => *difference,
    };
    if verdict.is_broken() && verdict.known {
        own.known += 1;
        return;
    }
    own.scenes += 1;
    own.largest = mtled_checks::measure::larger(own.largest, difference);
    if verdict.is_finding() && own.broken.is_none() {
        own.broken = Some((scene.clone(), verdict));
    }
}

/// A relation that no scene tried has no value, and fails.
fn check(relation: &Relation, tried: &Tried) -> Check {
    let value = if tried.scenes == 0 { f64::NAN } else { tried.largest };
    let id = format!("metamorphic/{}", relation.name);
    let label = format!("{}: largest difference", relation.claim);
    let mut check = exact(&id, &label, value, relation.bound, relation.reason);
    if let Some((scene, verdict)) = &tried.broken {
        check.reproduce = smallest(scene, verdict).text().ok();
    }
    check
}

fn counts(tried: &BTreeMap<&str, Tried>) -> Table {
    let row = |relation: &Relation| {
        let own = tried.get(relation.name)?;
        let counts = [own.scenes, own.known, own.undecided].map(|n| Cell::Number(n as f64));
        let [scenes, known, undecided] = counts;
        let largest = Cell::Number(own.largest);
        let name = Cell::Text(relation.name.replace('_', " "));
        Some(vec![name, scenes, known, undecided, largest, Cell::Number(relation.bound)])
    };
    Table {
        title: "Relations and the scenes that they were held against".into(),
        columns: vec![
            text("relation"),
            number("scenes", "1"),
            number("with a known fault", "1"),
            number("undecided", "1"),
            number("largest difference", "1"),
            number("allowed", "1"),
        ],
        rows: all().filter_map(row).collect(),
    }
}

fn known_faults() -> Table {
    let row = |known: &mtled_metamorphic::known::Known| {
        let [relation, scenes, reason] =
            [&known.relations.join(", ").replace('_', " "), known.scenes, known.reason]
                .map(|cell| Cell::Text(cell.to_string()));
        vec![relation, scenes, Cell::Number(known.largest), reason]
    };
    Table {
        title: "Known faults, whose scenes are left out of a relation".into(),
        columns: vec![text("relation"), text("scenes"), number("excused up to", "1"), text("why")],
        rows: KNOWN.iter().map(row).collect(),
    }
}
