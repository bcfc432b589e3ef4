//! Pressures of patches as unknowns beside the displacements, where a body is nearly
//! incompressible.

use crate::algebra::packed::{axpy, dot};
use crate::model::{Model, ModuliAtRest};
use crate::motion::internal_force::OwnPressures;
use nalgebra::{DMatrix, DVector};

/// Largest projected bulk modulus over the shear modulus in the tangent \[–\].
const MOST: f64 = 30.0;
/// The same of a body from which on pressures are unknowns from the start \[–\].
const NEARLY_INCOMPRESSIBLE: f64 = 100.0;
/// Changes before the last one that the pressures are extrapolated from.
const REMEMBERED: usize = 3;
/// Fall of a change in two corrections above which they are extrapolated \[–\]: otherwise
/// corrections do well without, and what is left of their residuals disturbs.
const SLOW: f64 = 0.5;
/// What is added to the diagonal of their Gram matrix over its trace \[–\]: round-off.
const DEPENDENT: f64 = 1e-10;

/// The pressures, and how they came to be.
#[derive(Clone)]
pub(super) struct Pressures {
    pub own: OwnPressures,
    /// Those before the last corrections, and the changes f that these asked for.
    past: Vec<[Vec<f64>; 2]>,
}

impl Pressures {
    /// As they are.
    pub fn new(own: OwnPressures) -> Pressures {
        Pressures { own, past: Vec::new() }
    }

    /// Forgets what changed under other conditions.
    pub fn forget(&mut self) {
        self.past.clear();
    }

    /// Goes towards the pressures that J gives, extrapolated from the last corrections where
    /// that is slow (method book, eq. 21.15: Anderson 1965).
    pub fn follow<'a>(&mut self, of_j: impl Iterator<Item = &'a [[f64; 4]]>) {
        let before = self.own.values();
        self.own.approach(of_j, 1.0);
        let mut after = self.own.values();
        let change = difference(&after, &before);
        self.past.push([before, change]);
        if self.past.len() > REMEMBERED + 1 {
            self.past.remove(0);
        }
        let differences = match self.is_slow() {
            true => self.differences(),
            false => Vec::new(),
        };
        for ([pressures, changes], factor) in differences.iter().zip(self.factors(&differences)) {
            axpy(&mut after, -factor, pressures);
            axpy(&mut after, -factor, changes);
        }
        self.own.set_values(&after);
    }

    fn is_slow(&self) -> bool {
        let length = |change: &[f64]| dot(change, change).sqrt();
        match &self.past[..] {
            [.., [_, before], _, [_, now]] => length(now) > SLOW * length(before),
            _ => false,
        }
    }

    /// Δp and Δf between successive corrections.
    fn differences(&self) -> Vec<[Vec<f64>; 2]> {
        let pairs = self.past.windows(2);
        pairs.map(|pair| [0, 1].map(|part| difference(&pair[1][part], &pair[0][part]))).collect()
    }

    /// γ of least |f − Σ_j γ_j Δf_j| for the last change f; none where they depend on each other.
    fn factors(&self, differences: &[[Vec<f64>; 2]]) -> Vec<f64> {
        let Some([_, change]) = self.past.last() else { return Vec::new() };
        let count = differences.len();
        if count == 0 {
            return Vec::new();
        }
        let product = |i: usize, j: usize| dot(&differences[i][1], &differences[j][1]);
        let mut gram = DMatrix::from_fn(count, count, product);
        let least = DEPENDENT * gram.trace();
        (0..count).for_each(|i| gram[(i, i)] += least);
        let right = DVector::from_fn(count, |i, _| dot(&differences[i][1], change));
        let solved = gram.cholesky().map(|cholesky| cholesky.solve(&right));
        solved.map_or(Vec::new(), |factors| factors.iter().copied().collect())
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Largest projected bulk modulus over the shear modulus \[–\].
fn largest_ratio(model: &Model) -> f64 {
    let ratios = model.blocks.iter().map(|block| {
        let moduli = ModuliAtRest::of(block);
        moduli.projected / moduli.shear
    });
    ratios.fold(0.0, f64::max)
}

/// Whether pressures are unknowns from the start (method book, eq. 21.16).
pub(super) fn are_unknowns(model: &Model) -> bool {
    largest_ratio(model) > NEARLY_INCOMPRESSIBLE
}

/// Largest projected bulk modulus over the shear modulus in the tangent \[–\], where pressures are
/// unknowns or are not.
pub(super) fn most(unknown: bool) -> f64 {
    if unknown { MOST } else { f64::INFINITY }
}

/// Whether they may become unknowns.
pub(super) fn can_be_unknowns(model: &Model) -> bool {
    largest_ratio(model) > MOST
}
