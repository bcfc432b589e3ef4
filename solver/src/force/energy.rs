//! Strain energy of the points that forces are computed at, and their mean stress: point after
//! point, another way than that of the forces.
#![allow(non_snake_case)]

use super::forces::{Workspace, with_local};
use crate::algebra::tensor::Matrix3;
use crate::force::kernel::{ExtraStress, Local};
use crate::force::layout::{Block, Chunk, LocalVectors, PackedPoints, with_gradients};
use crate::material::{ConstitutiveLaw, PronySeries, with_law};

/// Strain energy Σ_q w_q ψ(F_q) \[J\] at displacements `u` \[m\]; of viscous materials what is left
/// of it in the end, the energy of an infinitely slow strain.
pub fn strain_energy(points: &PackedPoints, u: &[f64]) -> f64 {
    points.blocks.iter().map(|block| block_energy(points, block, u, None)).sum()
}

/// As [`strain_energy`], of a sudden strain, with Σ_q w_q ½ S_q : (C_q − 1) of the extra stresses S
/// of a workspace: what [`internal_force`](super::internal_force) is the derivative of while nothing relaxes.
pub fn potential_energy(points: &PackedPoints, u: &[f64], workspace: &Workspace) -> f64 {
    let blocks = points.blocks.iter().zip(&workspace.blocks);
    blocks.map(|(block, own)| block_energy(points, block, u, own.extra.as_ref())).sum()
}

fn block_energy(
    points: &PackedPoints,
    block: &Block,
    u: &[f64],
    extra: Option<&ExtraStress>,
) -> f64 {
    with_local(|Local { u: local, .. }| {
        // Chooses the law of the block.
        with_law!(&block.law, law => match points.components {
            2 => block_energy_in::<2, _>(block, law, u, extra, local),
            _ => block_energy_in::<3, _>(block, law, u, extra, local),
        })
    })
}

fn block_energy_in<const D: usize, L: ConstitutiveLaw>(
    block: &Block,
    law: &L,
    u: &[f64],
    extra: Option<&ExtraStress>,
    local: &mut LocalVectors,
) -> f64 {
    local.gather::<D>(&block.nodes, u);
    let relaxing = block.viscosity.as_ref().filter(|_| extra.is_none());
    let relaxing = relaxing.map_or(0.0, PronySeries::relaxing);
    let mut energy = 0.0;
    let mut jacobians = Vec::new();
    for Chunk { lanes, groups } in &block.chunks {
        jacobians.clear();
        for lane in lanes.clone() {
            let F = deformation_gradient::<D>(block, lane, local);
            let own = block.as_the_law_needs(&F, lane);
            let (mut density, J) = (law.strain_energy(&own), F.determinant());
            if relaxing > 0.0 {
                density -= relaxing * (density - law.bulk_energy(J));
            }
            if let Some(extra) = extra {
                density += extra.energy(lane, &(F.transpose() * F));
            }
            energy += block.quadrature_weights[lane] * density;
            jacobians.push(J);
        }
        if let Some(projection) = &block.projection {
            energy += projection.energy(&block.law, groups.clone(), &jacobians);
        }
    }
    energy
}

/// What the projection adds to the mean Cauchy stress at each quadrature point
/// \[Pa\], at displacements `u` \[m\]; 0 without one. The pressure is
/// −tr σ/3 less this.
pub fn projected_mean_stress(points: &PackedPoints, u: &[f64]) -> Vec<f64> {
    let mut stresses = vec![0.0; points.count()];
    with_local(|Local { u: local, .. }| {
        for block in &points.blocks {
            match points.components {
                2 => block_mean_stress::<2>(block, u, local, &mut stresses),
                _ => block_mean_stress::<3>(block, u, local, &mut stresses),
            }
        }
    });
    stresses
}

/// w J at each quadrature point at displacements `u` \[m\] \[m³\].
pub fn point_volumes(points: &PackedPoints, u: &[f64]) -> Vec<f64> {
    let mut volumes = vec![0.0; points.count()];
    with_local(|Local { u: local, .. }| {
        for block in &points.blocks {
            match points.components {
                2 => block_volumes::<2>(block, u, local, &mut volumes),
                _ => block_volumes::<3>(block, u, local, &mut volumes),
            }
        }
    });
    volumes
}

fn block_volumes<const D: usize>(
    block: &Block,
    u: &[f64],
    local: &mut LocalVectors,
    volumes: &mut [f64],
) {
    local.gather::<D>(&block.nodes, u);
    for lane in block.occupied() {
        let jacobian = deformation_gradient::<D>(block, lane, local).determinant();
        volumes[block.point(lane)] = block.quadrature_weights[lane] * jacobian;
    }
}

fn block_mean_stress<const D: usize>(
    block: &Block,
    u: &[f64],
    local: &mut LocalVectors,
    stresses: &mut [f64],
) {
    let Some(projection) = &block.projection else { return };
    local.gather::<D>(&block.nodes, u);
    for Chunk { lanes, groups } in &block.chunks {
        let jacobian = |lane| deformation_gradient::<D>(block, lane, local).determinant();
        let jacobians: Vec<f64> = lanes.clone().map(jacobian).collect();
        let pressures = projection.plain_pressures(&block.law, groups.clone(), &jacobians);
        lanes.clone().zip(pressures).for_each(|(lane, p)| stresses[block.point(lane)] = p);
    }
}

/// F = I + Σ_a u_a ⊗ Grad φ_a at the point in a lane; in a plane F₃₃ = 1.
#[inline(always)]
fn deformation_gradient<const D: usize>(block: &Block, lane: usize, u: &LocalVectors) -> Matrix3 {
    // Chooses the precision in which gradients are stored.
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
    points: &PackedPoints,
    block: &Block,
    u: &[f64],
    mut visit: impl FnMut(usize, &Matrix3),
) {
    with_local(|Local { u: local, .. }| match points.components {
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
