//! Points moved until functions of second order are integrated (method book, eq. 7.6).
//!
//! A point at the centroid of its piece of the body integrates linear functions. Of
//! others it misses ∫ f − w f(x) ≈ ½ w S : ∇∇f, S the second moments of the piece over
//! its volume. Inside a body of equal pieces the misses sum to a term on the boundary:
//! moving the points there, and where cells change their size, by s_q with
//! Σ_q w_q s_q · g(x_q) = ½ Σ_c w_c S_c : ∇g(x_c), g = ∇f, makes up for them. ∇g at x_c is
//! taken from the points around by weighted least squares.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::mls::inverse;
use crate::discretisation::moments::homogeneous;
use crate::discretisation::neighbours::Neighbours;
use crate::discretisation::quadrature::borders::owner;
use crate::discretisation::quadrature::rule::Quadrature;
use crate::geometry::Shape;
use crate::problem::Region;
use nalgebra::{Matrix4, Vector4};
use rayon::prelude::*;

/// The piece of the body that a point stands for.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    /// Of its cell \[m\].
    pub edge: f64,
    /// Second moments about the centroid over the volume \[m²\].
    pub spread: Matrix3,
}

/// Which points are moved.
pub struct Moves<'a> {
    /// Points that stay, by their place \[m\]: where the solution is not smooth.
    pub stays: &'a (dyn Fn(&Vector3) -> bool + Sync),
}

/// Slopes at a point are taken from those within this reach \[edge\].
const REACH: f64 = 1.8;
/// Added to the moments of the points around along each axis, over their weight \[–\]: along
/// an axis with no other point, slopes are 0.
const RIDGE: f64 = 1e-3;
/// Largest move of a point \[edge\].
const LARGEST_MOVE: f64 = 0.15;
/// Smaller moves are round-off among equal pieces \[edge\].
const ROUND_OFF: f64 = 1e-9;
/// A point that would leave its region is moved by one of these parts.
const PARTS: [f64; 3] = [1.0, 0.5, 0.25];
/// Points whose shares are computed in parallel before they are added in their order.
const CHUNK: usize = 8192;

impl Moves<'_> {
    /// Moves the points, which stand for `pieces`; each stays in its region.
    pub(super) fn apply(
        &self,
        pieces: &[Piece],
        body: &Shape,
        regions: &[Region],
        quadrature: &mut Quadrature,
    ) {
        let moments = moments(pieces, quadrature);
        let has_gaps = !body.is_convex();
        let inside = |X: &Vector3, region: u16| {
            body.signed_distance(X) <= 0.0
                && (regions.len() == 1 || owner(regions, X) == Some(usize::from(region)))
        };
        let moved = |point: usize| {
            let (X, region) = (quadrature.positions[point], quadrature.regions[point]);
            let mut shift = moments[point] / quadrature.weights[point];
            let (length, edge) = (shift.norm(), pieces[point].edge);
            if length < ROUND_OFF * edge || (self.stays)(&X) {
                return X;
            }
            shift *= (LARGEST_MOVE * edge / length).min(1.0);
            let allowed = |part: &f64| {
                let to = X + *part * shift;
                let across = || has_gaps && body.parts(&body.place(&X), &body.place(&to), edge);
                inside(&to, region) && !across()
            };
            PARTS.into_iter().find(allowed).map_or(X, |part| X + part * shift)
        };
        let positions = (0..pieces.len()).into_par_iter().map(moved).collect();
        quadrature.positions = positions;
    }
}

/// w_q s_q of each point \[m⁴\].
fn moments(pieces: &[Piece], quadrature: &Quadrature) -> Vec<Vector3> {
    let mean = pieces.iter().map(|piece| piece.edge).sum::<f64>() / pieces.len() as f64;
    let near = Neighbours::new(&quadrature.positions, REACH * mean);
    let points: Vec<usize> = (0..pieces.len()).collect();
    let mut moments = vec![Vector3::zeros(); pieces.len()];
    for chunk in points.chunks(CHUNK) {
        let shares: Vec<Vec<(usize, Vector3)>> =
            chunk.par_iter().map(|&point| shares(pieces, quadrature, &near, point)).collect();
        for (other, share) in shares.into_iter().flatten() {
            moments[other] += share;
        }
    }
    moments
}

/// ½ w S B W(x_q − x) w_q (1, x_q − x) of each point q around: what the miss of one point adds
/// to their moments. B has the rows of the inverse of the moments that give a slope.
fn shares(
    pieces: &[Piece],
    quadrature: &Quadrature,
    near: &Neighbours,
    point: usize,
) -> Vec<(usize, Vector3)> {
    let Piece { edge, spread } = pieces[point];
    let region = quadrature.regions[point];
    let mut around = Vec::with_capacity(32);
    let mut moments = Matrix4::zeros();
    near.for_each_within(&quadrature.positions[point], REACH * edge, |other, offset| {
        if quadrature.regions[other] == region {
            let p = homogeneous(&(offset / edge));
            let closeness = 1.0 - offset.norm_squared() / (REACH * edge).powi(2);
            let weight = quadrature.weights[other] * closeness * closeness;
            moments.ger(weight, &p, &p, 1.0);
            around.push((other, weight, p));
        }
    });
    let ridge = RIDGE * moments[(0, 0)];
    (1..4).for_each(|k| moments[(k, k)] += ridge);
    let Some(inverse) = inverse(&moments) else { return Vec::new() };
    let miss = 0.5 * quadrature.weights[point] * spread / edge;
    let share = |(other, weight, p): (usize, f64, Vector4<f64>)| {
        let slope = inverse * p;
        (other, miss * (weight * Vector3::new(slope[1], slope[2], slope[3])))
    };
    around.into_iter().map(share).collect()
}
