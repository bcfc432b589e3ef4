//! Pressures of patches as unknowns beside the displacements, where a body is nearly
//! incompressible.
#![allow(non_snake_case)]

use crate::algebra::packed::axpy;
use crate::force::{Block, ModuliAtRest, OwnPressures, Workspace};
use crate::material::Law;
use crate::model::Model;
use crate::motion::newton::linear::{Saddle, SaddlePatch};

/// Largest projected bulk modulus over the shear modulus beside pressures that are unknowns \[–\].
const MOST: f64 = 3.0;
/// The same of a body from which on pressures are unknowns from the start, and from which on they
/// become unknowns where an increment fails without \[–\].
const NEARLY_INCOMPRESSIBLE: f64 = 100.0;
const HARDLY_COMPRESSIBLE: f64 = 30.0;
/// Shear moduli that resist a change of volume in the Schur complement of a patch \[–\].
const RESISTS: f64 = 16.0;
/// Bounds of U''(θ) over U''(1) \[–\].
const STIFFENED: (f64, f64) = (0.1, 10.0);

/// The pressures, and what the displacements make of them.
#[derive(Clone)]
pub(crate) struct Pressures {
    pub own: OwnPressures,
    /// Moments that J gives \[Pa·m^(3/2)\].
    of_j: Vec<f64>,
    /// U''(θ) for the mean of θ \[patch\] \[Pa\].
    bulk: Vec<f64>,
}

/// A patch at rest.
struct AtRest<'a> {
    law: &'a Law,
    moduli: ModuliAtRest,
    /// s \[–\]
    fraction: f64,
    /// c \[–\]
    part: f64,
    /// The constant function of its basis \[m^(−3/2)\].
    constant: f64,
}

impl Pressures {
    /// Those that J gave in the last evaluation.
    pub fn of_j(model: &Model, workspace: &Workspace) -> Pressures {
        let own = OwnPressures::zero(&model.points, MOST);
        let mut pressures = Pressures { own, of_j: Vec::new(), bulk: Vec::new() };
        pressures.see(model, workspace);
        pressures.own.set_values(&pressures.of_j);
        pressures
    }

    /// Takes notice of what the displacements of the last evaluation make of the patches.
    pub fn see(&mut self, model: &Model, workspace: &Workspace) {
        self.of_j = workspace.pressures_of_j();
        let seen = patches(model).zip(workspace.patches());
        self.bulk = seen.map(|(patch, seen)| patch.bulk(patch.constant * seen.volume[0])).collect();
    }

    /// The rows of the pressures in the system of a correction.
    pub fn saddle(&self, model: &Model) -> Saddle {
        let (own, mut residual) = (self.own.values(), Vec::new());
        let rows = patches(model).zip(&self.bulk).map(|(patch, bulk)| patch.row(*bulk));
        let rows: Vec<SaddlePatch> = rows.collect();
        let gaps = self.of_j.as_chunks::<4>().0.iter().zip(own.as_chunks::<4>().0);
        for ((row, (of_j, own)), bulk) in rows.iter().zip(gaps).zip(&self.bulk) {
            let factor = if row.fraction > 0.0 { row.fraction / bulk } else { 0.0 };
            residual.extend((0..4).map(|b| factor * (own[b] - of_j[b])));
        }
        Saddle { residual, patches: rows }
    }

    /// Moves by a part of a correction q = (1 − c) Δp.
    pub fn moved(&self, model: &Model, part: f64, q: &[f64]) -> OwnPressures {
        let mut values = self.own.values();
        let rows = values.as_chunks_mut::<4>().0.iter_mut().zip(q.as_chunks::<4>().0);
        for (patch, (values, q)) in patches(model).zip(rows) {
            if patch.part < 1.0 {
                axpy(values, part / (1.0 - patch.part), q);
            }
        }
        let mut own = self.own.clone();
        own.set_values(&values);
        own
    }
}

impl AtRest<'_> {
    /// U''(θ) \[Pa\], kept near that at rest.
    fn bulk(&self, theta: f64) -> f64 {
        let slope = |theta: f64| self.law.bulk_slope(theta);
        let at_rest = self.moduli.projected / self.fraction;
        let bulk = (slope(theta + 1e-6) - slope(theta - 1e-6)) / 2e-6;
        bulk.max(STIFFENED.0 * at_rest).min(STIFFENED.1 * at_rest)
    }

    fn row(&self, bulk: f64) -> SaddlePatch {
        if self.part >= 1.0 {
            return SaddlePatch { fraction: 0.0, compliance: 1.0, schur: 1.0 };
        }
        let (s, shear) = (self.fraction, self.moduli.shear);
        let compliance = s / (bulk * (1.0 - self.part));
        let schur = compliance + s * s / ((RESISTS + MOST) * shear);
        SaddlePatch { fraction: s, compliance, schur }
    }
}

/// All patches, block by block.
fn patches(model: &Model) -> impl Iterator<Item = AtRest<'_>> {
    model.points.blocks.iter().flat_map(of_block)
}

fn of_block(block: &Block) -> impl Iterator<Item = AtRest<'_>> {
    let moduli = ModuliAtRest::of(block);
    block.projection.iter().flat_map(move |projection| {
        block.chunks.iter().map(move |chunk| AtRest {
            law: &block.law,
            moduli,
            fraction: projection.fraction,
            part: moduli.part_within(MOST),
            constant: projection.basis_at(chunk.lanes.start)[0],
        })
    })
}

/// Largest projected bulk modulus over the shear modulus \[–\].
fn largest_ratio(model: &Model) -> f64 {
    let ratios = model.points.blocks.iter().map(|block| {
        let moduli = ModuliAtRest::of(block);
        moduli.projected / moduli.shear
    });
    ratios.fold(0.0, f64::max)
}

/// Whether pressures are unknowns from the start (method book, eq. 21.16).
pub(crate) fn are_unknowns(model: &Model) -> bool {
    largest_ratio(model) > NEARLY_INCOMPRESSIBLE
}

/// Whether they may become unknowns.
pub(crate) fn can_be_unknowns(model: &Model) -> bool {
    largest_ratio(model) > HARDLY_COMPRESSIBLE
}

/// Largest projected bulk modulus over the shear modulus in the tangent \[–\], where pressures are
/// unknowns or are not.
pub(crate) fn most(unknown: bool) -> f64 {
    if unknown { MOST } else { f64::INFINITY }
}
