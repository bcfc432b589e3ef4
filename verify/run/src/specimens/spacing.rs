//! Cases on clouds of another spacing.

use anyhow::{Context, Result};
use mtled::problem::Problem;
use mtled_case::scene::Case;

/// Node spacing \[m\] of a recipe; the largest of a graded cloud.
pub fn spacing_of(problem: &Problem) -> Result<f64> {
    problem.recipe.spacing().context("nodes given one by one have no spacing to change")
}

/// The same case with every length of its recipe scaled to another spacing \[m\].
pub fn respaced(case: &Case, spacing: f64) -> Result<Case> {
    let factor = spacing / spacing_of(&case.problem)?;
    let mut case = case.clone();
    case.problem.recipe.scale_lengths(factor);
    Ok(case)
}
