//! Meshes that have been solved again, compared with the stored ones.

use super::agreement::scales;
use super::format::ReferenceFile;
use crate::scene::Case;

/// Allowed change of values from machine to machine, relative to the largest value of
/// their kind in the case \[–\].
pub const TOLERANCE: f64 = 1e-6;

/// The largest change of a mesh, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshChange {
    /// Name of the code.
    pub code: String,
    /// Number of elements of the mesh.
    pub elements: u64,
    /// Its key in a reference file.
    pub quantity: String,
    /// Relative to the largest number of the kind \[–\].
    pub relative: f64,
}

/// Compares every mesh of `again` with the stored mesh of the same code and
/// number of elements. The error says what has no counterpart.
pub fn compare(
    case: &Case,
    stored: &ReferenceFile,
    again: &ReferenceFile,
) -> Result<Vec<MeshChange>, String> {
    let scales = scales(case, stored);
    let mut changes = Vec::new();
    for solution in &again.solutions {
        let known = stored.solutions.iter().find(|known| known.code == solution.code);
        for mesh in &solution.meshes {
            let counterpart = known.and_then(|known| {
                known.meshes.iter().find(|other| other.elements == mesh.elements)
            });
            let counterpart = counterpart.ok_or_else(|| {
                format!(
                    "{}: nothing is stored of {} with {} elements",
                    case.name, solution.code, mesh.elements
                )
            })?;
            let mut worst = MeshChange {
                code: solution.code.clone(),
                elements: mesh.elements,
                quantity: String::new(),
                relative: 0.0,
            };
            for quantity in super::quantities(case) {
                let name = &quantity.name;
                let (Some(new), Some(old)) = (mesh.values.get(name), counterpart.values.get(name))
                else {
                    return Err(format!("{}: {name} is missing", case.name));
                };
                let (new, old) = (new.flat(), old.flat());
                if new.len() != old.len() {
                    return Err(format!("{}: {name} has another length", case.name));
                }
                let differences = new.iter().zip(&old).map(|(a, b)| (a - b).abs());
                let relative = differences.fold(0.0, f64::max) / scales[&quantity.family];
                if relative > worst.relative || worst.quantity.is_empty() {
                    worst = MeshChange { quantity: quantity.name, relative, ..worst };
                }
            }
            changes.push(worst);
        }
    }
    Ok(changes)
}
