//! Bodies with fibres against finite elements, and the beam of Land's benchmark of hearts.

use crate::exact::land;
use crate::studies::workbench::{Workbench, relative_error};
use anyhow::{Context, Result};
use mtled::Vector3;
use mtled_case::scene::{Case, parse_case};
use mtled_checks::study::{Bound, Cell, Check, Kind, Study, Table, number, text};
use mtled_reference::{FIBRES, WithFibres};
use mtled_run::run::{Recording, solve_case};
use mtled_run::specimens::spacing::{respaced, spacing_of};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Bound on displacements and forces over the largest of them, beside what the reference does not
/// know: six to ten spacings across the body \[–\].
const BOUND: f64 = 0.03;
/// Distance from the consensus of eleven groups that still agrees with it \[–\].
const CONSENSUS: f64 = 0.01;

/// What FEniCSx answers on meshes of falling size.
#[derive(Deserialize)]
struct Reference {
    meshes: Vec<Mesh>,
}

#[derive(Deserialize)]
struct Mesh {
    /// Such as `displacement/tip/z` \[m\] and `force/clamp/x` \[N\].
    answers: BTreeMap<String, f64>,
}

/// Answers of one kind beside those of the reference.
struct Compared {
    /// Largest difference over the largest size of the reference \[–\].
    difference: f64,
    /// The same between the two finest meshes of the reference \[–\].
    uncertainty: f64,
}

/// Compares every body at the spacing of its case, and in the full suite at two thirds of it.
pub(crate) fn fibres(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut rows = Vec::new();
    for body in FIBRES {
        let reference: Reference = serde_json::from_str(body.reference)?;
        let mut case = parse_case(body.case, body.name, Path::new("."))
            .map_err(|found| anyhow::anyhow!("{}: {found:?}", body.name))?;
        bench.reseed(&mut case.problem);
        for part in bench.pick(vec![1.0], vec![1.0, 2.0 / 3.0]) {
            let spacing = part * spacing_of(&case.problem)?;
            let (solved, record) = solve_case(&respaced(&case, spacing)?)?;
            let nodes = solved.simulation.discretisation.cloud.positions.len();
            compare(body, &case, (spacing, nodes), &record, &reference, (study, &mut rows))?;
        }
    }
    study.tables.push(Table {
        title: "Bodies with fibres: largest differences from FEniCSx".into(),
        columns: vec![
            text("body"),
            number("spacing", "m"),
            number("nodes", ""),
            text("answers"),
            number("difference over the largest", "1"),
            number("between the two finest meshes", "1"),
        ],
        rows,
    });
    Ok(())
}

fn compare(
    body: &WithFibres,
    case: &Case,
    (spacing, nodes): (f64, usize),
    record: &Recording,
    reference: &Reference,
    (study, rows): (&mut Study, &mut Vec<Vec<Cell>>),
) -> Result<()> {
    let answers = answers(case, record)?;
    let is_own = relative_error(spacing, spacing_of(&case.problem)?) < 1e-9;
    for kind in ["displacement", "force"] {
        let Compared { difference, uncertainty } = compared(kind, &answers, reference)?;
        rows.push(vec![
            Cell::Text(body.name.into()),
            Cell::Number(spacing),
            Cell::Number(nodes as f64),
            Cell::Text(kind.into()),
            Cell::Number(difference),
            Cell::Number(uncertainty),
        ]);
        if is_own {
            study.checks.push(Check::new(
                &format!("fibres/{}/{kind}", body.name),
                &format!("{}: {kind}s, largest difference over the largest", case.title),
                Kind::Reference,
                difference,
                Bound::AtMost(BOUND + uncertainty),
                "1",
                "FEniCSx, quadratic displacements and linear pressures in hexahedra",
            ));
        }
    }
    if body.name == "land_1" && is_own {
        let height = land::BEAM_HEIGHT + answers["displacement/tip/z"];
        study.checks.push(Check::new(
            "fibres/land_1/consensus",
            "Land's first problem: height of the tip, relative difference from the consensus",
            Kind::Reference,
            relative_error(height, land::TIP_OF_BEAM.value),
            Bound::AtMost(CONSENSUS),
            "1",
            land::TIP_OF_BEAM.source,
        ));
    }
    Ok(())
}

/// Displacements \[m\] and forces \[N\] at the end under the names of the references.
fn answers(case: &Case, record: &Recording) -> Result<BTreeMap<String, f64>> {
    let last = record.samples.last().context("the record is empty")?;
    let mut answers = BTreeMap::new();
    let mut add = |name: String, value: &Vector3| {
        for (axis, value) in ["x", "y", "z"].iter().zip(value.iter()) {
            answers.insert(format!("{name}/{axis}"), *value);
        }
    };
    for (probe, at) in case.probes.iter().zip(&last.displacements) {
        add(format!("displacement/{}", probe.name), &at[0]);
    }
    for (condition, reaction) in case.problem.conditions.iter().zip(&last.reactions) {
        add(format!("force/{}", condition.name), &reaction.force);
    }
    Ok(answers)
}

fn compared(
    kind: &str,
    answers: &BTreeMap<String, f64>,
    reference: &Reference,
) -> Result<Compared> {
    let [.., coarser, finest] = &reference.meshes[..] else {
        anyhow::bail!("the reference has fewer than two meshes");
    };
    let (mut difference, mut uncertainty, mut largest): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for (name, right) in finest.answers.iter().filter(|(name, _)| name.starts_with(kind)) {
        let own = answers.get(name).with_context(|| format!("{name} is not answered"))?;
        let before = coarser.answers.get(name).with_context(|| format!("{name} is missing"))?;
        difference = difference.max((own - right).abs());
        uncertainty = uncertainty.max((before - right).abs());
        largest = largest.max(right.abs());
    }
    Ok(Compared { difference: difference / largest, uncertainty: uncertainty / largest })
}
