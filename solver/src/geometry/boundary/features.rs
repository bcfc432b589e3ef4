//! Candidates for boundary nodes of single shapes: corners, evenly divided
//! edges, and patterns on faces.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::marching::contours;
use crate::geometry::boundary::panel::pieces;
use crate::geometry::boundary::target_spacing::{TargetSpacing, lattice_cells, nearest_count};
use crate::geometry::error::GeometryError;
use crate::geometry::polygon::{Outline, anticlockwise};
use crate::geometry::primitives::perpendicular;
use crate::geometry::shape::Shape;
use crate::geometry::surface::Surface;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

/// Candidates \[m\] in the order in which they are chosen.
#[derive(Default)]
pub(super) struct Features {
    pub corners: Vec<Vector3>,
    pub edges: Vec<Vector3>,
    pub faces: Vec<Vector3>,
}

/// Of a section at height z.
pub(super) fn of_section(
    shape: &Shape,
    z: f64,
    target: &TargetSpacing,
) -> Result<Features, GeometryError> {
    let mut features = Features::default();
    let at = |p: &[f64; 2]| Vector3::new(p[0], p[1], z);
    match shape {
        Shape::Polygon { points, .. } => {
            features.corners = points.iter().map(at).collect();
            for (n, a) in features.corners.iter().enumerate() {
                let b = features.corners[(n + 1) % points.len()];
                features.faces.extend(divide(&[*a, b], target, false));
            }
        }
        Shape::Ellipsoid { centre, radii } => {
            let fine =
                (TAU * radii.x.max(radii.y) / (0.1 * target.smallest)).clamp(256.0, 1e6) as usize;
            let curve: Vec<Vector3> = (0..fine)
                .map(|n| {
                    let (sin, cos) = (n as f64 * TAU / fine as f64).sin_cos();
                    Vector3::new(centre.x + radii.x * cos, centre.y + radii.y * sin, z)
                })
                .collect();
            features.faces = divide(&curve, target, true);
        }
        Shape::Labels(_) | Shape::Function(_) => {
            let voxel = if let Shape::Labels(field) = shape { field.voxel() } else { f64::MAX };
            for curve in contours(shape, z, voxel.min(0.5 * target.smallest))? {
                let curve: Vec<Vector3> = curve.iter().map(at).collect();
                features.faces.extend(divide(&curve, target, true));
            }
        }
        _ => {}
    }
    Ok(features)
}

/// Of a solid in space. Faces get a pattern only if the spacing is uniform.
pub(super) fn of_solid(shape: &Shape, target: &TargetSpacing) -> Features {
    let mut features = Features::default();
    match shape {
        Shape::Box { min, max } => {
            let square = [[min.x, min.y], [max.x, min.y], [max.x, max.y], [min.x, max.y]];
            prism(&square, (min.z, max.z), target, &mut features);
        }
        Shape::Polygon { points, z } => prism(points, *z, target, &mut features),
        Shape::Cylinder { base, axis, radius, height } => {
            cylinder(base, axis, *radius, *height, target, &mut features);
        }
        Shape::Sphere { centre, radius } if target.uniform() => {
            features.faces = fibonacci(centre, *radius, target.smallest);
        }
        Shape::Surface(surface) => sharp(surface, target, &mut features),
        _ => {}
    }
    features
}

/// Points that divide a polyline evenly in units of the local spacing: all
/// of a closed one, those between the ends of an open one.
pub(super) fn divide(curve: &[Vector3], target: &TargetSpacing, closed: bool) -> Vec<Vector3> {
    let mut points = vec![curve[0]];
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    let last = if closed { curve.len() } else { curve.len() - 1 };
    for n in 0..last {
        let (a, b) = (curve[n], curve[(n + 1) % curve.len()]);
        let parts = if target.uniform() {
            1
        } else {
            pieces((b - a).norm(), 0.2 * target.smallest).min(100_000)
        };
        for part in 0..parts {
            let at = |s: f64| a + s / parts as f64 * (b - a);
            let size = (target.at)(&at(part as f64 + 0.5));
            sum += (b - a).norm() / (parts as f64 * size);
            points.push(at(part as f64 + 1.0));
            sums.push(sum);
        }
    }
    let count = nearest_count(sum).max(if closed { 3 } else { 1 });
    let mut segment = 0;
    (usize::from(!closed)..count)
        .map(|n| {
            let goal = sum * n as f64 / count as f64;
            while sums[segment + 1] < goal && segment + 2 < sums.len() {
                segment += 1;
            }
            let width = sums[segment + 1] - sums[segment];
            let t = if width > 0.0 { (goal - sums[segment]) / width } else { 0.0 };
            points[segment] + t * (points[segment + 1] - points[segment])
        })
        .collect()
}

fn prism(points: &[[f64; 2]], z: (f64, f64), target: &TargetSpacing, features: &mut Features) {
    let points = anticlockwise(points);
    let at = |p: [f64; 2], z: f64| Vector3::new(p[0], p[1], z);
    for (n, &a) in points.iter().enumerate() {
        let b = points[(n + 1) % points.len()];
        features.corners.extend([at(a, z.0), at(a, z.1)]);
        features.edges.extend(divide(&[at(a, z.0), at(a, z.1)], target, false));
        for level in [z.0, z.1] {
            features.edges.extend(divide(&[at(a, level), at(b, level)], target, false));
        }
        if target.uniform() {
            let rise = divide(&[at(a, z.0), at(a, z.1)], target, false);
            for foot in divide(&[at(a, z.0), at(b, z.0)], target, false) {
                features.faces.extend(rise.iter().map(|r| Vector3::new(foot.x, foot.y, r.z)));
            }
        }
    }
    if target.uniform() {
        caps(&points, z, target.smallest, features);
    }
}

/// Lattice points keep more than this distance from a boundary or an outline \[spacing\]; a little more
/// than half, so that round-off does not decide about those at just that distance.
pub(crate) const CLEARANCE: f64 = 0.5 + 1e-6;

/// Lattice points inside a polygon, on both of its ends.
fn caps(points: &[[f64; 2]], z: (f64, f64), spacing: f64, features: &mut Features) {
    let bound = |axis: usize| {
        let along = points.iter().map(move |p| p[axis]);
        (along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max))
    };
    let ((x0, x1), (y0, y1)) = (bound(0), bound(1));
    let outline = Outline::from(points.to_vec());
    let (nx, ny) = (lattice_cells(x1 - x0, spacing), lattice_cells(y1 - y0, spacing));
    for j in 1..ny {
        for i in 1..nx {
            let x = x0 + (x1 - x0) * i as f64 / nx as f64;
            let y = y0 + (y1 - y0) * j as f64 / ny as f64;
            if outline.signed_distance(x, y) < -CLEARANCE * spacing {
                features.faces.extend([Vector3::new(x, y, z.0), Vector3::new(x, y, z.1)]);
            }
        }
    }
}

fn cylinder(
    base: &Vector3,
    axis: &Vector3,
    radius: f64,
    height: f64,
    target: &TargetSpacing,
    features: &mut Features,
) {
    let (u, v) = perpendicular(axis);
    let ring = |r: f64, s: f64, count: usize| -> Vec<Vector3> {
        let angles = (0..count).map(|n| n as f64 * TAU / count as f64);
        angles.map(|a| base + s * axis + r * (a.cos() * u + a.sin() * v)).collect()
    };
    let fine = (TAU * radius / (0.1 * target.smallest)).clamp(256.0, 1e6) as usize;
    for s in [0.0, height] {
        features.edges.extend(divide(&ring(radius, s, fine), target, true));
    }
    if !target.uniform() {
        return;
    }
    let spacing = target.smallest;
    let around = lattice_cells(TAU * radius, spacing).max(3);
    let layers = lattice_cells(height, spacing);
    for layer in 1..layers {
        features.faces.extend(ring(radius, height * layer as f64 / layers as f64, around));
    }
    let rings = lattice_cells(radius, spacing);
    for s in [0.0, height] {
        features.faces.push(base + s * axis);
        for n in 1..rings {
            let r = radius * n as f64 / rings as f64;
            features.faces.extend(ring(r, s, lattice_cells(TAU * r, spacing).max(3)));
        }
    }
}

/// A spiral of evenly distributed points, with the density of a hexagonal lattice
/// a little wider than `spacing`.
fn fibonacci(centre: &Vector3, radius: f64, spacing: f64) -> Vec<Vector3> {
    let count = (2.0 * TAU * (radius / spacing).powi(2)).round().max(4.0) as usize;
    let turn = 0.5 * TAU * (3.0 - 5_f64.sqrt());
    (0..count)
        .map(|n| {
            let z = 1.0 - (2 * n + 1) as f64 / count as f64;
            let (sin, cos) = (n as f64 * turn).sin_cos();
            let r = (1.0 - z * z).sqrt();
            centre + radius * Vector3::new(r * cos, r * sin, z)
        })
        .collect()
}

/// Corners where other than two sharp edges meet or two meet at an angle, and points that divide
/// the chains of sharp edges between corners evenly.
fn sharp(surface: &Surface, target: &TargetSpacing, features: &mut Features) {
    let mut edges = SharpEdges::default();
    for (a, b) in surface.sharp_edges() {
        edges.neighbours.entry(a).or_default().insert(b);
        edges.neighbours.entry(b).or_default().insert(a);
    }
    let is_corner = |vertex: &u32, next: &BTreeSet<u32>| {
        let away = |v: &u32| (surface.vertex(*v) - surface.vertex(*vertex)).normalize();
        let away: Vec<Vector3> = next.iter().map(away).collect();
        away.len() != 2 || away[0].dot(&away[1]) > -0.866
    };
    let corners = edges.neighbours.iter().filter(|(vertex, next)| is_corner(vertex, next));
    let corners: BTreeSet<u32> = corners.map(|(vertex, _)| *vertex).collect();
    features.corners.extend(corners.iter().map(|vertex| surface.vertex(*vertex)));
    // From corner to corner first; what is left then closes.
    let starts: Vec<u32> = corners.iter().chain(edges.neighbours.keys()).copied().collect();
    for start in starts {
        while let Some(chain) = edges.take_chain(start, &corners) {
            let closed = chain.len() > 2 && chain[0] == chain[chain.len() - 1];
            let count = chain.len() - usize::from(closed && !corners.contains(&start));
            let curve: Vec<Vector3> = chain[..count].iter().map(|v| surface.vertex(*v)).collect();
            features.edges.extend(divide(&curve, target, count < chain.len()));
        }
    }
}

/// Vertices that sharp edges join, from both sides.
#[derive(Default)]
struct SharpEdges {
    neighbours: BTreeMap<u32, BTreeSet<u32>>,
}

impl SharpEdges {
    /// Removes the edges from a vertex on to the next corner, or back to the vertex.
    fn take_chain(&mut self, start: u32, corners: &BTreeSet<u32>) -> Option<Vec<u32>> {
        let mut chain = vec![start];
        loop {
            let at = chain[chain.len() - 1];
            if chain.len() > 1 && (at == start || corners.contains(&at)) {
                return Some(chain);
            }
            let next = self.neighbours.get_mut(&at).and_then(BTreeSet::pop_first);
            let Some(next) = next else { return (chain.len() > 1).then_some(chain) };
            self.neighbours.entry(next).or_default().remove(&at);
            chain.push(next);
        }
    }
}
