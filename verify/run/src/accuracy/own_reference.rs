//! A reference solution from finer runs of this solver as a file, so that a gate need not make
//! it again and does not measure a solver by itself.

use super::own_runs::scales;
use super::reference_solution::ReferenceSolution;
use crate::machine::provenance;
use mtled_case::reference::agreement::rms_of_points;
use mtled_case::reference::{ReferenceError, ReferenceValues, quantities};
use mtled_case::scene::Case;
use serde::{Deserialize, Serialize};

/// Version of the layout that is read here.
const SCHEMA_VERSION: u64 = 1;
/// What `made_by` says, and where it tells such a file from one of finite elements.
const MADE_BY: &str = "finer runs of mtled";

/// The file.
#[derive(Serialize, Deserialize)]
struct OwnReferenceFile {
    schema_version: u64,
    made_by: String,
    case: String,
    /// Fingerprint of the problem that was solved ([`mtled_case::scene::problem_hash`]).
    problem_hash: String,
    /// Of the program that made it.
    version: String,
    commit: String,
    /// YYYY-MM-DD.
    date: String,
    /// Spacings, and how the error bars follow from them.
    source: String,
    times_s: Vec<f64>,
    quantities: Vec<OwnQuantity>,
}

/// One quantity in its SI unit.
#[derive(Serialize, Deserialize)]
struct OwnQuantity {
    name: String,
    unit: String,
    /// Instant by instant.
    values: Vec<f64>,
    /// Error bar of each value.
    errors: Vec<f64>,
}

/// The text of the file.
pub fn own_reference_text(case: &Case, reference: &ReferenceSolution) -> String {
    let provenance = provenance();
    let quantity = |known: &ReferenceValues| OwnQuantity {
        name: known.quantity.name.clone(),
        unit: known.quantity.family.unit().into(),
        values: known.values.clone(),
        errors: known.errors.clone(),
    };
    let file = OwnReferenceFile {
        schema_version: SCHEMA_VERSION,
        made_by: MADE_BY.into(),
        case: case.name.clone(),
        problem_hash: case.problem_hash.clone(),
        version: provenance.version,
        commit: provenance.commit,
        date: provenance.date,
        source: reference.source.clone(),
        times_s: reference.times.clone(),
        quantities: reference.quantities.iter().map(quantity).collect(),
    };
    serde_json::to_string_pretty(&file).unwrap_or_default() + "\n"
}

/// The reference solution of a file called `name`, of finer runs or of finite elements; refused
/// where it belongs to another problem.
pub fn stored_reference(
    case: &Case,
    text: &str,
    name: &str,
) -> Result<ReferenceSolution, ReferenceError> {
    let json = serde_json::from_str::<serde_json::Value>(text);
    if json.is_ok_and(|value| value["made_by"] == MADE_BY) {
        read_own_reference(case, text, name)
    } else {
        ReferenceSolution::from_file(case, text, name)
    }
}

fn read_own_reference(
    case: &Case,
    text: &str,
    name: &str,
) -> Result<ReferenceSolution, ReferenceError> {
    let unreadable =
        |reason: String| ReferenceError::Unreadable { case: case.name.clone(), reason };
    let file: OwnReferenceFile =
        serde_json::from_str(text).map_err(|error| unreadable(error.to_string()))?;
    if file.schema_version != SCHEMA_VERSION {
        let (case, found) = (case.name.clone(), file.schema_version);
        return Err(ReferenceError::UnknownSchema { case, found });
    }
    if file.problem_hash != case.problem_hash {
        return Err(ReferenceError::OtherProblem {
            case: case.name.clone(),
            stored: file.problem_hash,
            current: case.problem_hash.clone(),
        });
    }
    let wanted = quantities(case);
    if !file.quantities.iter().map(|known| &known.name).eq(wanted.iter().map(|own| &own.name)) {
        return Err(unreadable("it has other quantities than the case".into()));
    }
    let values: Vec<Vec<f64>> = file.quantities.iter().map(|known| known.values.clone()).collect();
    let scales = scales(case, &values);
    let mut known = Vec::new();
    for (quantity, OwnQuantity { name, values, errors, .. }) in
        wanted.into_iter().zip(file.quantities)
    {
        let instants = if quantity.changes { file.times_s.len() } else { 1 };
        let expected = instants * quantity.width;
        let finite = values.iter().chain(&errors).all(|number| number.is_finite());
        if values.len() != expected || errors.len() != expected || !finite {
            return Err(unreadable(format!("{name} does not have {expected} finite numbers")));
        }
        known.push(ReferenceValues {
            error: rms_of_points(&errors, quantity.family.components()),
            scale: scales.get(&quantity.family).copied().unwrap_or(0.0),
            values,
            errors,
            quantity,
        });
    }
    Ok(ReferenceSolution {
        times: file.times_s,
        quantities: known,
        source: format!("{name}, of {}: {}", file.date, file.source),
        disagreements: Vec::new(),
    })
}
