//! Pressures on the deformed surface.
#![allow(non_snake_case)]

use crate::algebra::real::Dual;
use crate::algebra::tensor::{Matrix3, Vector3, cofactor, map, tensor_cofactor};
use crate::discretisation::{Discretisation, Rows};
use crate::error::Error;
use crate::geometry::Panel;
use crate::model::loaded_part::LoadedPart;
use crate::problem::{Amplitude, Pressure, Problem};

/// A pressure that acts along the inward normal of the deformed surface.
#[derive(Debug, Clone)]
pub struct PressureLoad {
    /// At amplitude 1 \[Pa\].
    pub pressure: f64,
    /// The factor over time.
    pub amplitude: Amplitude,
    /// φ and Grad φ at the points of the surface.
    rows: Rows,
    /// Vector area A_i N_i of each point \[m²\].
    areas: Vec<Vector3>,
}

/// All pressures of a problem.
pub fn pressure_loads(
    problem: &Problem,
    discretisation: &Discretisation,
) -> Result<Vec<PressureLoad>, Error> {
    let load = |pressure: &Pressure| PressureLoad::new(pressure, problem, discretisation);
    problem.loads.pressures.iter().map(load).collect()
}

/// Which part of the stiffness of a pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Following {
    /// ½(K + Kᵀ), which conjugate gradients take.
    Symmetric,
    /// Kᵀ.
    Transposed,
}

impl PressureLoad {
    fn new(
        pressure: &Pressure,
        problem: &Problem,
        discretisation: &Discretisation,
    ) -> Result<PressureLoad, Error> {
        let Some(loaded) = LoadedPart::new(problem, discretisation, &pressure.part)? else {
            return Err(Error::EmptyPressure { name: pressure.name.clone() });
        };
        let nodes = discretisation.cloud.positions.len();
        let all = discretisation.loaded_surface().strengths(nodes, |_, panel| panel.mean_normal());
        let closed = discretisation.closed_areas();
        let part = loaded.strengths(nodes, Panel::mean_normal);
        // What closes the whole boundary belongs to the part as far as the point does.
        let area = |point: usize| {
            let Some((whole, fraction)) = loaded.point_of_whole(point) else { return part[point] };
            let fraction = fraction
                .unwrap_or_else(|| part[point].dot(&all[whole]) / all[whole].norm_squared());
            if fraction.is_finite() {
                part[point] + fraction * (closed[whole] - all[whole])
            } else {
                part[point]
            }
        };
        let points = (0..part.len()).filter(|&point| part[point] != Vector3::zeros());
        let points: Vec<usize> = points.collect();
        let positions = loaded.rule().positions();
        let positions: Vec<Vector3> = points.iter().map(|&point| positions[point]).collect();
        Ok(PressureLoad {
            pressure: pressure.pressure,
            amplitude: pressure.amplitude.clone(),
            rows: discretisation.rows_at(&positions)?,
            areas: points.into_iter().map(area).collect(),
        })
    }

    /// Adds f_a = −p Σ_i φ_a(X_i) cof F(X_i) A_i N_i \[N\] at time `t` \[s\] and
    /// displacements `u` \[m\] (method book, eq. 14.4).
    pub fn add_force(&self, t: f64, u: &[f64], components: usize, f: &mut [f64]) {
        let pressure = self.pressure * self.amplitude.at(t);
        if pressure == 0.0 {
            return;
        }
        for (point, area) in self.areas.iter().enumerate() {
            let F = self.rows.deformation_gradient(point, u, components);
            let force = cofactor(&F) * area * -pressure;
            for entry in self.rows.row(point) {
                let node = self.rows.nodes[entry] as usize;
                for k in 0..components {
                    f[components * node + k] += self.rows.phi[entry] * force[k];
                }
            }
        }
    }

    /// Adds ½(K + Kᵀ) v or Kᵀ v \[N\] with K = ∂f/∂u of [`Self::add_force`] (method book,
    /// eq. 14.5). K is symmetric where the rim of the surface is held or there is none; elsewhere
    /// the rest of it lies along the rim.
    pub fn add_stiffness_times(
        &self,
        t: f64,
        (u, v): (&[f64], &[f64]),
        part: Following,
        components: usize,
        product: &mut [f64],
    ) {
        let pressure = self.pressure * self.amplitude.at(t);
        if pressure == 0.0 {
            return;
        }
        let (own, other) = match part {
            Following::Symmetric => (0.5, 0.5),
            Following::Transposed => (0.0, 1.0),
        };
        for (point, area) in self.areas.iter().enumerate() {
            let F = self.rows.deformation_gradient(point, u, components);
            let dF = self.rows.gradient(point, v, components);
            let V = self.rows.interpolate(point, v, components);
            let force = cofactor_slope(&F, &dF) * area * (-own * pressure);
            let stress = cofactor_slope(&F, &(V * area.transpose())) * (-other * pressure);
            for entry in self.rows.row(point) {
                let node = self.rows.nodes[entry] as usize;
                let along = self.rows.phi[entry] * force + stress * self.rows.grad_phi[entry];
                for k in 0..components {
                    product[components * node + k] += along[k];
                }
            }
        }
    }
}

/// Derivative of cof F along `direction`; as a bilinear form of both it is symmetric.
fn cofactor_slope(F: &Matrix3, direction: &Matrix3) -> Matrix3 {
    let dual = map(|i, j| Dual { value: F[(i, j)], slope: direction[(i, j)] });
    let cof = tensor_cofactor(&dual);
    Matrix3::from_fn(|i, j| cof[i][j].slope)
}
