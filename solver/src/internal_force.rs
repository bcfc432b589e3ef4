//! The one hot loop: f_int,a = Σ_q w_q P(F_q) Grad φ_a(X_q).
#![allow(non_snake_case)]

use crate::material::{ConstitutiveLaw, with_law};
use crate::model::{Block, Model};
use crate::projection::Projection;
use crate::tensor::{Matrix3, cofactor};
use rayon::prelude::*;

/// Scratch memory of a run; nothing in it outlives a step.
#[derive(Debug, Clone)]
pub struct Workspace {
    blocks: Vec<BlockScratch>,
}

#[derive(Debug, Clone)]
struct BlockScratch {
    u: Vec<f64>,
    f: Vec<f64>,
    smallest: SmallestJacobian,
    /// F, J and projected pressure of one patch.
    deformation: Vec<Matrix3>,
    jacobians: Vec<f64>,
    pressures: Vec<f64>,
}

/// The smallest J of all quadrature points and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmallestJacobian {
    /// J = det F \[–\]
    pub jacobian: f64,
    pub point: usize,
}

impl SmallestJacobian {
    pub const NONE: SmallestJacobian = SmallestJacobian { jacobian: f64::INFINITY, point: 0 };

    /// The smaller of two.
    pub fn or(self, other: SmallestJacobian) -> SmallestJacobian {
        if other.jacobian < self.jacobian { other } else { self }
    }
}

impl Workspace {
    pub fn new(model: &Model) -> Workspace {
        let scratch = |block: &Block| BlockScratch {
            u: vec![0.0; model.components * block.nodes.len()],
            f: vec![0.0; model.components * block.nodes.len()],
            smallest: SmallestJacobian::NONE,
            deformation: Vec::with_capacity(block.largest_patch()),
            jacobians: Vec::with_capacity(block.largest_patch()),
            pressures: Vec::with_capacity(block.largest_patch()),
        };
        Workspace { blocks: model.blocks.iter().map(scratch).collect() }
    }
}

/// Internal forces \[component of node\] \[N\] at displacements `u` \[m\].
///
/// Blocks run on any number of threads into buffers of their own, which are
/// added in the order of the blocks: the bits do not depend on the threads.
pub fn internal_force(
    model: &Model,
    u: &[f64],
    workspace: &mut Workspace,
    f: &mut [f64],
) -> SmallestJacobian {
    match model.components {
        2 => internal_force_in::<2>(model, u, workspace, f),
        _ => internal_force_in::<3>(model, u, workspace, f),
    }
}

fn internal_force_in<const D: usize>(
    model: &Model,
    u: &[f64],
    workspace: &mut Workspace,
    f: &mut [f64],
) -> SmallestJacobian {
    let run = |(block, scratch): (&Block, &mut BlockScratch)| {
        with_law!(&block.law, law => block_force::<D, _>(law, block, u, scratch));
    };
    if model.blocks.len() == 1 {
        run((&model.blocks[0], &mut workspace.blocks[0]));
    } else {
        model.blocks.par_iter().zip(&mut workspace.blocks).with_max_len(1).for_each(run);
    }
    f.fill(0.0);
    let mut smallest = SmallestJacobian::NONE;
    for (block, scratch) in model.blocks.iter().zip(&workspace.blocks) {
        let global = f.as_chunks_mut::<D>().0;
        for (&node, local) in block.nodes.iter().zip(scratch.f.as_chunks::<D>().0) {
            for k in 0..D {
                global[node as usize][k] += local[k];
            }
        }
        smallest = smallest.or(scratch.smallest);
    }
    smallest
}

fn block_force<const D: usize, L: ConstitutiveLaw>(
    law: &L,
    block: &Block,
    u: &[f64],
    scratch: &mut BlockScratch,
) {
    gather::<D>(block, u, &mut scratch.u);
    scratch.f.fill(0.0);
    scratch.smallest = SmallestJacobian::NONE;
    match &block.projection {
        None => pointwise_force::<D, L>(law, block, scratch),
        Some(projection) => projected_force::<D, L>(law, block, projection, scratch),
    }
}

fn pointwise_force<const D: usize, L: ConstitutiveLaw>(
    law: &L,
    block: &Block,
    scratch: &mut BlockScratch,
) {
    let u = scratch.u.as_chunks::<D>().0;
    let f = scratch.f.as_chunks_mut::<D>().0;
    for (point, &weight) in block.quadrature_weights.iter().enumerate() {
        let (nodes, gradients) = block.support::<D>(point);
        let F = deformation_gradient::<D>(nodes, gradients, u);
        let jacobian = F.determinant();
        if jacobian < scratch.smallest.jacobian {
            scratch.smallest = SmallestJacobian { jacobian, point: block.points.start + point };
        }
        scatter::<D>(&(law.first_piola_kirchhoff(&F) * weight), nodes, gradients, f);
    }
}

/// As [`pointwise_force`], patch by patch with the projected pressure.
fn projected_force<const D: usize, L: ConstitutiveLaw>(
    law: &L,
    block: &Block,
    projection: &Projection,
    scratch: &mut BlockScratch,
) {
    let BlockScratch { u, f, smallest, deformation, jacobians, pressures } = scratch;
    let u = u.as_chunks::<D>().0;
    let f = f.as_chunks_mut::<D>().0;
    for ends in projection.starts.windows(2) {
        let patch = ends[0] as usize..ends[1] as usize;
        deformation.clear();
        jacobians.clear();
        for point in patch.clone() {
            let (nodes, gradients) = block.support::<D>(point);
            let F = deformation_gradient::<D>(nodes, gradients, u);
            let jacobian = F.determinant();
            if jacobian < smallest.jacobian {
                *smallest = SmallestJacobian { jacobian, point: block.points.start + point };
            }
            deformation.push(F);
            jacobians.push(jacobian);
        }
        let (weights, basis) =
            (&block.quadrature_weights[patch.clone()], &projection.basis[patch.clone()]);
        pressures.resize(patch.len(), 0.0);
        projection.pressures(law, weights, basis, jacobians, pressures);
        for ((point, weight), (F, pressure)) in
            patch.zip(weights).zip(deformation.iter().zip(&*pressures))
        {
            let P = law.first_piola_kirchhoff(F) + cofactor(F) * *pressure;
            let (nodes, gradients) = block.support::<D>(point);
            scatter::<D>(&(P * *weight), nodes, gradients, f);
        }
    }
}

/// f_a += w P Grad φ_a.
#[inline(always)]
fn scatter<const D: usize>(P: &Matrix3, nodes: &[u32], gradients: &[[f64; D]], f: &mut [[f64; D]]) {
    for (&node, gradient) in nodes.iter().zip(gradients) {
        let force = &mut f[node as usize];
        for i in 0..D {
            let mut sum = 0.0;
            for j in 0..D {
                sum += P[(i, j)] * gradient[j];
            }
            force[i] += sum;
        }
    }
}

/// F = I + Σ_a u_a ⊗ Grad φ_a; in a plane F₃₃ = 1.
#[inline(always)]
fn deformation_gradient<const D: usize>(
    nodes: &[u32],
    gradients: &[[f64; D]],
    u: &[[f64; D]],
) -> Matrix3 {
    let mut sums = [[0.0; D]; D];
    for (&node, gradient) in nodes.iter().zip(gradients) {
        let displacement = u[node as usize];
        for i in 0..D {
            for j in 0..D {
                sums[i][j] += displacement[i] * gradient[j];
            }
        }
    }
    let mut F = Matrix3::identity();
    for i in 0..D {
        for j in 0..D {
            F[(i, j)] += sums[i][j];
        }
    }
    F
}

fn gather<const D: usize>(block: &Block, u: &[f64], local: &mut [f64]) {
    let global = u.as_chunks::<D>().0;
    for (&node, value) in block.nodes.iter().zip(local.as_chunks_mut::<D>().0) {
        *value = global[node as usize];
    }
}

/// Strain energy Σ_q w_q ψ(F_q) \[J\] at displacements `u` \[m\].
pub fn strain_energy(model: &Model, u: &[f64], workspace: &mut Workspace) -> f64 {
    model
        .blocks
        .iter()
        .zip(&mut workspace.blocks)
        .map(|(block, scratch)| match model.components {
            2 => block_energy::<2>(block, u, &mut scratch.u),
            _ => block_energy::<3>(block, u, &mut scratch.u),
        })
        .sum()
}

fn block_energy<const D: usize>(block: &Block, u: &[f64], local: &mut [f64]) -> f64 {
    gather::<D>(block, u, local);
    let u = local.as_chunks::<D>().0;
    let mut energy = 0.0;
    let mut jacobians = Vec::with_capacity(block.quadrature_weights.len());
    for (point, &weight) in block.quadrature_weights.iter().enumerate() {
        let (nodes, gradients) = block.support::<D>(point);
        let F = deformation_gradient::<D>(nodes, gradients, u);
        energy += weight * block.law.strain_energy(&F);
        jacobians.push(F.determinant());
    }
    let Some(projection) = &block.projection else { return energy };
    for ends in projection.starts.windows(2) {
        let patch = ends[0] as usize..ends[1] as usize;
        let (weights, basis) =
            (&block.quadrature_weights[patch.clone()], &projection.basis[patch.clone()]);
        let jacobians = &mut jacobians[patch];
        energy += with_law!(&block.law, law => projection.energy(law, weights, basis, jacobians));
    }
    energy
}

/// What the projection adds to the mean Cauchy stress at each quadrature point
/// \[Pa\], at displacements `u` \[m\]; 0 without one. The pressure is
/// −tr σ/3 less this.
pub fn projected_mean_stress(model: &Model, u: &[f64]) -> Vec<f64> {
    let mut all = Vec::with_capacity(model.point_positions.len());
    for block in &model.blocks {
        match model.components {
            2 => all.extend(block_mean_stress::<2>(block, u)),
            _ => all.extend(block_mean_stress::<3>(block, u)),
        }
    }
    all
}

fn block_mean_stress<const D: usize>(block: &Block, u: &[f64]) -> Vec<f64> {
    let count = block.quadrature_weights.len();
    let mut stresses = vec![0.0; count];
    let Some(projection) = &block.projection else { return stresses };
    let mut local = vec![0.0; D * block.nodes.len()];
    gather::<D>(block, u, &mut local);
    let u = local.as_chunks::<D>().0;
    let jacobian = |point: usize| {
        let (nodes, gradients) = block.support::<D>(point);
        deformation_gradient::<D>(nodes, gradients, u).determinant()
    };
    let jacobians: Vec<f64> = (0..count).map(jacobian).collect();
    for ends in projection.starts.windows(2) {
        let patch = ends[0] as usize..ends[1] as usize;
        let (weights, basis) =
            (&block.quadrature_weights[patch.clone()], &projection.basis[patch.clone()]);
        let (jacobians, stresses) = (&jacobians[patch.clone()], &mut stresses[patch]);
        with_law!(&block.law, law => {
            projection.pressures(law, weights, basis, jacobians, stresses);
        });
    }
    stresses
}
