//! What is raced: the bonded block and two smooth problems.
#![allow(non_snake_case)]

use crate::accuracy::finest;
use crate::bundled::CASES;
use crate::exact::manufactured::{Family, FieldKind, Manufactured};
use crate::reference::agreement::rms_of_points;
use crate::scene::{Case, one_error, parse_case};
use crate::specimens::manufactured::{Place, Placed, impose};
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
    /// A nearly incompressible cube between bonded plates, 20 % shorter: its
    /// edges are singular.
    BondedBlock,
    /// A manufactured field, ν = 0.3.
    SmoothCompressible,
    /// A manufactured field, ν = 0.49, pressure of the order of μ.
    SmoothNearlyIncompressible,
}

/// Where displacements are compared, and what they should be.
#[derive(Debug)]
pub struct Truth {
    /// \[m\]
    pub places: Vec<Vector3>,
    /// \[m\]
    pub displacements: Vec<[f64; 3]>,
    /// In the unit of the errors.
    pub uncertainty: f64,
    /// From metres to the unit of the errors.
    factor: f64,
}

impl Truth {
    /// rms distance of `displacements` \[m\] from the truth, in the unit of the
    /// errors.
    pub fn error(&self, displacements: &[[f64; 3]]) -> f64 {
        self.factor * rms_distance(displacements, &self.displacements)
    }
}

/// Probes of smooth problems: the middles of this many cells per edge. It shares no
/// factor with the meshes, which are best or worst at places of their own.
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

    pub fn title(self) -> &'static str {
        match self {
            Challenge::BondedBlock => "Bonded block",
            Challenge::SmoothCompressible => "Smooth field, ν = 0.3",
            Challenge::SmoothNearlyIncompressible => "Smooth field, ν = 0.49",
        }
    }

    /// Unit of the errors: the block's are absolute, the others relative to the
    /// rms of the displacement.
    pub fn unit(self) -> &'static str {
        if self == Challenge::BondedBlock { "mm" } else { "%" }
    }

    /// Errors at which costs are compared, in their unit.
    pub fn levels(self) -> &'static [f64] {
        if self == Challenge::BondedBlock { &[0.4, 0.2] } else { &[1.0, 0.5, 0.25] }
    }

    /// What Newton's method with 8 spacings along an edge had for an error and for
    /// neighbour visits: the regression checks of the race.
    pub fn earlier(self) -> (f64, f64) {
        match self {
            Challenge::BondedBlock => (0.1670, 7.948e6),
            Challenge::SmoothCompressible => (0.3765, 0.4447e6),
            Challenge::SmoothNearlyIncompressible => (0.2953, 6.086e6),
        }
    }

    /// Edge of the cube \[m\].
    pub fn edge(self) -> f64 {
        if self == Challenge::BondedBlock { 0.1 } else { 1.0 }
    }

    /// The problem at the default recipe.
    pub fn pose(self) -> Result<Problem> {
        let Some(solution) = self.solution()? else { return Ok(bonded_block()?.problem) };
        let mut problem = parse(SMOOTH, "smooth")?.problem;
        impose(&mut problem, Placed::new(solution, Place::Along))?;
        Ok(problem)
    }

    pub fn truth(self) -> Result<Truth> {
        match self.solution()? {
            Some(solution) => Ok(exact(&solution)),
            None => finest_field(),
        }
    }

    fn solution(self) -> Result<Option<Manufactured>> {
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
    let carried = CASES.iter().find(|(case, _)| *case == name);
    let (_, text) = carried.with_context(|| format!("there is no case {name}"))?;
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

/// Errors in per cent of the rms displacement.
fn exact(solution: &Manufactured) -> Truth {
    let middle = |index: usize| ((index % MIDDLES) as f64 + 0.5) / MIDDLES as f64;
    let places: Vec<Vector3> = (0..MIDDLES.pow(3))
        .map(|n| Vector3::new(middle(n), middle(n / MIDDLES), middle(n / MIDDLES / MIDDLES)))
        .collect();
    let displacements: Vec<[f64; 3]> =
        places.iter().map(|X| solution.displacement(X).into()).collect();
    let nothing = vec![[0.0; 3]; displacements.len()];
    let factor = 100.0 / rms_distance(&displacements, &nothing);
    Truth { places, displacements, uncertainty: 0.0, factor }
}

/// The finest field, errors in mm.
fn finest_field() -> Result<Truth> {
    let case = bonded_block()?;
    let Some(finest) = finest(&case)? else {
        bail!("reference/race/bonded_block.json belongs to another problem; make it anew");
    };
    let probe = finest.quantity.rsplit('/').next().unwrap_or_default();
    let lattice = case.probes.iter().find(|found| found.name == probe);
    let places = lattice.context("the block has no lattice")?.kind.positions();
    let displacements = triples(&finest.values);
    if displacements.len() != places.len() {
        bail!("reference/race/bonded_block.json has another lattice than the case");
    }
    let uncertainty = 1e3 * rms_of_points(&finest.errors, 3);
    Ok(Truth { places, displacements, uncertainty, factor: 1e3 })
}

/// A flat list as vectors.
pub fn triples(numbers: &[f64]) -> Vec<[f64; 3]> {
    numbers.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_truth_is_known_better_than_the_errors_at_which_costs_are_compared() {
        for &challenge in Challenge::value_variants() {
            let truth = challenge.truth().unwrap();
            assert_eq!(truth.places.len(), truth.displacements.len());
            assert_eq!(truth.error(&truth.displacements), 0.0);
            let finest = challenge.levels().iter().copied().fold(f64::INFINITY, f64::min);
            assert!(truth.uncertainty < 0.5 * finest, "{challenge:?}: {}", truth.uncertainty);
        }
    }

    #[test]
    fn an_error_is_in_millimetres_for_the_block_and_in_per_cent_for_smooth_fields() {
        for (challenge, expected) in
            [(Challenge::BondedBlock, 2.0), (Challenge::SmoothCompressible, 1.0)]
        {
            let truth = challenge.truth().unwrap();
            let moved: Vec<[f64; 3]> = match challenge {
                Challenge::BondedBlock => {
                    truth.displacements.iter().map(|u| [u[0], u[1] + 0.002, u[2]]).collect()
                }
                _ => truth.displacements.iter().map(|u| u.map(|u| 1.01 * u)).collect(),
            };
            assert!((truth.error(&moved) - expected).abs() < 1e-9);
        }
    }
}
