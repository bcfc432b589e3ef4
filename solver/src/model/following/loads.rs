//! All loads that depend on displacements.

use super::cavity::{CavityLoad, OwnFluid};
use super::pressure::PressureLoad;
use super::spring::SpringLoad;
use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::problem::{Amplitude, Problem};

/// All loads of a problem that depend on displacements.
#[derive(Debug, Clone, Default)]
pub struct FollowingLoads {
    /// Pressures on the deformed surface.
    pub pressures: Vec<PressureLoad>,
    /// Elastic beds.
    pub springs: Vec<SpringLoad>,
    /// What fills cavities, and what is only measured.
    pub cavities: Vec<CavityLoad>,
}

impl FollowingLoads {
    /// Of a problem.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
    ) -> Result<FollowingLoads, Error> {
        let loads = &problem.loads;
        let pressures = loads.pressures.iter();
        let springs = loads.springs.iter();
        let cavities = loads.cavities.iter();
        Ok(FollowingLoads {
            pressures: pressures
                .map(|row| PressureLoad::new(row, problem, discretisation))
                .collect::<Result<_, _>>()?,
            springs: springs
                .map(|row| SpringLoad::new(row, problem, discretisation))
                .collect::<Result<_, _>>()?,
            cavities: cavities
                .map(|row| CavityLoad::new(row, problem, discretisation))
                .collect::<Result<_, _>>()?,
        })
    }

    /// Moves pressed surfaces and cavities at rest by offsets \[component of node\] \[m\].
    pub fn move_by(&mut self, offsets: &[f64], components: usize) {
        self.pressures.iter_mut().for_each(|load| load.move_by(offsets, components));
        self.cavities.iter_mut().for_each(|load| load.move_by(offsets, components));
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.pressures.is_empty() && self.springs.is_empty() && self.cavities.is_empty()
    }

    /// Adds their forces \[N\] at time `t` \[s\] and displacements `u` \[m\], of fluids with pressures
    /// of their own or with those of their volumes.
    pub fn add_force(
        &self,
        (t, own): (f64, Option<&[OwnFluid]>),
        u: &[f64],
        components: usize,
        f: &mut [f64],
    ) {
        self.pressures.iter().for_each(|load| load.add_force(t, u, components, f));
        self.springs.iter().for_each(|load| load.add_force(u, components, f));
        for (index, load) in self.cavities.iter().enumerate() {
            let own = own.map(|own| own[index].pressure);
            load.add_force((t, own), u, components, f);
        }
    }

    /// Whether they resist what the critical time step counts.
    pub fn is_stiff(&self) -> bool {
        !self.springs.is_empty() || self.has_fluid()
    }

    /// Whether a fluid fills a cavity.
    pub fn has_fluid(&self) -> bool {
        self.cavities.iter().any(CavityLoad::is_filled)
    }

    /// The factors over time.
    pub fn amplitudes(&self) -> impl Iterator<Item = &Amplitude> {
        let pressures = self.pressures.iter().map(|load| &load.amplitude);
        pressures.chain(self.cavities.iter().filter_map(CavityLoad::amplitude))
    }

    /// Places \[m\] and directions in which springs hold, each with a node next to it.
    pub fn held(&self) -> impl Iterator<Item = (u32, Vector3, Vector3)> {
        self.springs.iter().flat_map(SpringLoad::held)
    }

    /// Adds the springs to the diagonal of K, the mean over the components of a node \[node\] \[N/m\].
    pub fn add_to_diagonal(&self, components: usize, diagonal: &mut [f64]) {
        for (node, springs) in self.lumped_springs() {
            diagonal[node as usize] += springs.trace() / components as f64;
        }
    }

    /// The springs lumped to nodes \[N/m\], symmetric and positive; not every node has one.
    pub fn lumped_springs(&self) -> impl Iterator<Item = (u32, Matrix3)> {
        self.springs.iter().flat_map(SpringLoad::lumped)
    }
}
