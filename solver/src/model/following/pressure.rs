//! Pressures on the deformed surface.

use super::part::Following;
use super::pressed_surface::PressedSurface;
use crate::algebra::block_matrix::BlockMatrix;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::problem::{Amplitude, Pressure, Problem};

/// A pressure that acts along the inward normal of the deformed surface.
#[derive(Debug, Clone)]
pub struct PressureLoad {
    /// At amplitude 1 \[Pa\].
    pub pressure: f64,
    /// The factor over time.
    pub amplitude: Amplitude,
    surface: PressedSurface,
}

impl PressureLoad {
    pub(super) fn new(
        pressure: &Pressure,
        problem: &Problem,
        discretisation: &Discretisation,
    ) -> Result<PressureLoad, Error> {
        let surface = PressedSurface::new(&pressure.part, problem, discretisation)?
            .ok_or_else(|| Error::EmptyPressure { name: pressure.name.clone() })?;
        let amplitude = pressure.amplitude.clone();
        Ok(PressureLoad { pressure: pressure.pressure, amplitude, surface })
    }

    /// Adds the force \[N\] at time `t` \[s\] and displacements `u` \[m\].
    pub fn add_force(&self, t: f64, u: &[f64], components: usize, f: &mut [f64]) {
        let pressure = self.pressure * self.amplitude.at(t);
        if pressure != 0.0 {
            self.surface.add_force(pressure, u, components, f);
        }
    }

    /// Moves its surface at rest by offsets \[component of node\] \[m\].
    pub(super) fn move_by(&mut self, offsets: &[f64], components: usize) {
        self.surface.move_by(offsets, components);
    }

    pub(super) fn add_stiffness_times(
        &self,
        t: f64,
        uv: (&[f64], &[f64]),
        part: Following,
        components: usize,
        product: &mut [f64],
    ) {
        let pressure = self.pressure * self.amplitude.at(t);
        if pressure != 0.0 {
            self.surface.add_stiffness_times(pressure, uv, part, components, product);
        }
    }

    pub(super) fn add_stiffness(
        &self,
        t: f64,
        u: &[f64],
        components: usize,
        matrix: &mut BlockMatrix,
    ) {
        let pressure = self.pressure * self.amplitude.at(t);
        if pressure != 0.0 {
            self.surface.add_stiffness(pressure, u, components, matrix);
        }
    }
}
