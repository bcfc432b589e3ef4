//! Preconditioned conjugate gradients on the three components at once.

use crate::algebra::tensor::Vector3;
use crate::discretisation::consistency::affine::Affine;
use crate::discretisation::consistency::multilevel::Multilevel;
use crate::discretisation::consistency::operator::{Nodal, Operator};
use crate::discretisation::mls::inverse;
use nalgebra::SMatrix;
use rayon::prelude::*;

/// Largest number of iterations.
const MOST_ITERATIONS: usize = 500;

/// K + C with C the compliance of the multipliers, and its preconditioner: the blocks of
/// the nodes and, for condition 2, a multilevel one.
pub(super) struct System<'a, const M: usize> {
    operator: &'a Operator<'a>,
    /// Of each multiplier of a node.
    compliance: Vec<SMatrix<f64, M, 1>>,
    inverse_blocks: Vec<SMatrix<f64, M, M>>,
    smooth: Option<Smooth<'a>>,
}

/// Smooth fields of multipliers: most of them change gradients little, affine ones not at
/// all.
#[derive(Clone, Copy)]
pub(super) struct Smooth<'a> {
    pub multilevel: &'a Multilevel,
    pub affine: &'a Affine<'a>,
}

/// What conjugate gradients found.
pub(super) struct Solution<const M: usize> {
    pub multipliers: Vec<Nodal<M>>,
    pub iterations: usize,
    /// Norm of the residual.
    pub residual: f64,
}

impl<'a, const M: usize> System<'a, M> {
    /// From the blocks of K on its diagonal; multipliers yield by `compliance` times the
    /// diagonal.
    pub fn new(
        operator: &'a Operator<'a>,
        mut blocks: Vec<SMatrix<f64, M, M>>,
        compliance: f64,
        smooth: Option<Smooth<'a>>,
    ) -> System<'a, M> {
        let mut yields = Vec::with_capacity(blocks.len());
        for block in &mut blocks {
            let own = block.diagonal() * compliance;
            for m in 0..M {
                block[(m, m)] += own[m];
                // Across a plane there is nothing.
                if block[(m, m)] == 0.0 {
                    block[(m, m)] = 1.0;
                }
            }
            yields.push(own);
        }
        let inverse_of = |block: &SMatrix<f64, M, M>| inverse(block).unwrap_or_else(SMatrix::zeros);
        let inverse_blocks = blocks.par_iter().map(inverse_of).collect();
        System { operator, compliance: yields, inverse_blocks, smooth }
    }

    fn apply(&self, multipliers: &[Nodal<M>]) -> Vec<Nodal<M>> {
        let mut image = self.operator.apply(multipliers);
        for ((image, own), compliance) in image.iter_mut().zip(multipliers).zip(&self.compliance) {
            *image += Nodal::from_fn(|m, c| compliance[m] * own[(m, c)]);
        }
        image
    }

    fn precondition(&self, residual: &[Nodal<M>]) -> Vec<Nodal<M>> {
        let pairs = self.inverse_blocks.par_iter().zip(residual);
        let mut found: Vec<Nodal<M>> = pairs.map(|(block, r)| block * r).collect();
        if let Some(Smooth { multilevel, .. }) = self.smooth {
            let smooth = multilevel.apply(&first_rows(residual));
            for (value, smooth) in found.iter_mut().zip(&smooth) {
                (0..3).for_each(|c| value[(0, c)] += smooth[c]);
            }
            self.project(&mut found);
        }
        found
    }

    /// Removes affine fields where they are the kernel of K.
    pub fn project(&self, field: &mut [Nodal<M>]) {
        let Some(Smooth { affine, .. }) = self.smooth else { return };
        let mut rows = first_rows(field);
        affine.project(&mut rows);
        field.iter_mut().zip(&rows).for_each(|(value, row)| value.set_row(0, &row.transpose()));
    }

    /// From a projected residual down to the norm `goal`.
    pub fn solve(&self, mut residual: Vec<Nodal<M>>, goal: f64) -> Solution<M> {
        let mut multipliers = vec![Nodal::<M>::zeros(); residual.len()];
        let mut size = norm(&residual);
        let mut direction = self.precondition(&residual);
        let mut energy = dot(&residual, &direction);
        let mut iterations = 0;
        while size > goal && iterations < MOST_ITERATIONS {
            let image = self.apply(&direction);
            let step = ratio(&energy, &dot(&direction, &image));
            for ((x, r), (d, k)) in
                multipliers.iter_mut().zip(&mut residual).zip(direction.iter().zip(&image))
            {
                for c in 0..3 {
                    x.column_mut(c).axpy(step[c], &d.column(c), 1.0);
                    r.column_mut(c).axpy(-step[c], &k.column(c), 1.0);
                }
            }
            self.project(&mut residual);
            size = norm(&residual);
            let next = self.precondition(&residual);
            let after = dot(&residual, &next);
            let factor = ratio(&after, &energy);
            for (d, z) in direction.iter_mut().zip(&next) {
                *d = Nodal::from_fn(|m, c| z[(m, c)] + factor[c] * d[(m, c)]);
            }
            energy = after;
            iterations += 1;
        }
        Solution { multipliers, iterations, residual: size }
    }
}

fn first_rows<const M: usize>(field: &[Nodal<M>]) -> Vec<Vector3> {
    field.iter().map(|value| Vector3::new(value[(0, 0)], value[(0, 1)], value[(0, 2)])).collect()
}

pub(super) fn norm<const M: usize>(field: &[Nodal<M>]) -> f64 {
    field.iter().map(|value| value.norm_squared()).sum::<f64>().sqrt()
}

/// Component by component.
fn dot<const M: usize>(a: &[Nodal<M>], b: &[Nodal<M>]) -> Vector3 {
    let product = |a: &Nodal<M>, b: &Nodal<M>| {
        Vector3::from_fn(|c, _| (0..M).map(|m| a[(m, c)] * b[(m, c)]).sum())
    };
    a.iter().zip(b).map(|(a, b)| product(a, b)).sum()
}

/// a/b by component, 0 where b is.
fn ratio(a: &Vector3, b: &Vector3) -> Vector3 {
    a.zip_map(b, |a, b| if b > 0.0 { a / b } else { 0.0 })
}
