//! Internal forces f_int,a = Σ_q w_q P(F_q) Grad φ_a(X_q) of all blocks (method book,
//! eq. 11.1), their derivative, and the strain energy of the same points.
#![allow(non_snake_case)]

use crate::algebra::lanes::{Lanes, Number, PaddedVector, with_vectors};
use crate::algebra::real::Dual;
use crate::algebra::tensor::Matrix3;
use crate::model::blocks::{StoredNumber, with_gradients};
use crate::model::{Block, Chunk, Model};
use crate::motion::kernel::{Scratch, block_force};
use fearless_simd::{Level, Simd};
use rayon::prelude::*;
use std::marker::PhantomData;

/// Scratch memory of a run; nothing in it outlives a step.
#[derive(Debug, Clone)]
pub struct Workspace {
    /// The vector instructions of this processor.
    pub level: Level,
    blocks: Vec<Scratch>,
}

/// The smallest J of all quadrature points and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmallestJacobian {
    /// J = det F \[–\]
    pub jacobian: f64,
    /// Index of the quadrature point.
    pub point: usize,
}

impl SmallestJacobian {
    /// Before any point has been evaluated.
    pub const NONE: SmallestJacobian = SmallestJacobian { jacobian: f64::INFINITY, point: 0 };

    /// The smaller of two.
    pub fn or(self, other: SmallestJacobian) -> SmallestJacobian {
        if other.jacobian < self.jacobian { other } else { self }
    }
}

impl Workspace {
    /// For a model, at the widest vector instructions of this processor.
    pub fn new(model: &Model) -> Workspace {
        let scratch = |block: &Block| Scratch::new(block, model.components);
        Workspace { level: Level::new(), blocks: model.blocks.iter().map(scratch).collect() }
    }
}

/// Models of fewer points run on one thread, which is faster than to wake another.
const POINTS_FOR_THREADS: usize = 4096;

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
        2 => internal_force_in::<2>(model, u, None, workspace, f),
        _ => internal_force_in::<3>(model, u, None, workspace, f),
    }
}

/// K v \[N\] with the tangent operator K = ∂f_int/∂u at displacements `u` \[m\]:
/// the exact derivative of [`internal_force`] along `v` \[m\].
pub fn stiffness_times(
    model: &Model,
    u: &[f64],
    v: &[f64],
    workspace: &mut Workspace,
    product: &mut [f64],
) {
    match model.components {
        2 => internal_force_in::<2>(model, u, Some(v), workspace, product),
        _ => internal_force_in::<3>(model, u, Some(v), workspace, product),
    };
}

fn internal_force_in<const D: usize>(
    model: &Model,
    u: &[f64],
    v: Option<&[f64]>,
    workspace: &mut Workspace,
    f: &mut [f64],
) -> SmallestJacobian {
    let level = workspace.level;
    let run = |(block, scratch): (&Block, &mut Scratch)| {
        gather::<D>(block, u, &mut scratch.u);
        match v {
            None => {
                with_vectors!(level, (simd, numbers) => force::<_, _, D>(simd, numbers, block, scratch))
            }
            Some(v) => {
                scratch.v.resize(block.nodes.len(), PaddedVector::default());
                gather::<D>(block, v, &mut scratch.v);
                with_vectors!(level, (simd, numbers) => {
                    derivative::<_, _, D>(simd, numbers, block, scratch)
                });
            }
        }
    };
    let pairs = model.blocks.iter().zip(&mut workspace.blocks);
    let nodes = f.as_chunks_mut::<D>().0;
    if model.point_positions.len() < POINTS_FOR_THREADS || rayon::current_num_threads() == 1 {
        nodes.fill([0.0; D]);
        for (block, scratch) in pairs {
            run((block, scratch));
            block.nodes.iter().zip(&scratch.f).for_each(|(&node, force)| {
                add(&mut nodes[node as usize], force);
            });
        }
    } else {
        model.blocks.par_iter().zip(&mut workspace.blocks).with_max_len(1).for_each(run);
        sum_in_order(model, &workspace.blocks, nodes);
    }
    let smallest = model.blocks.iter().zip(&workspace.blocks).map(|(block, scratch)| {
        let (jacobian, point) = scratch.smallest;
        SmallestJacobian { jacobian, point: block.points.start + point }
    });
    smallest.fold(SmallestJacobian::NONE, SmallestJacobian::or)
}

#[inline(always)]
fn force<S: Simd, N: Lanes<S>, const D: usize>(
    simd: S,
    _: PhantomData<N>,
    block: &Block,
    scratch: &mut Scratch,
) {
    block_force::<S, N, D>(simd, block, scratch);
}

#[inline(always)]
fn derivative<S: Simd, N: Number<S>, const D: usize>(
    simd: S,
    _: PhantomData<N>,
    block: &Block,
    scratch: &mut Scratch,
) {
    block_force::<S, Dual<N>, D>(simd, block, scratch);
}

/// The forces of all blocks, chunk by chunk of the nodes; each node gets its
/// terms in the order of the blocks.
fn sum_in_order<const D: usize>(model: &Model, blocks: &[Scratch], nodes: &mut [[f64; D]]) {
    let length = model.sums.chunk;
    nodes.par_chunks_mut(length).zip(&model.sums.terms).enumerate().for_each(
        |(chunk, (nodes, terms))| {
            nodes.fill([0.0; D]);
            for term in terms {
                let forces = &blocks[term.block].f;
                for (node, local) in &term.nodes {
                    add(&mut nodes[*node as usize - chunk * length], &forces[*local as usize]);
                }
            }
        },
    );
}

#[inline(always)]
fn add<const D: usize>(node: &mut [f64; D], force: &PaddedVector) {
    node.iter_mut().zip(force.0).for_each(|(sum, f)| *sum += f);
}

fn gather<const D: usize>(block: &Block, u: &[f64], local: &mut [PaddedVector]) {
    let global = u.as_chunks::<D>().0;
    for (&node, value) in block.nodes.iter().zip(local) {
        value.0[..D].copy_from_slice(&global[node as usize]);
    }
}

/// F = I + Σ_a u_a ⊗ Grad φ_a; in a plane F₃₃ = 1.
#[inline(always)]
fn deformation_gradient<const D: usize>(
    block: &Block,
    point: usize,
    u: &[PaddedVector],
) -> Matrix3 {
    let sums = with_gradients!(&block.grad_phi, grad_phi => {
        let (nodes, gradients) = block.support::<_, D>(grad_phi, point);
        displacement_gradient(nodes, gradients, u)
    });
    let mut F = Matrix3::identity();
    for i in 0..D {
        for j in 0..D {
            F[(i, j)] += sums[i][j];
        }
    }
    F
}

/// Σ_a u_a ⊗ Grad φ_a.
#[inline(always)]
fn displacement_gradient<G: StoredNumber, const D: usize>(
    nodes: &[u32],
    gradients: &[[G; D]],
    u: &[PaddedVector],
) -> [[f64; D]; D] {
    let mut sums = [[0.0; D]; D];
    for (&node, gradient) in nodes.iter().zip(gradients) {
        let (displacement, gradient) = (u[node as usize].0, gradient.map(Into::into));
        for i in 0..D {
            for j in 0..D {
                sums[i][j] += displacement[i] * gradient[j];
            }
        }
    }
    sums
}

/// Strain energy Σ_q w_q ψ(F_q) \[J\] at displacements `u` \[m\].
pub fn strain_energy(model: &Model, u: &[f64], workspace: &mut Workspace) -> f64 {
    let blocks = model.blocks.iter().zip(&mut workspace.blocks);
    let energy = |(block, scratch): (&Block, &mut Scratch)| match model.components {
        2 => block_energy::<2>(block, u, &mut scratch.u),
        _ => block_energy::<3>(block, u, &mut scratch.u),
    };
    blocks.map(energy).sum()
}

fn block_energy<const D: usize>(block: &Block, u: &[f64], local: &mut [PaddedVector]) -> f64 {
    gather::<D>(block, u, local);
    let mut energy = 0.0;
    let mut jacobians = Vec::new();
    for chunk in block.chunks() {
        jacobians.clear();
        for point in chunk.points {
            let F = deformation_gradient::<D>(block, point, local);
            energy += block.quadrature_weights[point] * block.law.strain_energy(&F);
            jacobians.push(F.determinant());
        }
        if let Some(projection) = &block.projection {
            energy += projection.energy(&block.law, chunk.groups, &jacobians);
        }
    }
    energy
}

/// What the projection adds to the mean Cauchy stress at each quadrature point
/// \[Pa\], at displacements `u` \[m\]; 0 without one. The pressure is
/// −tr σ/3 less this.
pub fn projected_mean_stress(model: &Model, u: &[f64]) -> Vec<f64> {
    let stresses = |block: &Block| match model.components {
        2 => block_mean_stress::<2>(block, u),
        _ => block_mean_stress::<3>(block, u),
    };
    model.blocks.iter().flat_map(stresses).collect()
}

fn block_mean_stress<const D: usize>(block: &Block, u: &[f64]) -> Vec<f64> {
    let Some(projection) = &block.projection else {
        return vec![0.0; block.quadrature_weights.len()];
    };
    let mut local = vec![PaddedVector::default(); block.nodes.len()];
    gather::<D>(block, u, &mut local);
    let jacobian = |point: usize| deformation_gradient::<D>(block, point, &local).determinant();
    let pressures = |chunk: Chunk| {
        let jacobians: Vec<f64> = chunk.points.map(jacobian).collect();
        projection.plain_pressures(&block.law, chunk.groups, &jacobians)
    };
    block.chunks().flat_map(pressures).collect()
}
