//! What is known about a case before it is run.
#![allow(non_snake_case)]

use clap::ValueEnum;
use mtled::Simulation;
use mtled::algebra::tensor::Vector3;
use mtled::error::Error;
use mtled::force::Workspace;
use mtled::model::zero_energy::{ZeroEnergyModes, zero_energy_modes};
use mtled::motion::critical_time_step::{CriticalStep, critical_time_step};
use mtled::motion::newton::{InfSup, inf_sup};
use mtled_case::scene::Case;
use mtled_run::machine::peak_memory;
use rayon::prelude::*;

/// Bodies with more nodes than this are searched for zero-energy modes only on request.
pub(crate) const LARGEST_SEARCH: usize = 20_000;
/// Number of the worst supports that are listed.
const WORST: usize = 5;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Search {
    Auto,
    Always,
    Never,
}

/// A number and its place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub value: f64,
    /// Node or quadrature point.
    pub index: usize,
    pub position: Vector3,
}

/// What is known about a case before it is run.
pub(crate) struct Inspection<'a> {
    pub case: &'a Case,
    pub simulation: &'a Simulation,
    /// Smallest and largest number of nodes per support.
    pub support: (usize, usize),
    /// Largest condition numbers of the moment matrices, the largest first \[–\].
    pub conditions: Vec<Place>,
    /// Condition number beyond which a support is refused \[–\].
    pub largest_condition: f64,
    /// Lightest and heaviest node \[kg\].
    pub masses: [Place; 2],
    /// Smallest and largest nodal spacing \[m\].
    pub spacings: [Place; 2],
    pub critical: CriticalStep,
    /// Node with the largest part of the stiffest mode, with its local spacing \[m\].
    pub weakest: Place,
    /// Largest memory before zero-energy modes were searched for \[bytes\].
    pub peak: Option<u64>,
    /// None where they were not searched for.
    pub modes: Option<ZeroEnergyModes>,
    /// None where it was not looked for, or no pressure of a patch counts.
    pub inf_sup: Option<InfSup>,
}

/// Examines a case without running it.
pub(crate) fn examine<'a>(
    case: &'a Case,
    simulation: &'a Simulation,
    search: Search,
) -> Result<Inspection<'a>, Error> {
    let Simulation { discretisation, model, .. } = simulation;
    let sizes = || (0..discretisation.supports.len()).map(|q| discretisation.supports.row(q).len());
    let critical = critical_time_step(
        model,
        &vec![0.0; model.size()],
        0.0,
        None,
        &mut Workspace::new(&model.points),
    );
    let peak = peak_memory();
    let searched = match search {
        Search::Auto => model.positions.len() <= LARGEST_SEARCH,
        Search::Always => true,
        Search::Never => false,
    };
    let modes = if searched {
        Some(zero_energy_modes(&case.problem, discretisation, model)?)
    } else {
        None
    };
    Ok(Inspection {
        case,
        simulation,
        support: (sizes().min().unwrap_or(0), sizes().max().unwrap_or(0)),
        conditions: worst_conditions(simulation),
        largest_condition: discretisation.approximation.largest_condition(),
        masses: ends(&model.lumped_mass, &model.positions),
        spacings: ends(&discretisation.cloud.spacing, &model.positions),
        weakest: weakest(simulation, &critical),
        critical,
        peak,
        modes,
        inf_sup: searched.then(|| inf_sup(model)).flatten(),
    })
}

fn worst_conditions(simulation: &Simulation) -> Vec<Place> {
    let discretisation = &simulation.discretisation;
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

/// Smallest and largest of one value per node, the first node where several have it.
fn ends(values: &[f64], positions: &[Vector3]) -> [Place; 2] {
    let place = |index: usize| Place { value: values[index], index, position: positions[index] };
    let by = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]).then(a.cmp(b));
    [
        place((0..values.len()).min_by(by).unwrap_or(0)),
        place((0..values.len()).max_by(|a, b| by(a, b)).unwrap_or(0)),
    ]
}

/// The mode is M^(1/2) u, whose squares are fractions of the kinetic energy.
fn weakest(simulation: &Simulation, critical: &CriticalStep) -> Place {
    let d = simulation.model.components;
    let fractions: Vec<f64> =
        critical.mode.chunks_exact(d).map(|part| part.iter().map(|x| x * x).sum()).collect();
    let index =
        (0..fractions.len()).max_by(|&a, &b| fractions[a].total_cmp(&fractions[b])).unwrap_or(0);
    Place {
        value: simulation.discretisation.cloud.spacing[index],
        index,
        position: simulation.model.positions[index],
    }
}
