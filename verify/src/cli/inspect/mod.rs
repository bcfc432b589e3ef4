//! `mtled inspect`.
#![allow(non_snake_case)]

mod text;

use crate::cli::case::{diagnose, fits, load};
use crate::cli::inspect::text::{advice, to_json, to_text};
use crate::cli::{COULD_NOT_RUN, Common, Format, print_data};
use crate::run::{Prepared, prepare};
use crate::scene::Case;
use clap::{Args, ValueEnum};
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::model::zero_energy::{ZeroEnergyModes, zero_energy_modes};
use mtled::motion::critical_time_step::{CriticalStep, critical_time_step};
use mtled::motion::internal_force::Workspace;
use rayon::prelude::*;
use std::path::PathBuf;

/// Bodies with more nodes than this are searched for zero-energy modes only
/// if that is asked for.
pub const LARGEST_SEARCH: usize = 20_000;
/// How many of the worst supports are named.
const WORST: usize = 5;

#[derive(Debug, Args)]
pub struct InspectArgs {
    /// Case file (TOML).
    case: PathBuf,
    /// Whether to look for zero-energy modes: "auto" does so up to 20 000
    /// nodes, where it takes seconds.
    #[arg(long, value_enum, default_value_t = Search::Auto)]
    modes: Search,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Search {
    Auto,
    Always,
    Never,
}

/// A number and where it belongs.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    pub value: f64,
    /// Node or quadrature point.
    pub index: usize,
    pub position: Vector3,
}

/// What can be known about a case before it is run.
pub struct Inspection<'a> {
    pub case: &'a Case,
    pub prepared: &'a Prepared,
    /// Support nodes per point: smallest and largest.
    pub support: (usize, usize),
    /// Condition of the worst moment matrices, worst first \[–\].
    pub conditions: Vec<Place>,
    /// Condition beyond which a support is refused \[–\].
    pub largest_condition: f64,
    /// Lightest and heaviest node \[kg\].
    pub masses: [Place; 2],
    /// Smallest and largest nodal spacing \[m\].
    pub spacings: [Place; 2],
    pub critical: CriticalStep,
    /// Node with the largest part in the stiffest motion, by its local spacing \[m\].
    pub weakest: Place,
    /// `None` where nobody looked.
    pub modes: Option<ZeroEnergyModes>,
}

pub fn inspect(arguments: &InspectArgs, common: &Common) -> anyhow::Result<u8> {
    let Some(case) = load(&arguments.case) else { return Ok(COULD_NOT_RUN) };
    if !fits(&case) {
        return Ok(COULD_NOT_RUN);
    }
    let shown = prepare(&case.problem).and_then(|prepared| {
        let inspection = examine(&case, &prepared, arguments.modes)?;
        Ok(match common.format {
            Format::Json => format!("{}\n", to_json(&inspection)),
            Format::Human if common.quiet => advice(&inspection).join("\n") + "\n",
            Format::Human => to_text(&inspection),
        })
    });
    match shown {
        Ok(text) => {
            print_data(&text)?;
            Ok(0)
        }
        Err(error) => {
            eprintln!("{}", diagnose(&case, &error));
            Ok(COULD_NOT_RUN)
        }
    }
}

fn examine<'a>(
    case: &'a Case,
    prepared: &'a Prepared,
    search: Search,
) -> Result<Inspection<'a>, Error> {
    let Prepared { discretisation, model, .. } = prepared;
    let sizes = || (0..discretisation.supports.len()).map(|q| discretisation.supports.row(q).len());
    let critical =
        critical_time_step(model, &vec![0.0; model.size()], 0.0, None, &mut Workspace::new(model));
    let looks = match search {
        Search::Auto => model.positions.len() <= LARGEST_SEARCH,
        Search::Always => true,
        Search::Never => false,
    };
    let modes = match looks {
        true => Some(zero_energy_modes(&case.problem, discretisation, model)?),
        false => None,
    };
    Ok(Inspection {
        case,
        prepared,
        support: (sizes().min().unwrap_or(0), sizes().max().unwrap_or(0)),
        conditions: worst_conditions(prepared),
        largest_condition: discretisation.approximation.largest_condition(),
        masses: ends(&model.lumped_mass, &model.positions),
        spacings: ends(&discretisation.cloud.spacing, &model.positions),
        weakest: weakest(prepared, &critical),
        critical,
        modes,
    })
}

fn worst_conditions(prepared: &Prepared) -> Vec<Place> {
    let discretisation = &prepared.discretisation;
    let positions = &discretisation.quadrature.positions;
    let place = |(index, X): (usize, &Vector3)| {
        let support = discretisation.approximation.evaluate(X).ok()?;
        Some(Place { value: support.condition, index, position: *X })
    };
    let mut all: Vec<Place> = positions.par_iter().enumerate().filter_map(place).collect();
    all.sort_by(|a, b| b.value.total_cmp(&a.value).then(a.index.cmp(&b.index)));
    all.truncate(WORST);
    all
}

/// Smallest and largest of a value per node, the first where several are.
fn ends(values: &[f64], positions: &[Vector3]) -> [Place; 2] {
    let place = |index: usize| Place { value: values[index], index, position: positions[index] };
    let by = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]).then(a.cmp(b));
    [
        place((0..values.len()).min_by(by).unwrap_or(0)),
        place((0..values.len()).max_by(|a, b| by(a, b)).unwrap_or(0)),
    ]
}

/// The mode is M^(1/2) u: its squares are shares of the kinetic energy.
fn weakest(prepared: &Prepared, critical: &CriticalStep) -> Place {
    let d = prepared.model.components;
    let share: Vec<f64> =
        critical.mode.chunks_exact(d).map(|part| part.iter().map(|x| x * x).sum()).collect();
    let index = (0..share.len()).max_by(|&a, &b| share[a].total_cmp(&share[b])).unwrap_or(0);
    Place {
        value: prepared.discretisation.cloud.spacing[index],
        index,
        position: prepared.model.positions[index],
    }
}
