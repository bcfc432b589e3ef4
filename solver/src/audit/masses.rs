//! Volume, mass and centre of the regions.
#![allow(non_snake_case)]

use super::{Kind, Row, Run};
use crate::algebra::tensor::Vector3;

/// Difference of the volume or mass of a region over itself \[–\]: half of the smallest error
/// bars of usual clouds, as weights and stiffnesses are in proportion to it.
const SIZE: f64 = 0.01;
/// The same over the whole body \[–\]: regions smaller than this do not matter to it.
const OF_BODY: f64 = 2e-4;
/// Difference between the masses of points and those of nodes, which share them, over them \[–\].
const SHARED: f64 = 1e-8;
/// Shift of a centre over the size of the region, the cube root of its volume \[–\].
const SHIFT: f64 = 0.01;

impl Run<'_> {
    /// Volume and centre of every region, and the mass at the nodes.
    pub(super) fn masses(&self) -> Vec<Row> {
        let regions = &self.problem.regions;
        let mut sums = vec![(0.0, Vector3::zeros()); regions.len()];
        for (quadrature, _) in self.discretisation.volumes() {
            let weighted = quadrature.weights.iter().zip(&quadrature.positions);
            for ((weight, X), &region) in weighted.zip(&quadrature.regions) {
                sums[region as usize].0 += weight;
                sums[region as usize].1 += *weight * X;
            }
        }
        let whole = self.sampled.volume();
        let mut rows = Vec::new();
        let (mut mass, mut doubt) = (0.0, 0.0);
        for ((region, asked), (done, first)) in
            regions.iter().zip(&self.sampled.volumes).zip(sums.iter().copied())
        {
            mass += region.material.density * asked.size;
            doubt += region.material.density * asked.doubt;
            let limit = SIZE * asked.size + OF_BODY * whole + asked.doubt;
            rows.push(Row::numbers(Kind::Volume, &region.name, asked.size, done, limit));
            if asked.size > 0.0 && done > 0.0 {
                let centres = (asked.first / asked.size, first / done);
                let relative = SHIFT + (OF_BODY * whole + asked.doubt) / asked.size;
                let limit = relative * self.length(asked.size);
                rows.push(Row::vectors(Kind::Centre, &region.name, centres.0, centres.1, limit));
            }
        }
        let done: f64 = self.model.lumped_mass.iter().sum();
        rows.push(Row::numbers(Kind::Mass, "", mass, done, SIZE * mass + doubt));
        let density = |region: usize| regions[region].material.density;
        let of_points = sums.iter().enumerate().map(|(region, sum)| density(region) * sum.0);
        let of_points: f64 = of_points.sum();
        rows.push(Row::numbers(Kind::NodalMass, "", of_points, done, SHARED * of_points));
        rows
    }

    /// Edge of a cube, in a plane of a square, of a volume \[m\].
    fn length(&self, volume: f64) -> f64 {
        let components = self.model.components;
        (volume / self.problem.dimension.thickness()).powf(1.0 / components as f64)
    }
}
