//! The answers of a case whose sensitivities are asked for.

use mtled::Simulation;
use mtled::error::Error;
use mtled::{Answer, Vector3};
use mtled_case::reference::{Family, Quantity, quantities};
use mtled_case::scene::{Case, Probe, ProbeKind};
use mtled_run::run::centres_of_mass;

/// An answer below this part of the largest of its kind is round-off \[–\].
const NOTHING: f64 = 1e-6;

/// An answer.
#[derive(Debug, Clone)]
pub(crate) struct Asked {
    /// Such as `force/top`, the length of a vector, or `force/top.z`, a component.
    pub name: String,
    /// SI unit.
    pub unit: &'static str,
    /// What is asked of the solver.
    pub answer: Answer,
    /// In its unit.
    pub value: f64,
    /// Whether the value is 0 up to round-off.
    pub is_nothing: bool,
    family: Family,
}

/// Values of answers at the end of the run.
type Values<'a> = dyn Fn(&[Answer]) -> Result<Vec<f64>, Error> + 'a;

/// A name that no answer has.
#[derive(Debug, thiserror::Error)]
#[error("there is no answer `{name}`; those of this case are {}", known.join(", "))]
pub struct NoAnswer {
    name: String,
    known: Vec<String>,
}

/// The answers that `names` name, such as `force/top` or `force/top.z`; where there are none, those
/// of all probes and supports without moments.
pub(crate) fn asked(
    case: &Case,
    simulation: &Simulation,
    names: &[String],
    values: &Values,
) -> Result<Vec<Asked>, AskedError> {
    let all = all(case, simulation, values)?;
    if names.is_empty() {
        let is_preset =
            |asked: &Asked| asked.family != Family::Moment && stem(&asked.name) == asked.name;
        return Ok(all.into_iter().filter(is_preset).collect());
    }
    let chosen = names.iter().map(|name| {
        let found = all.iter().find(|asked| asked.name == *name).cloned();
        let known = || all.iter().map(|asked| asked.name.clone()).collect();
        found.ok_or_else(|| AskedError::Name(NoAnswer { name: name.clone(), known: known() }))
    });
    chosen.collect()
}

/// Why answers cannot be asked for.
#[derive(Debug)]
pub(crate) enum AskedError {
    /// A name.
    Name(NoAnswer),
    /// A probe outside of the body.
    Solver(Error),
}

impl From<Error> for AskedError {
    fn from(error: Error) -> AskedError {
        AskedError::Solver(error)
    }
}

/// A name without its component.
fn stem(name: &str) -> &str {
    let component = [".x", ".y", ".z"].iter().find(|end| name.ends_with(*end));
    component.map_or(name, |end| &name[..name.len() - end.len()])
}

/// An answer along a direction.
type Along = Box<dyn Fn(Vector3) -> Answer>;

/// All answers: of vectors the length, then the components.
fn all(case: &Case, simulation: &Simulation, values: &Values) -> Result<Vec<Asked>, Error> {
    let mut vectors: Vec<(Quantity, Along, Vec<Vector3>)> = Vec::new();
    for quantity in quantities(case) {
        let name = quantity.name.split_once('/').map_or("", |(_, name)| name);
        let axes = match (quantity.family, simulation.model.components) {
            (Family::Moment, 2) => 2..3,
            (_, components) => 0..components,
        };
        let axes = axes.map(|axis| Vector3::ith(axis, 1.0)).collect();
        if let Some(along) = vector(case, simulation, quantity.family, name)? {
            vectors.push((quantity, along, axes));
        }
    }
    let components =
        vectors.iter().flat_map(|(_, along, axes)| axes.iter().map(|axis| along(*axis)));
    let questions: Vec<Answer> = components.chain([Answer::StrainEnergy]).collect();
    let mut values = values(&questions)?.into_iter();
    let mut all: Vec<Asked> = Vec::new();
    let mut add = |name: String, family: Family, answer: Answer, value: f64| {
        all.push(Asked { name, unit: family.unit(), answer, value, is_nothing: false, family });
    };
    for (Quantity { name, family, .. }, along, axes) in vectors {
        let own: Vec<f64> = values.by_ref().take(axes.len()).collect();
        let whole: Vector3 = axes.iter().zip(&own).map(|(axis, value)| axis * *value).sum();
        let direction = whole.try_normalize(0.0).unwrap_or(axes[0]);
        add(name.clone(), family, along(direction), whole.norm());
        for (axis, value) in axes.iter().zip(own) {
            let letter = ["x", "y", "z"][axis.imax()];
            add(format!("{name}.{letter}"), family, along(*axis), value);
        }
    }
    let energy = values.next().unwrap_or_default();
    add("strain_energy".into(), Family::StrainEnergy, Answer::StrainEnergy, energy);
    let largest = |family: Family| {
        let of_family = all.iter().filter(|asked| asked.family == family);
        of_family.fold(0.0f64, |most, asked| most.max(asked.value.abs()))
    };
    let limits: Vec<f64> = all.iter().map(|asked| NOTHING * largest(asked.family)).collect();
    for (asked, limit) in all.iter_mut().zip(limits) {
        asked.is_nothing = asked.value.abs() <= limit;
    }
    Ok(all)
}

/// An answer along any direction of what is named; `None` where it is no vector.
fn vector(
    case: &Case,
    simulation: &Simulation,
    family: Family,
    name: &str,
) -> Result<Option<Along>, Error> {
    let condition = case.problem.conditions.iter().position(|c| c.name == name);
    let about = case.outputs.moment_about;
    Ok(match (family, condition) {
        (Family::Displacement, _) => {
            let Some(probe) = case.probes.iter().find(|probe| probe.name == name) else {
                return Ok(None);
            };
            let weights = weights(case, simulation, probe)?;
            Some(Box::new(move |along| Answer::Displacement { weights: weights.clone(), along }))
        }
        (Family::Force, Some(condition)) => {
            Some(Box::new(move |along| Answer::Force { condition, along }))
        }
        (Family::Moment, Some(condition)) => {
            Some(Box::new(move |along| Answer::Moment { condition, along, about }))
        }
        _ => None,
    })
}

/// What the displacement of a probe is a sum of; of a lattice the mean.
fn weights(case: &Case, simulation: &Simulation, probe: &Probe) -> Result<Vec<(u32, f64)>, Error> {
    if let ProbeKind::CentreOfMass { region } = &probe.kind {
        let index = case.problem.regions.iter().position(|own| own.name == *region);
        let centres = centres_of_mass(&case.problem, &simulation.discretisation);
        let weights = index.map(|index| centres[index].weights()).unwrap_or_default();
        let weights = weights.iter().enumerate().map(|(node, weight)| (node as u32, *weight));
        return Ok(weights.filter(|(_, weight)| *weight != 0.0).collect());
    }
    let rows = simulation.discretisation.rows_at(&probe.kind.positions())?;
    let part = 1.0 / rows.len().max(1) as f64;
    let of_row =
        |row: usize| rows.row(row).map(|entry| (rows.nodes[entry], part * rows.phi[entry]));
    Ok((0..rows.len()).flat_map(of_row).collect())
}
