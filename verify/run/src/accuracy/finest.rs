//! A field of the bonded block on a finer mesh than the reference has.

use anyhow::{Context, Result};
use mtled_case::bundled::bundled_reference;
use mtled_case::reference::read_reference;
use mtled_case::scene::Case;
use serde::Deserialize;

/// The probe of the block at which displacements are compared.
const LATTICE: &str = "lattice";

/// `reference/finest/bonded_block.json`: the finest mesh.
#[derive(Debug, Deserialize)]
struct Stored {
    problem_hash: String,
    code: String,
    element: String,
    /// Size of the cells of the finest mesh in `reference/data` over its own \[–\].
    refinement: f64,
    /// x, y, z of each position of the case's lattice in turn.
    displacement_m: Vec<f64>,
}

/// Displacements of a quantity, x, y, z of each position in turn.
#[derive(Debug)]
pub(crate) struct FinestField {
    /// Its key in a reference file.
    pub quantity: String,
    /// \[m\]
    pub values: Vec<f64>,
    /// Error bars \[m\].
    pub errors: Vec<f64>,
    /// Code and element.
    pub source: String,
}

/// The finest field of a case, if one is stored for exactly this problem. At the bonded
/// edges no element converges faster than with order 1, so that the error bar is
/// |f₁ − f₂|/(r − 1) after the last refinement by r.
pub(crate) fn finest(case: &Case) -> Result<Option<FinestField>> {
    let stored: Stored = serde_json::from_str(mtled_reference::FINEST_BLOCK)
        .context("reference/finest/bonded_block.json")?;
    if stored.problem_hash != case.problem_hash {
        return Ok(None);
    }
    let quantity = format!("displacement/{LATTICE}");
    let coarser = bundled_reference("bonded_block").context("the block has no reference")?;
    let coarser = read_reference(case, coarser)?;
    let solution = coarser.solutions.iter().find(|solution| solution.code == stored.code);
    let mesh = solution.and_then(|solution| solution.meshes.last());
    let coarser = mesh.and_then(|mesh| mesh.values.get(&quantity));
    let coarser = coarser.context("the reference lacks the lattice")?.flat();
    let factor = 1.0 / (stored.refinement - 1.0);
    let pairs = stored.displacement_m.iter().zip(&coarser);
    Ok(Some(FinestField {
        errors: pairs.map(|(a, b)| factor * (a - b).abs()).collect(),
        quantity,
        source: format!("{}, {}", stored.code, stored.element),
        values: stored.displacement_m,
    }))
}
