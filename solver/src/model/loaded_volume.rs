//! The part of a body that a body force acts on.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::{Discretisation, Rows, quadrature_of};
use crate::error::Error;
use crate::geometry::Selector;
use crate::problem::{Problem, Region};

/// Edge of the smallest part that cells resolve \[spacing\].
const RESOLVED: f64 = 0.2;

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
    /// Of a selection, that of a body force by its number; the cells of the background grid that its outline cuts are divided.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
        (index, part): (usize, &Selector),
    ) -> Result<LoadedVolume, Error> {
        let regions = divided(&problem.regions, part);
        let body = problem.body.section(&problem.dimension)?;
        let grid = &problem.recipe.grid;
        let approximation = &discretisation.approximation;
        let all = quadrature_of(problem, &regions, (&body, grid), approximation, None)?;
        let (mut positions, mut masses, mut volume) = (Vec::new(), Vec::new(), 0.0);
        for ((X, weight), region) in all.positions.iter().zip(&all.weights).zip(&all.regions) {
            if let Some(region) = problem.regions.get(*region as usize) {
                positions.push(*X);
                volume += weight;
                masses.push(weight * region.material.density);
            }
        }
        let smallest = smallest_volume(discretisation);
        if volume > 0.0 && volume < smallest {
            return Err(Error::SmallBodyForce { index, volume, smallest });
        }
        let rows = discretisation.rows_at(&positions)?;
        Ok(LoadedVolume { positions, masses, rows })
    }
}

/// Of a smaller part with curved sides the volume is not known to 0.5 % \[m³\].
fn smallest_volume(discretisation: &Discretisation) -> f64 {
    let edge = RESOLVED * discretisation.cloud.smallest_spacing();
    let dimension = &discretisation.dimension;
    dimension.thickness() * edge.powi(dimension.components() as i32)
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
