//! Regions of the body as solids, and the cells cut where regions meet.
#![allow(non_snake_case)]

use super::cut::split;
use super::mesh::Mesh;
use super::snap::{Freedom, snap};
use mtled::algebra::tensor::Vector3;
use mtled::geometry::{LabelField, Selector, Shape};
use mtled::problem::{Dimension, Region};
use rayon::prelude::*;
use std::sync::Arc;

/// Voxels about a label: cells are cut and moved near its outline alone.
const AROUND: usize = 16;

/// What a selection takes of a body; `None` where that is no solid.
pub(crate) fn solid(part: &Selector, body: &Shape) -> Option<Shape> {
    let selected = selected(part, body)?;
    // What both have: one without what is left of it without the other. The first bounds it.
    let (first, second) = match (part, selected.bounding_box()) {
        (Selector::All, _) => return Some(selected),
        (_, Some(_)) => (&selected, body),
        (_, None) => (body, &selected),
    };
    Some(without(first, without(first, second.clone())))
}

/// The solid of a selection, in the body or around it.
fn selected(part: &Selector, body: &Shape) -> Option<Shape> {
    match part {
        Selector::All => Some(body.clone()),
        Selector::Inside { shape, .. } => Some(shape.clone()),
        Selector::Label { map, label } => {
            let smoothing = match body {
                Shape::Labels(field) => field.smoothing(),
                _ => LabelField::SMOOTHING,
            };
            let near = Arc::new(map.about(&[*label], AROUND));
            Some(Shape::Labels(LabelField::new(near, &[*label], smoothing).ok()?.into()))
        }
        Selector::Union(parts) => {
            let parts = parts.iter().map(|part| solid(part, body));
            Some(Shape::Union(parts.collect::<Option<_>>()?))
        }
        Selector::Plane { .. }
        | Selector::Facing { .. }
        | Selector::Intersection(_)
        | Selector::Not(_) => None,
    }
}

fn without(shape: &Shape, hole: Shape) -> Shape {
    Shape::Difference(Box::new(shape.clone()), Box::new(hole))
}

/// The region of a cell that has none yet.
const NONE: u16 = u16::MAX;

/// Cuts cells along the surfaces of the regions and gives each its region: the first that has
/// it. Selections that are no solids take whole cells, by their centres.
pub(crate) fn into_regions(
    mesh: &mut Mesh,
    regions: &[Region],
    body: &Shape,
    dimension: &Dimension,
) {
    mesh.regions.fill(NONE);
    let last = regions.len().saturating_sub(1);
    for (number, region) in regions.iter().enumerate().take(last) {
        let shape = selected(&region.part, body).and_then(|shape| shape.section(dimension).ok());
        match shape.filter(|_| !matches!(region.part, Selector::All)) {
            Some(shape) => cut_out(mesh, &shape, number as u16),
            None => take(mesh, &region.part, number as u16),
        }
    }
    mesh.regions.iter_mut().filter(|own| **own == NONE).for_each(|own| *own = last as u16);
}

/// Gives the part of cells without a region that lies inside a solid a region.
fn cut_out(mesh: &mut Mesh, shape: &Shape, region: u16) {
    let level = |X: &Vector3| shape.signed_distance(X);
    let mut values: Vec<f64> = mesh.vertices.par_iter().map(level).collect();
    let mut fixed = vec![false; mesh.vertices.len()];
    for (side, _) in mesh.boundary() {
        side.iter().for_each(|&vertex| fixed[vertex as usize] = true);
    }
    // Where other regions meet nothing moves either.
    for (cell, own) in mesh.iter().zip(&mesh.regions).filter(|(_, own)| **own != NONE) {
        debug_assert!(*own < region);
        cell.iter().for_each(|&vertex| fixed[vertex as usize] = true);
    }
    snap(mesh, &mut values, &level, &Freedom::but(fixed));
    let (cut, inside, _) = split(mesh, &values, &level);
    *mesh = cut;
    for (own, inside) in mesh.regions.iter_mut().zip(inside) {
        if inside && *own == NONE {
            *own = region;
        }
    }
}

/// Gives cells without a region whose centres are selected a region.
fn take(mesh: &mut Mesh, part: &Selector, region: u16) {
    let centres: Vec<Vector3> = mesh.iter().map(|cell| mesh.centre(cell)).collect();
    for (own, centre) in mesh.regions.iter_mut().zip(&centres) {
        if *own == NONE && part.contains(centre) {
            *own = region;
        }
    }
}
