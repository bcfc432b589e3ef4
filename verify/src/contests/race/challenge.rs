//! The problems of the race: the bonded block and two smooth problems.
#![allow(non_snake_case)]

use crate::accuracy::finest;
use crate::bundled::CASES;
use crate::exact::manufactured::{Family, FieldKind, Manufactured};
use crate::reference::agreement::rms_of_points;
use crate::scene::{Case, one_error, parse_case};
use crate::specimens::manufactured::{Orientation, Oriented, impose};
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use mtled::algebra::tensor::Vector3;
use mtled::material::ElasticConstants;
use mtled::problem::Problem;
use mtled_checks::measure::rms_distance;
use std::path::Path;

/// A problem of the race.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Challenge {
    /// A nearly incompressible cube between bonded plates, compressed by 20 %, with singular
    /// edges.
    BondedBlock,
    /// A manufactured solution, ν = 0.3.
    SmoothCompressible,
    /// A manufactured solution, ν = 0.49, with a pressure of the order of μ.
    SmoothNearlyIncompressible,
}

/// The solution that displacements are compared with.
#[derive(Debug)]
pub struct RaceSolution {
    /// Reference positions of the sample points \[m\].
    pub positions: Vec<Vector3>,
    /// Displacements there \[m\].
    pub displacements: Vec<[f64; 3]>,
    /// rms error of the solution itself, in the unit of the errors.
    pub uncertainty: f64,
    /// Unit of the errors per metre.
    factor: f64,
}

impl RaceSolution {
    /// rms distance of `displacements` \[m\] from the solution, in the unit of the errors.
    pub fn error(&self, displacements: &[[f64; 3]]) -> f64 {
        self.factor * rms_distance(displacements, &self.displacements)
    }
}

/// The sample points of smooth problems are the centres of this many cells per edge. It shares
/// no factor with the meshes, whose errors are smallest or largest at special points.
const MIDDLES: usize = 13;

impl Challenge {
    /// As it is written on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Challenge::BondedBlock => "bonded_block",
            Challenge::SmoothCompressible => "smooth_compressible",
            Challenge::SmoothNearlyIncompressible => "smooth_nearly_incompressible",
        }
    }

    /// Name in tables.
    pub fn title(self) -> &'static str {
        match self {
            Challenge::BondedBlock => "Bonded block",
            Challenge::SmoothCompressible => "Smooth field, ν = 0.3",
            Challenge::SmoothNearlyIncompressible => "Smooth field, ν = 0.49",
        }
    }

    /// Unit of the errors: absolute for the block, relative to the rms displacement for the
    /// others.
    pub fn unit(self) -> &'static str {
        if self == Challenge::BondedBlock { "mm" } else { "%" }
    }

    /// Errors at which costs are compared, in their unit.
    pub fn levels(self) -> &'static [f64] {
        if self == Challenge::BondedBlock { &[0.4, 0.2] } else { &[1.0, 0.5, 0.25, 0.1] }
    }

    /// Earlier error and neighbour visits of Newton's method with 8 spacings along an edge,
    /// for the regression checks. They are not part of `reports/baseline.json`, which stores
    /// the checks of `mtled verify` only.
    pub fn earlier_figures(self) -> (f64, f64) {
        match self {
            Challenge::BondedBlock => (0.2146, 3.549e6),
            Challenge::SmoothCompressible => (0.3049, 0.4724e6),
            Challenge::SmoothNearlyIncompressible => (0.2865, 2.473e6),
        }
    }

    /// Edge of the cube \[m\].
    pub fn edge(self) -> f64 {
        if self == Challenge::BondedBlock { 0.1 } else { 1.0 }
    }

    /// The problem with the default recipe.
    pub fn problem(self) -> Result<Problem> {
        let Some(solution) = self.manufactured()? else { return Ok(bonded_block()?.problem) };
        let mut problem = parse(SMOOTH, "smooth")?.problem;
        impose(&mut problem, Oriented::new(solution, Orientation::Along))?;
        Ok(problem)
    }

    /// The exact solution, or a finite-element solution on the finest mesh.
    pub fn solution(self) -> Result<RaceSolution> {
        match self.manufactured()? {
            Some(solution) => Ok(exact(&solution)),
            None => finest_field(),
        }
    }

    fn manufactured(self) -> Result<Option<Manufactured>> {
        let (field, family, poisson_ratio) = match self {
            Challenge::BondedBlock => return Ok(None),
            Challenge::SmoothCompressible => (FieldKind::General, Family::LogJ, 0.3),
            Challenge::SmoothNearlyIncompressible => {
                (FieldKind::NearlyIsochoric, Family::Isochoric, 0.49)
            }
        };
        let constants = ElasticConstants::from_young_poisson(3000.0, poisson_ratio)?;
        Ok(Some(Manufactured { field, family, constants, density: 1000.0 }))
    }
}

fn bonded_block() -> Result<Case> {
    let name = Challenge::BondedBlock.name();
    let bundled = CASES.iter().find(|(case, _)| *case == name);
    let (_, text) = bundled.with_context(|| format!("there is no case {name}"))?;
    parse(text, name)
}

/// Everything about the discretisation that is not stated is the default.
const SMOOTH: &str = r#"
title = "Smooth field"
description = "A cube whose boundary follows a given field, under the body force that belongs to it."
source = "reference/manufactured/derive.py"

[geometry]
shape = { box = { min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0] } }

[material.solid]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 3000.0
poisson_ratio = 0.3

[discretisation]
cloud = "regular"
spacing = 0.125

[[prescribe]]
name = "boundary"
of = "surface"
where = "all"
displacement = { x = 0.0, y = 0.0, z = 0.0 }
amplitude = { smooth = { duration = 1.0 } }

[time]
method = "static"

[[probe]]
name = "middle"
point = [0.5, 0.5, 0.5]
"#;

fn parse(text: &str, name: &str) -> Result<Case> {
    parse_case(text, name, Path::new(".")).map_err(one_error)
}

/// Errors are in per cent of the rms displacement.
fn exact(solution: &Manufactured) -> RaceSolution {
    let middle = |index: usize| ((index % MIDDLES) as f64 + 0.5) / MIDDLES as f64;
    let positions: Vec<Vector3> = (0..MIDDLES.pow(3))
        .map(|n| Vector3::new(middle(n), middle(n / MIDDLES), middle(n / MIDDLES / MIDDLES)))
        .collect();
    let displacements: Vec<[f64; 3]> =
        positions.iter().map(|X| solution.displacement(X).into()).collect();
    let zero = vec![[0.0; 3]; displacements.len()];
    let factor = 100.0 / rms_distance(&displacements, &zero);
    RaceSolution { positions, displacements, uncertainty: 0.0, factor }
}

/// The solution on the finest mesh; errors are in mm.
fn finest_field() -> Result<RaceSolution> {
    let case = bonded_block()?;
    let Some(finest) = finest(&case)? else {
        bail!("reference/race/bonded_block.json belongs to another problem; compute it again");
    };
    let probe = finest.quantity.rsplit('/').next().unwrap_or_default();
    let lattice = case.probes.iter().find(|found| found.name == probe);
    let positions = lattice.context("the block has no lattice")?.kind.positions();
    let displacements = triples(&finest.values);
    if displacements.len() != positions.len() {
        bail!("reference/race/bonded_block.json has another lattice than the case");
    }
    let uncertainty = 1e3 * rms_of_points(&finest.errors, 3);
    Ok(RaceSolution { positions, displacements, uncertainty, factor: 1e3 })
}

/// A flat list as vectors.
pub fn triples(numbers: &[f64]) -> Vec<[f64; 3]> {
    numbers.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_solution_is_more_accurate_than_the_errors_at_which_costs_are_compared() {
        for &challenge in Challenge::value_variants() {
            let solution = challenge.solution().unwrap();
            assert_eq!(solution.positions.len(), solution.displacements.len());
            assert_eq!(solution.error(&solution.displacements), 0.0);
            let finest = challenge.levels().iter().copied().fold(f64::INFINITY, f64::min);
            assert!(solution.uncertainty < 0.5 * finest, "{challenge:?}: {}", solution.uncertainty);
        }
    }

    #[test]
    fn an_error_is_in_millimetres_for_the_block_and_in_per_cent_for_smooth_fields() {
        for (challenge, expected) in
            [(Challenge::BondedBlock, 2.0), (Challenge::SmoothCompressible, 1.0)]
        {
            let solution = challenge.solution().unwrap();
            let moved: Vec<[f64; 3]> = match challenge {
                Challenge::BondedBlock => {
                    solution.displacements.iter().map(|u| [u[0], u[1] + 0.002, u[2]]).collect()
                }
                _ => solution.displacements.iter().map(|u| u.map(|u| 1.01 * u)).collect(),
            };
            assert!((solution.error(&moved) - expected).abs() < 1e-9);
        }
    }
}
