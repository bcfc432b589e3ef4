//! What is known at quadrature points, at nodes and between them (method book, eqs. 10.6, 10.7).
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::Discretisation;
use crate::force::projected_mean_stress;
use crate::material::Law;
use crate::model::Model;
use crate::problem::Problem;
use rayon::prelude::*;

/// J, Cauchy stress and strain of the material, as linear functions around the nodes, one for each
/// region in which a node supports points.
#[derive(Debug, Clone)]
pub struct NodalFields {
    /// \[node\], its own region first.
    around: Vec<Vec<Linear>>,
    /// \[node\] \[m\]
    nodes: Vec<Vector3>,
}

/// What deforms and loads the material at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalFields {
    /// J \[–\]; 1 within what is held as a volume, where nothing deforms.
    pub jacobian: f64,
    /// Cauchy stress by rows \[Pa\], the pressure of patches and the stress of fibres and viscosity
    /// included.
    pub stress: [f64; 9],
    /// Green–Lagrange strain \[xx, yy, zz, xy, yz, zx\] \[–\].
    pub strain: [f64; 6],
}

/// J, nine components of the stress by rows, and six of the strain.
const FIELDS: usize = 16;
/// Share in a fit that a point has at least, since φ may be negative \[–\].
const LEAST_SHARE: f64 = 1e-6;
/// Directions in which points spread by less of their largest spread, squared, have no slope: across a
/// sheet of points, and across a plane \[–\].
const FLAT: f64 = 0.01;

impl NodalFields {
    /// At nodal parameters `u` \[m\]: linear functions are fitted to the values at the quadrature points
    /// that a node supports in a region, weighted by volume times φ, so that values on the boundary
    /// are those there and not half a support inside. `extra_stress` are second Piola–Kirchhoff
    /// stresses \[point\]\[xx, yy, zz, xy, yz, zx\] \[Pa\] beside those of the laws, if there are any.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
        model: &Model,
        u: &[f64],
        extra_stress: &[[f64; 6]],
    ) -> NodalFields {
        let (rows, quadrature) = (&discretisation.supports, &discretisation.quadrature);
        let nodes = &discretisation.cloud.positions;
        let frames = model.fibre_frames();
        let mut fits: Vec<Vec<(u16, Fit)>> = vec![Vec::new(); nodes.len()];
        for (point, mean_stress) in projected_mean_stress(&model.points, u).into_iter().enumerate()
        {
            let F = rows.deformation_gradient(point, u, model.components);
            let (X, region) = (quadrature.positions[point], quadrature.regions[point]);
            let law = &problem.regions[region as usize].material.law;
            let extra = extra_stress.get(point);
            let values = at_point(&F, law, frames[point].as_ref(), mean_stress, extra);
            for entry in rows.row(point) {
                let node = rows.nodes[entry] as usize;
                let weight = quadrature.weights[point] * rows.phi[entry].max(LEAST_SHARE);
                let own = fits[node].iter().position(|(known, _)| *known == region);
                let own = own.unwrap_or_else(|| {
                    fits[node].push((region, Fit::default()));
                    fits[node].len() - 1
                });
                fits[node][own].1.add(weight, &(X - nodes[node]), &values);
            }
        }
        let home = |X: &Vector3| problem.regions.iter().position(|region| region.part.contains(X));
        let around = fits.into_par_iter().zip(nodes).map(|(fits, X)| {
            let home = if fits.len() > 1 { home(X) } else { None };
            let mut all: Vec<Linear> = fits.iter().map(|(r, fit)| fit.linear(*r)).collect();
            all.sort_by_key(|linear| (Some(linear.region as usize) != home, linear.region));
            all
        });
        NodalFields { around: around.collect(), nodes: nodes.clone() }
    }

    /// At the nodes, each of its own region.
    pub fn at_nodes(&self) -> Vec<LocalFields> {
        let all = self.around.par_iter();
        all.map(|around| {
            around.first().map_or(LocalFields::AT_REST, |own| own.at(&Vector3::zeros()))
        })
        .collect()
    }

    /// At a place in a region, from the nodes around with φ there: the mean of what their linear
    /// functions are there, weighted by φ and by what they know of the region.
    pub fn at(&self, X: &Vector3, region: u16, nodes: &[u32], phi: &[f64]) -> LocalFields {
        let known = nodes
            .iter()
            .any(|&node| self.around[node as usize].iter().any(|linear| linear.region == region));
        let (mut total, mut sums) = (0.0, [0.0; FIELDS]);
        for (&node, phi) in nodes.iter().zip(phi) {
            for linear in &self.around[node as usize] {
                if known && linear.region != region {
                    continue;
                }
                let weight = phi.max(LEAST_SHARE) * linear.weight;
                total += weight;
                let values = linear.values_at(&(X - self.nodes[node as usize]));
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        if total == 0.0 { LocalFields::AT_REST } else { LocalFields::of(&sums.map(|v| v / total)) }
    }
}

impl LocalFields {
    const AT_REST: LocalFields = LocalFields { jacobian: 1.0, stress: [0.0; 9], strain: [0.0; 6] };

    fn of(values: &[f64; FIELDS]) -> LocalFields {
        let stress = std::array::from_fn(|k| values[1 + k]);
        let strain = std::array::from_fn(|k| values[10 + k]);
        LocalFields { jacobian: values[0], stress, strain }
    }

    /// −tr σ/3 \[Pa\].
    pub fn pressure(&self) -> f64 {
        -(self.stress[0] + self.stress[4] + self.stress[8]) / 3.0
    }
}

/// Fields of a region as linear functions around a node.
#[derive(Debug, Clone)]
struct Linear {
    region: u16,
    /// Σ w φ of the points \[m³\].
    weight: f64,
    /// Of the points, from the node \[m\].
    middle: Vector3,
    /// There.
    values: [f64; FIELDS],
    /// Per length.
    slopes: [Vector3; FIELDS],
}

impl Linear {
    fn values_at(&self, offset: &Vector3) -> [f64; FIELDS] {
        let way = offset - self.middle;
        std::array::from_fn(|k| self.values[k] + self.slopes[k].dot(&way))
    }

    fn at(&self, offset: &Vector3) -> LocalFields {
        LocalFields::of(&self.values_at(offset))
    }
}

fn at_point(
    F: &Matrix3,
    law: &Law,
    frame: Option<&Matrix3>,
    mean_stress: f64,
    extra_stress: Option<&[f64; 6]>,
) -> [f64; FIELDS] {
    // The Cauchy stress is the same in every frame of the material.
    let own = frame.filter(|_| law.has_fibres()).map_or(*F, |frame| F * frame);
    let mut sigma = law.cauchy(&own) + Matrix3::from_diagonal_element(mean_stress);
    if let Some(&[xx, yy, zz, xy, yz, xz]) = extra_stress {
        let S = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        sigma += F * S * F.transpose() / F.determinant();
    }
    let E = 0.5 * (F.transpose() * F - Matrix3::identity());
    let mut values = [0.0; FIELDS];
    values[0] = F.determinant();
    values[1..10].copy_from_slice(sigma.transpose().as_slice());
    values[10..].copy_from_slice(&[E.m11, E.m22, E.m33, E.m12, E.m23, E.m13]);
    values
}

/// Sums over the points of a region around a node, with offsets x from it.
#[derive(Clone, Default)]
struct Fit {
    /// Σ w.
    weight: f64,
    /// Σ w x.
    first: Vector3,
    /// Σ w x xᵀ.
    second: Matrix3,
    /// Σ w v.
    values: [f64; FIELDS],
    /// Σ w v x.
    slopes: [Vector3; FIELDS],
}

impl Fit {
    fn add(&mut self, weight: f64, offset: &Vector3, values: &[f64; FIELDS]) {
        self.weight += weight;
        self.first += weight * offset;
        self.second += weight * offset * offset.transpose();
        for (k, value) in values.iter().enumerate() {
            self.values[k] += weight * value;
            self.slopes[k] += weight * *value * offset;
        }
    }

    /// The mean v̄ at the mean place x̄, and slopes M⁺ (⟨v x⟩ − v̄ x̄), M the spread of the offsets.
    fn linear(&self, region: u16) -> Linear {
        let middle = self.first / self.weight;
        let spread = (self.second / self.weight - middle * middle.transpose()).symmetric_eigen();
        let largest = spread.eigenvalues.max();
        let mut inverse = Matrix3::zeros();
        for (axis, own) in spread.eigenvectors.column_iter().zip(&spread.eigenvalues) {
            if *own > FLAT * largest {
                inverse += axis * axis.transpose() / *own;
            }
        }
        let values = self.values.map(|sum| sum / self.weight);
        let slope = |k: usize| inverse * (self.slopes[k] / self.weight - values[k] * middle);
        Linear { region, weight: self.weight, middle, values, slopes: std::array::from_fn(slope) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fitted(points: &[Vector3], value: impl Fn(&Vector3) -> f64) -> f64 {
        let mut fit = Fit::default();
        for (n, X) in points.iter().enumerate() {
            fit.add(1.0 + 0.1 * n as f64, X, &[value(X); FIELDS]);
        }
        fit.linear(0).at(&Vector3::zeros()).strain[5]
    }

    #[test]
    fn linear_fields_are_found_beside_the_points_in_space_and_on_a_sheet() {
        let at = |n: usize| Vector3::new((n % 3) as f64, (n / 3 % 3) as f64, (n / 9) as f64);
        let linear = |X: &Vector3| 3.0 + X.x - 0.5 * X.y + 0.2 * X.z;
        let space: Vec<Vector3> = (0..27).map(|n| at(n) + Vector3::repeat(0.2)).collect();
        assert!((fitted(&space, linear) - 3.0).abs() < 1e-12);
        let sheet: Vec<Vector3> = space.iter().map(|X| Vector3::new(X.x, X.y, 0.0)).collect();
        assert!((fitted(&sheet, linear) - 3.0).abs() < 1e-12);
        assert!((fitted(&[Vector3::x()], linear) - 4.0).abs() < 1e-12);
    }
}
