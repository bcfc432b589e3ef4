//! The part of a body that a body force acts on.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::{Discretisation, Rows, quadrature_of};
use crate::error::Error;
use crate::geometry::Selector;
use crate::problem::{Problem, Region};

/// Points of a part of a body that ends at its outline.
pub struct LoadedVolume {
    /// \[point\] \[m\]
    pub positions: Vec<Vector3>,
    /// \[point\] \[kg\]
    pub masses: Vec<f64>,
    /// φ at the points.
    pub rows: Rows,
}

impl LoadedVolume {
    /// Of a selection; the cells of the background grid that its outline cuts are divided.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
        part: &Selector,
    ) -> Result<LoadedVolume, Error> {
        let regions = divided(&problem.regions, part);
        let body = problem.body.section(&problem.dimension)?;
        let grid = &problem.recipe.grid;
        let approximation = &discretisation.approximation;
        let all = quadrature_of(problem, &regions, (&body, grid), approximation, None)?;
        let (mut positions, mut masses) = (Vec::new(), Vec::new());
        for ((X, weight), region) in all.positions.iter().zip(&all.weights).zip(&all.regions) {
            if let Some(region) = problem.regions.get(*region as usize) {
                positions.push(*X);
                masses.push(weight * region.material.density);
            }
        }
        let rows = discretisation.rows_at(&positions)?;
        Ok(LoadedVolume { positions, masses, rows })
    }
}

/// The part within each region, then the rest.
fn divided(regions: &[Region], part: &Selector) -> Vec<Region> {
    let within = |region: &Region| Region {
        part: Selector::Intersection(vec![region.part.clone(), part.clone()]),
        ..region.clone()
    };
    let rest = |region: &Region| Region { part: Selector::All, ..region.clone() };
    regions.iter().map(within).chain(regions.last().map(rest)).collect()
}
