//! Internal forces f_int,a = Σ_q w_q P(F_q) Grad φ_a(X_q) of all blocks (method book,
//! eq. 11.1) and their derivative.
#![allow(non_snake_case)]

use crate::algebra::lanes::{with_slopes, with_vectors};
use crate::force::kernel::{
    ExtraStress, Local, OwnPressures, Scratch, block_force, keep_gradients,
};
use crate::force::layout::{Block, PackedPoints};
use crate::force::projection::PatchMoments;
use fearless_simd::Level;
use rayon::prelude::*;
use std::cell::RefCell;

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
    /// For the points of a body, at the widest vector instructions of this processor.
    pub fn new(points: &PackedPoints) -> Workspace {
        Workspace { level: Level::new(), blocks: points.blocks.iter().map(Scratch::new).collect() }
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

/// Bodies of fewer points run on one thread, which is faster than to wake another.
const POINTS_FOR_THREADS: usize = 4096;

/// Internal forces \[component of node\] \[N\] at displacements `u` \[m\].
///
/// Blocks run on any number of threads into buffers of their own, which are
/// added in the order of the blocks: the bits do not depend on the threads.
pub fn internal_force(
    points: &PackedPoints,
    u: &[f64],
    workspace: &mut Workspace,
    f: &mut [f64],
) -> SmallestJacobian {
    internal_force_with(points, u, None, workspace, f)
}

/// As [`internal_force`], of patches that may have pressures of their own (method book,
/// eq. 21.13).
pub fn internal_force_with(
    points: &PackedPoints,
    u: &[f64],
    own: Option<&OwnPressures>,
    workspace: &mut Workspace,
    f: &mut [f64],
) -> SmallestJacobian {
    match points.components {
        2 => internal_force_in::<2>(points, (u, own), false, workspace, f),
        _ => internal_force_in::<3>(points, (u, own), false, workspace, f),
    }
}

/// K v \[N\] with the tangent operator K = ∂f_int/∂u at displacements `u` \[m\]:
/// the exact derivative of [`internal_force`] along `v` \[m\].
pub fn stiffness_times(
    points: &PackedPoints,
    u: &[f64],
    v: &[f64],
    workspace: &mut Workspace,
    product: &mut [f64],
) {
    linearise(points, u, workspace);
    linearised_stiffness_times(points, v, None, workspace, product);
}

/// Prepares [`linearised_stiffness_times`] at displacements `u` \[m\].
pub fn linearise(points: &PackedPoints, u: &[f64], workspace: &mut Workspace) {
    match points.components {
        2 => linearise_in::<2>(points, u, workspace),
        _ => linearise_in::<3>(points, u, workspace),
    }
}

/// As [`stiffness_times`] at the displacements of the last [`linearise`]: the derivative of
/// [`internal_force_with`] with the patches' own pressures as they are.
///
/// # Panics
/// If there has been none.
pub fn linearised_stiffness_times(
    points: &PackedPoints,
    v: &[f64],
    own: Option<&OwnPressures>,
    workspace: &mut Workspace,
    product: &mut [f64],
) {
    match points.components {
        2 => internal_force_in::<2>(points, (v, own), true, workspace, product),
        _ => internal_force_in::<3>(points, (v, own), true, workspace, product),
    };
}

fn linearise_in<const D: usize>(points: &PackedPoints, u: &[f64], workspace: &mut Workspace) {
    let level = workspace.level;
    let run = |(block, scratch): (&Block, &mut Scratch)| {
        with_local(|Local { u: local, .. }| {
            local.gather::<D>(&block.nodes, u);
            // Chooses the instructions of this processor.
            with_vectors!(level, (simd, _numbers) => {
                keep_gradients::<_, D>(simd, block, local, scratch)
            });
        })
    };
    if on_one_thread(points) {
        points.blocks.iter().zip(&mut workspace.blocks).for_each(run)
    } else {
        points.blocks.par_iter().zip(&mut workspace.blocks).with_max_len(1).for_each(run)
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
fn on_one_thread(points: &PackedPoints) -> bool {
    points.count() < POINTS_FOR_THREADS || rayon::current_num_threads() == 1
}

/// Forces at displacements `u`, or their derivative along `u` where the points were linearised.
fn internal_force_in<const D: usize>(
    points: &PackedPoints,
    (u, own): (&[f64], Option<&OwnPressures>),
    along: bool,
    workspace: &mut Workspace,
    f: &mut [f64],
) -> SmallestJacobian {
    let level = workspace.level;
    let run = |index: usize, block: &Block, local: &mut Local, scratch: &mut Scratch| {
        local.u.gather::<D>(&block.nodes, u);
        let block = (block, own.map(|own| own.block(index)));
        // Chooses the instructions of this processor, and how many points at a time the law takes.
        with_vectors!(level, (simd, numbers) => if along {
            block_force::<_, _, D>(simd, with_slopes(numbers), block, local, scratch)
        } else {
            block_force::<_, _, D>(simd, numbers, block, local, scratch)
        });
    };
    let nodes = f.as_chunks_mut::<D>().0;
    if on_one_thread(points) {
        nodes.fill([0.0; D]);
        with_local(|local| {
            let blocks = points.blocks.iter().zip(&mut workspace.blocks).enumerate();
            for (index, (block, scratch)) in blocks {
                run(index, block, local, scratch);
                block.nodes.iter().zip(local.f.iter::<D>()).for_each(|(&node, force)| {
                    add(&mut nodes[node as usize], force);
                });
            }
        });
    } else {
        let blocks = points.blocks.par_iter().zip(&mut workspace.blocks).enumerate();
        blocks.with_max_len(1).for_each(|(index, (block, scratch))| {
            with_local(|local| {
                run(index, block, local, scratch);
                let forces = local.f.iter::<D>().take(block.nodes.len());
                scratch.forces.clear();
                scratch.forces.extend(forces.flatten());
            });
        });
        sum_in_order(points, &workspace.blocks, nodes);
    }
    let smallest = points.blocks.iter().zip(&workspace.blocks).map(|(block, scratch)| {
        let (jacobian, lane) = scratch.smallest;
        SmallestJacobian { jacobian, point: block.point(lane) }
    });
    smallest.fold(SmallestJacobian::NONE, SmallestJacobian::or)
}

/// The forces of all blocks, chunk by chunk of the nodes; each node gets its
/// terms in the order of the blocks.
fn sum_in_order<const D: usize>(points: &PackedPoints, blocks: &[Scratch], nodes: &mut [[f64; D]]) {
    let length = points.sums.chunk;
    nodes.par_chunks_mut(length).zip(&points.sums.terms).enumerate().for_each(
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
