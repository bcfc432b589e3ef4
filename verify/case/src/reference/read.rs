//! Text → a reference file that belongs to its case and says where it is from.

use super::format::{Mesh, ReferenceFile, SCHEMA_VERSION, Solution, Values};
use super::quantity::{Quantity, is_dynamic, quantities};
use crate::scene::Case;
use mtled::problem::Motion;
use thiserror::Error;

/// Codes that references come from; a case needs both.
pub const CODES: [&str; 2] = ["fenicsx", "scikit-fem"];

/// Name of a code in tables and figures.
pub fn title_of(code: &str) -> &str {
    if code == "fenicsx" { "FEniCSx" } else { code }
}

/// Meshes per code, the fewest that show an order.
pub(crate) const MESHES: usize = 3;

/// Why stored values are no reference of a case.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs)] // The messages say it.
pub enum ReferenceError {
    #[error("{case}: there is no stored reference")]
    Absent { case: String },
    #[error("{case}: the reference cannot be read: {reason}")]
    Unreadable { case: String, reason: String },
    #[error("{case}: the reference has schema_version {found}; {SCHEMA_VERSION} is known here")]
    UnknownSchema { case: String, found: u64 },
    #[error("{case}: the reference belongs to the case {found}")]
    OtherCase { case: String, found: String },
    #[error(
        "{case}: the reference was made for another problem: its problem_hash is {stored}, that of the case file {current}"
    )]
    OtherProblem { case: String, stored: String, current: String },
    #[error("{case}: times_s {reason}")]
    Times { case: String, reason: String },
    #[error("{case}: {code} is not a code that is known here")]
    UnknownCode { case: String, code: String },
    #[error("{case}: there are {count} solutions of {code} instead of one")]
    Solutions { case: String, code: String, count: usize },
    #[error("{case}: {code}: no provenance: {field} {reason}")]
    NoProvenance { case: String, code: String, field: String, reason: String },
    #[error("{case}: {code}: {count} meshes; an order needs {MESHES}")]
    FewMeshes { case: String, code: String, count: usize },
    #[error("{case}: {code}, mesh {mesh}: {quantity} is missing")]
    MissingQuantity { case: String, code: String, mesh: usize, quantity: String },
    #[error("{case}: {code}, mesh {mesh}: the case has no quantity {quantity}")]
    UnknownQuantity { case: String, code: String, mesh: usize, quantity: String },
    #[error("{case}: {code}, mesh {mesh}: {quantity} {reason}")]
    Values { case: String, code: String, mesh: usize, quantity: String, reason: String },
}

/// Reads the reference of a case and refuses what cannot be trusted.
pub fn read_reference(case: &Case, text: &str) -> Result<ReferenceFile, ReferenceError> {
    let unreadable = |error: serde_json::Error| ReferenceError::Unreadable {
        case: case.name.clone(),
        reason: error.to_string(),
    };
    let value: serde_json::Value = serde_json::from_str(text).map_err(unreadable)?;
    // Another version may have another layout, so it is read first.
    if let Some(found) = value["schema_version"].as_u64()
        && found != u64::from(SCHEMA_VERSION)
    {
        return Err(ReferenceError::UnknownSchema { case: case.name.clone(), found });
    }
    let file: ReferenceFile = serde_json::from_value(value).map_err(unreadable)?;
    check(case, &file)?;
    Ok(file)
}

fn check(case: &Case, file: &ReferenceFile) -> Result<(), ReferenceError> {
    let name = || case.name.clone();
    if file.case != case.name {
        return Err(ReferenceError::OtherCase { case: name(), found: file.case.clone() });
    }
    if file.problem_hash != case.problem_hash {
        return Err(ReferenceError::OtherProblem {
            case: name(),
            stored: file.problem_hash.clone(),
            current: case.problem_hash.clone(),
        });
    }
    check_times(case, &file.times_s)?;
    if let Some(solution) = file.solutions.iter().find(|s| !CODES.contains(&s.code.as_str())) {
        return Err(ReferenceError::UnknownCode { case: name(), code: solution.code.clone() });
    }
    for code in CODES {
        let count = file.solutions.iter().filter(|solution| solution.code == code).count();
        if count != 1 {
            return Err(ReferenceError::Solutions { case: name(), code: code.into(), count });
        }
    }
    let required = quantities(case);
    for solution in &file.solutions {
        check_solution(case, solution, file.times_s.len(), &required)?;
    }
    Ok(())
}

fn check_times(case: &Case, times: &[f64]) -> Result<(), ReferenceError> {
    let refuse = |reason: String| Err(ReferenceError::Times { case: case.name.clone(), reason });
    match &case.problem.motion {
        Motion::Static(_) | Motion::Relaxed(_) | Motion::Newton(_) => {
            let load_end = case.problem.motion.end();
            if times != [load_end] {
                return refuse(format!("must be [{load_end}], the end of loading"));
            }
        }
        Motion::Dynamic { end, .. } => {
            let increasing = times.windows(2).all(|pair| pair[0] < pair[1]);
            let inside = times.iter().all(|t| (0.0..=end * (1.0 + 1e-12)).contains(t));
            if times.is_empty() || !increasing || !inside {
                return refuse(format!("must increase within 0 … {end} s"));
            }
        }
    }
    Ok(())
}

/// Checks one solution; `instants` is the number of times.
pub(crate) fn check_solution(
    case: &Case,
    solution: &Solution,
    instants: usize,
    required: &[Quantity],
) -> Result<(), ReferenceError> {
    check_provenance(case, solution)?;
    if solution.meshes.len() < MESHES {
        return Err(ReferenceError::FewMeshes {
            case: case.name.clone(),
            code: solution.code.clone(),
            count: solution.meshes.len(),
        });
    }
    for (index, mesh) in solution.meshes.iter().enumerate() {
        check_mesh(case, &solution.code, index, mesh, instants, required)?;
    }
    Ok(())
}

fn check_provenance(case: &Case, solution: &Solution) -> Result<(), ReferenceError> {
    let mut faults: Vec<(&str, &str)> = Vec::new();
    let texts = [
        ("version", &solution.version),
        ("formulation", &solution.formulation),
        ("element", &solution.element),
        ("mesh_family", &solution.mesh_family),
        ("solver", &solution.solver),
    ];
    faults.extend(texts.iter().filter(|t| t.1.trim().is_empty()).map(|t| (t.0, "is empty")));
    if !is_date(&solution.date) {
        faults.push(("date", "is not YYYY-MM-DD"));
    }
    if solution.packages.is_empty() {
        faults.push(("packages", "is empty"));
    }
    if is_dynamic(case) && solution.time_scheme.as_deref().is_none_or(|s| s.trim().is_empty()) {
        faults.push(("time_scheme", "is missing"));
    }
    let positive = |value: f64| value > 0.0 && value.is_finite();
    for mesh in &solution.meshes {
        let counts = mesh.elements > 0 && mesh.unknowns > 0;
        if !(counts && positive(mesh.size_m) && positive(mesh.cpu_s) && mesh.peak_memory_bytes > 0)
        {
            faults.push(("meshes", "lack a positive size, count, time or memory"));
        }
        if is_dynamic(case) && !mesh.time_step_s.is_some_and(positive) {
            faults.push(("time_step_s", "is missing"));
        }
    }
    if !solution.meshes.windows(2).all(|pair| pair[0].size_m > pair[1].size_m) {
        faults.push(("meshes", "do not go from coarse to fine"));
    }
    match faults.first() {
        None => Ok(()),
        Some((field, reason)) => Err(ReferenceError::NoProvenance {
            case: case.name.clone(),
            code: solution.code.clone(),
            field: field.to_string(),
            reason: reason.to_string(),
        }),
    }
}

/// Whether a text is like 2026-11-21.
fn is_date(text: &str) -> bool {
    let shape = text.chars().map(|c| if c.is_ascii_digit() { '0' } else { c });
    shape.eq("0000-00-00".chars())
}

fn check_mesh(
    case: &Case,
    code: &str,
    index: usize,
    mesh: &Mesh,
    instants: usize,
    required: &[Quantity],
) -> Result<(), ReferenceError> {
    let (case, code) = (case.name.clone(), code.to_string());
    // Forces of obstacles are stored, but not compared.
    let known = |name: &str| {
        name.starts_with("contact/") || required.iter().any(|quantity| quantity.name == name)
    };
    if let Some(name) = mesh.values.keys().find(|name| !known(name)) {
        let quantity = name.clone();
        return Err(ReferenceError::UnknownQuantity { case, code, mesh: index, quantity });
    }
    for quantity in required {
        let name = quantity.name.clone();
        let Some(values) = mesh.values.get(&quantity.name) else {
            return Err(ReferenceError::MissingQuantity {
                case,
                code,
                mesh: index,
                quantity: name,
            });
        };
        if let Some(reason) = fault(quantity, values, instants) {
            return Err(ReferenceError::Values { case, code, mesh: index, quantity: name, reason });
        }
    }
    Ok(())
}

/// What is wrong with the numbers of a quantity.
fn fault(quantity: &Quantity, values: &Values, instants: usize) -> Option<String> {
    let lists = values.instants();
    let expected = if quantity.changes { instants } else { 1 };
    if matches!(values, Values::History(_)) != quantity.changes || lists.len() != expected {
        return Some(format!("has {} lists instead of {expected}", lists.len()));
    }
    if let Some(list) = lists.iter().find(|list| list.len() != quantity.width) {
        return Some(format!("has {} numbers instead of {}", list.len(), quantity.width));
    }
    let finite = lists.iter().all(|list| list.iter().all(|number| number.is_finite()));
    (!finite).then(|| "has a number that is not finite".to_string())
}
