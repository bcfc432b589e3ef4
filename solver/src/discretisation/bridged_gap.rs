//! Gaps that the nodes cannot tell from material.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::mls::Approximation;
use crate::discretisation::quadrature::Quadrature;
use crate::discretisation::rows::Rows;

/// Points on one side of a gap that need nodes on the other: there are too few on their own,
/// so that both sides move as one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BridgedGap {
    /// Number of such quadrature points.
    pub points: usize,
    /// What they stand for, over the volume of the body \[–\].
    pub fraction: f64,
    /// Middle of the widest gap between such a point and a node that it needs \[m\].
    pub position: Vector3,
    /// Its width, on the straight way between them \[m\].
    pub width: f64,
    /// Mean nodal spacing around \[m\].
    pub spacing: f64,
}

/// Slivers of less than this fraction of the body change no answer \[–\].
const SLIVERS: f64 = 1e-3;

impl BridgedGap {
    /// Whether so much material moves with that across a gap that answers may be wrong.
    pub fn matters(&self) -> bool {
        self.fraction > SLIVERS
    }

    /// Of the points `bridging`; `None` without any.
    pub(super) fn widest(
        approximation: &Approximation,
        quadrature: &Quadrature,
        supports: &Rows,
        bridging: &[usize],
    ) -> Option<BridgedGap> {
        let gaps = bridging.iter().filter_map(|&point| {
            let nodes = &supports.nodes[supports.row(point)];
            approximation.widest_gap(&quadrature.positions[point], nodes)
        });
        let (position, width) = gaps.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let volume = |points: &mut dyn Iterator<Item = usize>| -> f64 {
            points.map(|point| quadrature.weights[point]).sum()
        };
        let all = volume(&mut (0..quadrature.weights.len()));
        let fraction = volume(&mut bridging.iter().copied()) / all;
        let spacing = approximation.mean_spacing(&position);
        Some(BridgedGap { points: bridging.len(), fraction, position, width, spacing })
    }
}
