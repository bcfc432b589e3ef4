//! Patches whose points a gap of the body keeps apart (method book, section 10).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::discretisation::quadrature::Quadrature;
use crate::geometry::{Place, Shape};
use rayon::prelude::*;

/// Points of a patch that are closer than this belong together, unless a gap is between
/// them \[spacing\].
const TOGETHER: f64 = 1.6;

/// Divides each patch at the gaps of the body: its points are sorted by the pieces that they
/// make up. `patches` are where patches start, the end included, and so is what is returned.
/// Only patches with a point that is `beside_gap` are looked at.
pub fn part_at_gaps(
    quadrature: &mut Quadrature,
    patches: &[usize],
    body: &Shape,
    spacing_at: &(dyn Fn(&Vector3) -> f64 + Sync),
    beside_gap: &(dyn Fn(&Vector3) -> bool + Sync),
) -> Vec<usize> {
    let pieces = |patch: &[usize]| {
        let positions = &quadrature.positions[patch[0]..patch[1]];
        if positions.iter().any(beside_gap) {
            pieces(body, positions, TOGETHER * spacing_at(&positions[0]))
        } else {
            vec![0; positions.len()]
        }
    };
    let found: Vec<Vec<u32>> =
        patches.windows(2).collect::<Vec<_>>().into_par_iter().map(pieces).collect();
    let mut starts = vec![0];
    let mut order: Vec<usize> = Vec::with_capacity(quadrature.positions.len());
    for (patch, pieces) in patches.iter().zip(&found) {
        let count = pieces.iter().max().map_or(0, |&last| last + 1);
        for own in 0..count {
            let members = (0..pieces.len()).filter(|&point| pieces[point] == own);
            order.extend(members.map(|point| patch + point));
            starts.push(order.len());
        }
    }
    if starts.len() > patches.len() {
        quadrature.positions = order.iter().map(|&q| quadrature.positions[q]).collect();
        quadrature.weights = order.iter().map(|&q| quadrature.weights[q]).collect();
        quadrature.regions = order.iter().map(|&q| quadrature.regions[q]).collect();
    }
    starts
}

/// The piece of each point, numbered by their first members; members are linked by ways
/// shorter than `together` \[m\].
fn pieces(body: &Shape, positions: &[Vector3], together: f64) -> Vec<u32> {
    let places: Vec<Place> = positions.iter().map(|X| body.place(X)).collect();
    let near = |a: usize, b: usize| (positions[a] - positions[b]).norm() < together;
    let mut piece = vec![u32::MAX; positions.len()];
    let mut count = 0;
    for first in 0..positions.len() {
        if piece[first] != u32::MAX {
            continue;
        }
        piece[first] = count;
        let mut members = vec![first];
        while let Some(from) = members.pop() {
            for to in 0..positions.len() {
                let is_new = piece[to] == u32::MAX && near(from, to);
                if is_new && !body.parts(&places[from], &places[to], together / TOGETHER) {
                    piece[to] = count;
                    members.push(to);
                }
            }
        }
        count += 1;
    }
    piece
}
