//! Internal forces f_int,a = Σ_q w_q P(F_q) Grad φ_a(X_q) of all blocks (method book,
//! eq. 11.1) and their derivative.
#![allow(non_snake_case)]

use crate::algebra::lanes::{Lanes, Number, with_vectors};
use crate::algebra::real::Dual;
use crate::algebra::tensor::Matrix3;
use crate::model::blocks::{LocalVectors, with_gradients};
use crate::model::projection::PatchMoments;
use crate::model::{Block, Model};
pub use crate::motion::kernel::OwnPressures;
use crate::motion::kernel::{self, BlockPressures, ExtraStress, Local, Scratch, block_force};
use fearless_simd::{Level, Simd};
use rayon::prelude::*;
use std::cell::RefCell;
use std::marker::PhantomData;

/// Scratch memory of a run; nothing in it outlives a step.
#[derive(Debug)]
pub struct Workspace {
    /// The vector instructions of this processor.
    pub level: Level,
    pub(super) blocks: Vec<Scratch>,
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
        Workspace { level: Level::new(), blocks: model.blocks.iter().map(Scratch::new).collect() }
    }

    /// What acts beside the law of a block, where there is such a thing.
    pub(crate) fn extra(&mut self, block: usize) -> Option<&mut ExtraStress> {
        self.blocks[block].extra.as_mut()
    }

    /// What the last displacements made of the patches, block by block.
    pub fn patches(&self) -> impl Iterator<Item = &PatchMoments> {
        self.blocks.iter().flat_map(|scratch| &scratch.patches)
    }

    /// Moments of the pressures that J gave in the last evaluation \[Pa·m^(3/2)\].
    pub fn pressures_of_j(&self) -> Vec<f64> {
        self.patches().flat_map(|patch| patch.pressure).collect()
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
    internal_force_with(model, u, None, workspace, f)
}

/// As [`internal_force`], of patches that may have pressures of their own (method book,
/// eq. 21.13).
pub fn internal_force_with(
    model: &Model,
    u: &[f64],
    own: Option<&OwnPressures>,
    workspace: &mut Workspace,
    f: &mut [f64],
) -> SmallestJacobian {
    match model.components {
        2 => internal_force_in::<2>(model, (u, own), false, workspace, f),
        _ => internal_force_in::<3>(model, (u, own), false, workspace, f),
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
    linearise(model, u, workspace);
    linearised_stiffness_times(model, v, None, workspace, product);
}

/// Prepares [`linearised_stiffness_times`] at displacements `u` \[m\].
pub fn linearise(model: &Model, u: &[f64], workspace: &mut Workspace) {
    match model.components {
        2 => linearise_in::<2>(model, u, workspace),
        _ => linearise_in::<3>(model, u, workspace),
    }
}

/// As [`stiffness_times`] at the displacements of the last [`linearise`]: the derivative of
/// [`internal_force_with`] with the patches' own pressures as they are.
///
/// # Panics
/// If there has been none.
pub fn linearised_stiffness_times(
    model: &Model,
    v: &[f64],
    own: Option<&OwnPressures>,
    workspace: &mut Workspace,
    product: &mut [f64],
) {
    match model.components {
        2 => internal_force_in::<2>(model, (v, own), true, workspace, product),
        _ => internal_force_in::<3>(model, (v, own), true, workspace, product),
    };
}

fn linearise_in<const D: usize>(model: &Model, u: &[f64], workspace: &mut Workspace) {
    let level = workspace.level;
    let run = |(block, scratch): (&Block, &mut Scratch)| {
        with_local(|Local { u: local, .. }| {
            local.gather::<D>(&block.nodes, u);
            with_vectors!(level, (simd, numbers) => {
                keep_gradients::<_, _, D>(simd, numbers, block, local, scratch)
            });
        })
    };
    if on_one_thread(model) {
        model.blocks.iter().zip(&mut workspace.blocks).for_each(run)
    } else {
        model.blocks.par_iter().zip(&mut workspace.blocks).with_max_len(1).for_each(run)
    }
}

thread_local! {
    static LOCAL: RefCell<Local> = RefCell::new(Local::zeros());
}

/// Runs with the vectors of this thread.
pub(super) fn with_local<T>(run: impl FnOnce(&mut Local) -> T) -> T {
    LOCAL.with_borrow_mut(run)
}

/// Whether a pass over the blocks is faster without other threads.
fn on_one_thread(model: &Model) -> bool {
    model.point_positions.len() < POINTS_FOR_THREADS || rayon::current_num_threads() == 1
}

/// Forces at displacements `u`, or their derivative along `u` where the model was linearised.
fn internal_force_in<const D: usize>(
    model: &Model,
    (u, own): (&[f64], Option<&OwnPressures>),
    along: bool,
    workspace: &mut Workspace,
    f: &mut [f64],
) -> SmallestJacobian {
    let level = workspace.level;
    let run = |index: usize, block: &Block, local: &mut Local, scratch: &mut Scratch| {
        local.u.gather::<D>(&block.nodes, u);
        let block = (block, own.map(|own| own.block(index)));
        with_vectors!(level, (simd, numbers) => if along {
            derivative::<_, _, D>(simd, numbers, block, local, scratch)
        } else {
            force::<_, _, D>(simd, numbers, block, local, scratch)
        });
    };
    let nodes = f.as_chunks_mut::<D>().0;
    if on_one_thread(model) {
        nodes.fill([0.0; D]);
        with_local(|local| {
            let blocks = model.blocks.iter().zip(&mut workspace.blocks).enumerate();
            for (index, (block, scratch)) in blocks {
                run(index, block, local, scratch);
                block.nodes.iter().zip(local.f.iter::<D>()).for_each(|(&node, force)| {
                    add(&mut nodes[node as usize], force);
                });
            }
        });
    } else {
        let blocks = model.blocks.par_iter().zip(&mut workspace.blocks).enumerate();
        blocks.with_max_len(1).for_each(|(index, (block, scratch))| {
            with_local(|local| {
                run(index, block, local, scratch);
                let forces = local.f.iter::<D>().take(block.nodes.len());
                scratch.forces.clear();
                scratch.forces.extend(forces.flatten());
            });
        });
        sum_in_order(model, &workspace.blocks, nodes);
    }
    let smallest = model.blocks.iter().zip(&workspace.blocks).map(|(block, scratch)| {
        let (jacobian, lane) = scratch.smallest;
        SmallestJacobian { jacobian, point: block.point(lane) }
    });
    smallest.fold(SmallestJacobian::NONE, SmallestJacobian::or)
}

#[inline(always)]
fn force<S: Simd, N: Lanes<S>, const D: usize>(
    simd: S,
    _: PhantomData<N>,
    block: (&Block, Option<&BlockPressures>),
    local: &mut Local,
    scratch: &mut Scratch,
) {
    block_force::<S, N, D>(simd, block, local, scratch);
}

#[inline(always)]
fn keep_gradients<S: Simd, N, const D: usize>(
    simd: S,
    _: PhantomData<N>,
    block: &Block,
    u: &LocalVectors,
    scratch: &mut Scratch,
) {
    kernel::linearise::<S, D>(simd, block, u, scratch);
}

#[inline(always)]
fn derivative<S: Simd, N: Number<S>, const D: usize>(
    simd: S,
    _: PhantomData<N>,
    block: (&Block, Option<&BlockPressures>),
    local: &mut Local,
    scratch: &mut Scratch,
) {
    block_force::<S, Dual<N>, D>(simd, block, local, scratch);
}

/// The forces of all blocks, chunk by chunk of the nodes; each node gets its
/// terms in the order of the blocks.
fn sum_in_order<const D: usize>(model: &Model, blocks: &[Scratch], nodes: &mut [[f64; D]]) {
    let length = model.sums.chunk;
    nodes.par_chunks_mut(length).zip(&model.sums.terms).enumerate().for_each(
        |(chunk, (nodes, terms))| {
            nodes.fill([0.0; D]);
            for term in terms {
                let forces = blocks[term.block].forces.as_chunks::<D>().0;
                for (node, local) in &term.nodes {
                    add(&mut nodes[*node as usize - chunk * length], &forces[*local as usize]);
                }
            }
        },
    );
}

#[inline(always)]
fn add<const D: usize>(node: &mut [f64; D], force: &[f64; D]) {
    node.iter_mut().zip(force).for_each(|(sum, f)| *sum += f);
}

/// F = I + Σ_a u_a ⊗ Grad φ_a at the point in a lane; in a plane F₃₃ = 1.
#[inline(always)]
pub(super) fn deformation_gradient<const D: usize>(
    block: &Block,
    lane: usize,
    u: &LocalVectors,
) -> Matrix3 {
    let sums = with_gradients!(&block.grad_phi, grad_phi => {
        displacement_gradient(block.support::<_, D>(grad_phi, lane), u)
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
fn displacement_gradient<const D: usize>(
    support: impl Iterator<Item = (usize, [f64; D])>,
    u: &LocalVectors,
) -> [[f64; D]; D] {
    let mut sums = [[0.0; D]; D];
    for (node, gradient) in support {
        let displacement: [f64; D] = u.at(node);
        for i in 0..D {
            for j in 0..D {
                sums[i][j] += displacement[i] * gradient[j];
            }
        }
    }
    sums
}

/// F at the points of a block that are not padding, lane by lane.
pub(crate) fn deformation_gradients(
    model: &Model,
    block: &Block,
    u: &[f64],
    mut visit: impl FnMut(usize, &Matrix3),
) {
    with_local(|Local { u: local, .. }| match model.components {
        2 => {
            local.gather::<2>(&block.nodes, u);
            block.occupied().for_each(|n| visit(n, &deformation_gradient::<2>(block, n, local)));
        }
        _ => {
            local.gather::<3>(&block.nodes, u);
            block.occupied().for_each(|n| visit(n, &deformation_gradient::<3>(block, n, local)));
        }
    });
}
