//! The part of the deformed surface that a pressure acts on.
#![allow(non_snake_case)]

use super::part::Following;
use crate::algebra::block_matrix::BlockMatrix;
use crate::algebra::real::Dual;
use crate::algebra::tensor::{Matrix3, Vector3, cofactor, map, tensor_cofactor};
use crate::discretisation::{Discretisation, Rows};
use crate::error::Error;
use crate::geometry::{Panel, Selector};
use crate::model::loaded_part::LoadedPart;
use crate::problem::Problem;

/// A part of the deformed surface.
#[derive(Debug, Clone)]
pub(super) struct PressedSurface {
    /// φ and Grad φ at the points of the surface.
    rows: Rows,
    /// Reference positions of the points \[m\].
    positions: Vec<Vector3>,
    /// Vector area A_i N_i of each point \[m²\].
    areas: Vec<Vector3>,
}

impl PressedSurface {
    /// Of a selection; nothing where it covers nothing.
    pub fn new(
        part: &Selector,
        problem: &Problem,
        discretisation: &Discretisation,
    ) -> Result<Option<PressedSurface>, Error> {
        let Some(loaded) = LoadedPart::new(problem, discretisation, part)? else {
            return Ok(None);
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
        Ok(Some(PressedSurface {
            rows: discretisation.rows_at(&positions)?,
            positions,
            areas: points.into_iter().map(area).collect(),
        }))
    }

    /// Adds f_a = −p Σ_i φ_a(X_i) cof F(X_i) A_i N_i \[N\] of a pressure \[Pa\] at displacements `u`
    /// \[m\] (method book, eq. 14.4).
    pub fn add_force(&self, pressure: f64, u: &[f64], components: usize, f: &mut [f64]) {
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
        pressure: f64,
        (u, v): (&[f64], &[f64]),
        part: Following,
        components: usize,
        product: &mut [f64],
    ) {
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

    /// Adds ½(K + Kᵀ) of [`Self::add_stiffness_times`] to a matrix of nodes.
    pub fn add_stiffness(
        &self,
        pressure: f64,
        u: &[f64],
        components: usize,
        matrix: &mut BlockMatrix,
    ) {
        let mut functions: Vec<(u32, (f64, Matrix3))> = Vec::new();
        for (point, area) in self.areas.iter().enumerate() {
            let F = self.rows.deformation_gradient(point, u, components);
            // What a gradient of each component turns and stretches of the area \[l\]: columns \[k\].
            let turned: [Matrix3; 3] = std::array::from_fn(|l| {
                let column = |k: usize| {
                    let mut gradient = Matrix3::zeros();
                    gradient[(k, l)] = 1.0;
                    cofactor_slope(&F, &gradient) * area
                };
                Matrix3::from_columns(&[column(0), column(1), column(2)])
            });
            functions.clear();
            functions.extend(self.rows.row(point).map(|entry| {
                let gradient = &self.rows.grad_phi[entry];
                let along =
                    turned[0] * gradient.x + turned[1] * gradient.y + turned[2] * gradient.z;
                (self.rows.nodes[entry], (self.rows.phi[entry], along))
            }));
            functions.sort_unstable_by_key(|(node, _)| *node);
            matrix.add_pairs(&functions, |(phi, along), (other_phi, other)| {
                (*phi * other + *other_phi * along.transpose()) * (-0.5 * pressure)
            });
        }
    }

    /// V = −1/d Σ_i (x_i − c)·cof F(X_i) A_i N_i \[m³\], in a plane of the slab (method book, eq. 14.7),
    /// counted from a point of the `opening` \[m\], where there is none from the centre of the moved
    /// surface: it closes to its quadrature only, and a shift must not change its volume.
    pub fn volume(&self, opening: Option<Vector3>, u: &[f64], components: usize) -> f64 {
        let about = opening.unwrap_or_else(|| self.centre(u, components));
        let point = |(point, area): (usize, &Vector3)| {
            let F = self.rows.deformation_gradient(point, u, components);
            let way = self.place(point, u, components) - about;
            way.dot(&(cofactor(&F) * area))
        };
        -self.areas.iter().enumerate().map(point).sum::<f64>() / components as f64
    }

    /// Adds `factor` ∂V/∂u of [`Self::volume`].
    pub fn add_volume_slope(
        &self,
        (opening, factor): (Option<Vector3>, f64),
        u: &[f64],
        components: usize,
        slope: &mut [f64],
    ) {
        let factor = -factor / components as f64;
        let about = opening.unwrap_or_else(|| self.centre(u, components));
        // What the centre takes along; an opening stays where it is.
        let taken = match opening {
            Some(_) => Vector3::zeros(),
            None => self.moved_areas(u, components).sum::<Vector3>() / self.resultant().1,
        };
        for (point, area) in self.areas.iter().enumerate() {
            let F = self.rows.deformation_gradient(point, u, components);
            let way = self.place(point, u, components) - about;
            let force = (cofactor(&F) * area - taken * area.norm()) * factor;
            let stress = cofactor_slope(&F, &(way * area.transpose())) * factor;
            for entry in self.rows.row(point) {
                let node = self.rows.nodes[entry] as usize;
                let along = self.rows.phi[entry] * force + stress * self.rows.grad_phi[entry];
                for k in 0..components {
                    slope[components * node + k] += along[k];
                }
            }
        }
    }

    /// Moves the surface at rest by offsets \[component of node\] \[m\].
    pub fn move_by(&mut self, offsets: &[f64], components: usize) {
        for point in 0..self.areas.len() {
            let G = self.rows.deformation_gradient(point, offsets, components);
            self.areas[point] = cofactor(&G) * self.areas[point];
            self.positions[point] += self.rows.interpolate(point, offsets, components);
            self.rows.push_forward(point, &G);
        }
    }

    /// Sum of the vector areas at rest, and of their sizes \[m²\].
    pub fn resultant(&self) -> (Vector3, f64) {
        (self.areas.iter().sum(), self.areas.iter().map(|area| area.norm()).sum())
    }

    /// Mean place of the surface, by areas at rest \[m\].
    pub fn centre(&self, u: &[f64], components: usize) -> Vector3 {
        let (_, size) = self.resultant();
        let place = |point| self.place(point, u, components);
        self.areas.iter().enumerate().map(|(i, area)| place(i) * (area.norm() / size)).sum()
    }

    /// Vector areas of the moved surface \[m²\].
    fn moved_areas(&self, u: &[f64], components: usize) -> impl Iterator<Item = Vector3> {
        let moved = move |(point, area): (usize, &Vector3)| {
            cofactor(&self.rows.deformation_gradient(point, u, components)) * area
        };
        self.areas.iter().enumerate().map(moved)
    }

    fn place(&self, point: usize, u: &[f64], components: usize) -> Vector3 {
        self.positions[point] + self.rows.interpolate(point, u, components)
    }
}

/// Derivative of cof F along `direction`; as a bilinear form of both it is symmetric.
fn cofactor_slope(F: &Matrix3, direction: &Matrix3) -> Matrix3 {
    let dual = map(|i, j| Dual { value: F[(i, j)], slope: direction[(i, j)] });
    let cof = tensor_cofactor(&dual);
    Matrix3::from_fn(|i, j| cof[i][j].slope)
}
