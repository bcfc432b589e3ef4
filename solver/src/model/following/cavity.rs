//! Cavities, whose volume is measured, and the fluids that fill them.

use super::part::Following;
use super::pressed_surface::PressedSurface;
use crate::algebra::block_matrix::BlockMatrix;
use crate::algebra::packed::{axpy, dot};
use crate::algebra::tensor::Vector3;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::problem::{Amplitude, Cavity, Fluid, Problem};

/// Resultant of the vector areas of a closed surface over its area, at most \[–\].
const CLOSED: f64 = 1e-3;

/// A surface that encloses a volume.
#[derive(Debug, Clone)]
pub struct CavityLoad {
    surface: PressedSurface,
    /// A point of the plane of its opening \[m\]; none of a closed surface.
    opening: Option<Vector3>,
    /// V₀ \[m³\]
    volume: f64,
    fluid: Option<Fluid>,
}

/// A cavity at some displacements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CavityState {
    /// \[m³\], in a plane of the slab.
    pub volume: f64,
    /// Of its fluid; 0 where there is none \[Pa\].
    pub pressure: f64,
}

impl CavityLoad {
    pub(super) fn new(
        cavity: &Cavity,
        problem: &Problem,
        discretisation: &Discretisation,
    ) -> Result<CavityLoad, Error> {
        let name = || cavity.name.clone();
        let surface = PressedSurface::new(&cavity.part, problem, discretisation)?
            .ok_or_else(|| Error::EmptyCavity { name: name() })?;
        let (resultant, size) = surface.resultant();
        let part = resultant.norm() / size;
        if cavity.opening.is_none() && part > CLOSED {
            return Err(Error::OpenCavity { name: name(), part });
        }
        if cavity.opening.is_some() && part <= CLOSED {
            return Err(Error::ClosedCavity { name: name() });
        }
        let opening = cavity.opening;
        let components = problem.dimension.components();
        let still = vec![0.0; components * discretisation.cloud.positions.len()];
        let volume = surface.volume(opening, &still, components);
        if volume.is_nan() || volume <= 0.0 {
            return Err(Error::NoCavity { name: name(), volume });
        }
        Ok(CavityLoad { surface, opening, volume, fluid: cavity.fluid.clone() })
    }

    /// Moves its surface at rest by offsets \[component of node\] \[m\].
    pub(super) fn move_by(&mut self, offsets: &[f64], components: usize) {
        self.surface.move_by(offsets, components);
        self.volume = self.surface.volume(self.opening, &vec![0.0; offsets.len()], components);
    }

    /// At time `t` \[s\] and displacements `u` \[m\].
    pub fn state(&self, t: f64, u: &[f64], components: usize) -> CavityState {
        let volume = self.surface.volume(self.opening, u, components);
        let pressure = self.fluid.as_ref().map_or(0.0, |fluid| {
            let target = self.volume + fluid.inflow * fluid.amplitude.at(t);
            fluid.bulk_modulus * (target - volume) / self.volume
        });
        CavityState { volume, pressure }
    }

    /// Volume at rest \[m³\], in a plane of the slab.
    pub fn volume_at_rest(&self) -> f64 {
        self.volume
    }

    /// The point that its volume is counted from at displacements `u` \[m\].
    pub fn about(&self, u: &[f64], components: usize) -> Vector3 {
        self.opening.unwrap_or_else(|| self.surface.centre(u, components))
    }

    pub(super) fn is_filled(&self) -> bool {
        self.fluid.is_some()
    }

    pub(super) fn amplitude(&self) -> Option<&Amplitude> {
        self.fluid.as_ref().map(|fluid| &fluid.amplitude)
    }

    /// Adds the force of the fluid \[N\] (method book, eq. 14.8): of the pressure that follows from
    /// the volume, or of its `own` \[Pa\].
    pub(super) fn add_force(
        &self,
        (t, own): (f64, Option<f64>),
        u: &[f64],
        components: usize,
        f: &mut [f64],
    ) {
        if self.is_filled() {
            let pressure = own.unwrap_or_else(|| self.state(t, u, components).pressure);
            self.surface.add_force(pressure, u, components, f);
        }
    }

    /// Its tangent at displacements `u` \[m\], of the pressure and stiffness of its volume or of its
    /// `own`; none without a fluid.
    pub(super) fn tangent(
        &self,
        (t, own): (f64, Option<OwnFluid>),
        u: &[f64],
        components: usize,
    ) -> Option<FluidTangent> {
        let fluid = self.fluid.as_ref()?;
        let own = own.unwrap_or_else(|| OwnFluid {
            pressure: self.state(t, u, components).pressure,
            stiffness: fluid.bulk_modulus / self.volume,
        });
        let (push, slope) = self.row(u, components);
        Some(FluidTangent { own, push, slope })
    }

    /// Adds the stiffness of a pressure on its walls, as
    /// [`PressedSurface::add_stiffness_times`].
    pub(super) fn add_turning_times(
        &self,
        pressure: f64,
        uv: (&[f64], &[f64]),
        part: Following,
        components: usize,
        product: &mut [f64],
    ) {
        self.surface.add_stiffness_times(pressure, uv, part, components, product);
    }

    /// The same as entries of a matrix, as [`PressedSurface::add_stiffness`].
    pub(super) fn add_turning(
        &self,
        pressure: f64,
        u: &[f64],
        components: usize,
        matrix: &mut BlockMatrix,
    ) {
        self.surface.add_stiffness(pressure, u, components, matrix);
    }

    /// The force of a unit pressure \[N/Pa\], and ∂V/∂u \[m²\].
    pub fn row(&self, u: &[f64], components: usize) -> (Vec<f64>, Vec<f64>) {
        let (mut push, mut slope) = (vec![0.0; u.len()], vec![0.0; u.len()]);
        self.surface.add_force(1.0, u, components, &mut push);
        self.surface.add_volume_slope((self.opening, 1.0), u, components, &mut slope);
        (push, slope)
    }

    /// V₀/κ \[m³/Pa\]; none of a cavity without a fluid.
    pub fn compliance(&self) -> Option<f64> {
        self.fluid.as_ref().map(|fluid| self.volume / fluid.bulk_modulus)
    }
}

/// A pressure that is an unknown beside the displacements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnFluid {
    /// \[Pa\]
    pub pressure: f64,
    /// −∂p/∂V of the tangent \[Pa/m³\].
    pub stiffness: f64,
}

/// What of the tangent of a fluid does not depend on the direction.
#[derive(Debug, Clone)]
pub(super) struct FluidTangent {
    pub own: OwnFluid,
    /// a, the force of a unit pressure \[N/Pa\].
    push: Vec<f64>,
    /// b = ∂V/∂u \[m²\].
    slope: Vec<f64>,
}

impl FluidTangent {
    /// Adds −s a (bᵀ v) or its transpose; a and b are equal but for the quadrature, and the symmetric
    /// part is −s h hᵀ with their mean h (method book, eq. 14.9).
    pub fn add_compression_times(&self, v: &[f64], part: Following, product: &mut [f64]) {
        let FluidTangent { own: OwnFluid { stiffness, .. }, push, slope } = self;
        match part {
            Following::Transposed => axpy(product, -stiffness * dot(push, v), slope),
            Following::Symmetric => {
                let along = 0.25 * (dot(push, v) + dot(slope, v));
                axpy(product, -stiffness * along, push);
                axpy(product, -stiffness * along, slope);
            }
        }
    }
}
