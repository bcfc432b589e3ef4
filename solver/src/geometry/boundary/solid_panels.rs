//! Panels of single solids, where they are near the body.

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::panel::{Panel, pieces};
use crate::geometry::boundary::patch::{Chart, Patch};
use crate::geometry::boundary::vicinity::Vicinity;
use crate::geometry::polygon::{anticlockwise, triangulate};
use crate::geometry::primitives::perpendicular;
use crate::geometry::triangles::{Triangle, area_vector, subdivide};
use std::f64::consts::TAU;

/// Panels of edge `size` \[m\] of a parallelogram, those in a vicinity.
pub(super) fn rectangle(
    corner: Vector3,
    [u, v]: [Vector3; 2],
    (size, around): (f64, &Vicinity),
    patches: &mut Vec<Patch>,
) {
    let (nu, nv) = (pieces(u.norm(), size), pieces(v.norm(), size));
    let whole = u.cross(&v);
    let area = whole.norm() / (nu * nv) as f64;
    let normal = whole.normalize();
    let (du, dv) = (u / nu as f64, v / nv as f64);
    for j in around.steps(&corner, &dv, nv, &u) {
        let row = corner + j as f64 * dv;
        for i in around.steps(&row, &du, nu, &dv) {
            let (s, t) = ((i as f64 + 0.5) / nu as f64, (j as f64 + 0.5) / nv as f64);
            let panel = Panel::flat(corner + s * u + t * v, area, normal);
            let from = corner + i as f64 * du + j as f64 * dv;
            patches.push(Patch::square(panel, Chart::Flat { corner: from, u: du, v: dv }));
        }
    }
}

pub(super) fn box_patches(
    min: &Vector3,
    max: &Vector3,
    size: f64,
    around: &Vicinity,
) -> Vec<Patch> {
    let mut panels = Vec::new();
    let edges = max - min;
    for axis in 0..3 {
        let along = |k: usize| {
            let mut edge = Vector3::zeros();
            edge[(axis + k) % 3] = edges[(axis + k) % 3];
            edge
        };
        rectangle(*min, [along(2), along(1)], (size, around), &mut panels);
        rectangle(min + along(0), [along(1), along(2)], (size, around), &mut panels);
    }
    panels
}

pub(super) fn prism_patches(
    points: &[[f64; 2]],
    z: (f64, f64),
    size: f64,
    around: &Vicinity,
) -> Vec<Patch> {
    let points = anticlockwise(points);
    let mut panels = Vec::new();
    let up = Vector3::new(0.0, 0.0, z.1 - z.0);
    for (n, a) in points.iter().enumerate() {
        let b = points[(n + 1) % points.len()];
        let edge = Vector3::new(b[0] - a[0], b[1] - a[1], 0.0);
        rectangle(Vector3::new(a[0], a[1], z.0), [edge, up], (size, around), &mut panels);
    }
    for [a, b, c] in triangulate(&points) {
        let at = |z: f64| move |p: [f64; 2]| Vector3::new(p[0], p[1], z);
        let caps = [[a, b, c].map(at(z.1)), [a, c, b].map(at(z.0))];
        let near = caps.into_iter().filter(|corners| around.meets(corners));
        panels.extend(triangle_patches::<Patch>(near, size));
    }
    panels
}

pub(super) fn cylinder_patches(
    base: &Vector3,
    axis: &Vector3,
    radius: f64,
    height: f64,
    (size, vicinity): (f64, &Vicinity),
) -> Vec<Patch> {
    let (u, v) = perpendicular(axis);
    let ends = |n: usize, count: usize| {
        (n as f64 * TAU / count as f64, (n as f64 + 1.0) * TAU / count as f64)
    };
    let around = |n: usize, count: usize| {
        let (sin, cos) = ((n as f64 + 0.5) * TAU / count as f64).sin_cos();
        cos * u + sin * v
    };
    let mut patches = Vec::new();
    let mut push = |patch: Patch| {
        if vicinity.is_near(&patch.panel.centre, size) {
            patches.push(patch);
        }
    };
    let (count, layers) = (pieces(TAU * radius, size).max(8), pieces(height, size));
    for n in 0..layers * count {
        let normal = around(n % count, count);
        let layer = (n / count) as f64;
        let s = height * (layer + 0.5) / layers as f64;
        let area = TAU * radius * height / (count * layers) as f64;
        let along = (height * layer / layers as f64, height * (layer + 1.0) / layers as f64);
        let (base, axis, across, angle) = (*base, *axis, [u, v], ends(n % count, count));
        push(Patch::square(
            Panel::flat(base + s * axis + radius * normal, area, normal),
            Chart::Side { base, axis, across, radius, angle, along },
        ));
    }
    let rings = pieces(radius, size);
    for ring in 0..rings {
        let width = radius / rings as f64;
        let (inner, outer) = (ring as f64 * width, (ring + 1) as f64 * width);
        let count = pieces(TAU * outer, size).max(6);
        let area = 0.5 * TAU * (outer * outer - inner * inner) / count as f64;
        for n in 0..count {
            let at = base + 0.5 * (inner + outer) * around(n, count);
            let (across, radius, angle) = ([u, v], (inner, outer), ends(n, count));
            let cap =
                |centre: Vector3, side: f64| Chart::Sector { centre, across, radius, angle, side };
            push(Patch::square(Panel::flat(at, area, -axis), cap(*base, -1.0)));
            let top = Panel::flat(at + height * axis, area, *axis);
            push(Patch::square(top, cap(base + height * axis, 1.0)));
        }
    }
    patches
}

/// Bands of latitude on the unit sphere with exact areas, mapped by Nanson's
/// formula N dA = cof(D) n da with D the diagonal of the radii.
pub(super) fn ellipsoid_patches(
    centre: &Vector3,
    radii: &Vector3,
    size: f64,
    around: &Vicinity,
) -> Vec<Patch> {
    let largest = radii.max();
    let bands = pieces(0.5 * TAU * largest, size).max(4);
    let cofactor = Vector3::repeat(radii.product()).component_div(radii);
    let mut patches = Vec::new();
    for band in 0..bands {
        let polar = |n: f64| n * 0.5 * TAU / bands as f64;
        let (top, bottom) = (polar(band as f64), polar(band as f64 + 1.0));
        let (sin, cos) = polar(band as f64 + 0.5).sin_cos();
        let count = pieces(TAU * sin * largest, size).max(6);
        let area = (top.cos() - bottom.cos()) * TAU / count as f64;
        for n in 0..count {
            let longitude = |n: f64| n * TAU / count as f64;
            let (s, c) = longitude(n as f64 + 0.5).sin_cos();
            let unit = Vector3::new(sin * c, sin * s, cos);
            let mapped = cofactor.component_mul(&unit);
            let at = centre + radii.component_mul(&unit);
            let (centre, radii, polar) = (*centre, *radii, (top, bottom));
            let angle = (longitude(n as f64), longitude(n as f64 + 1.0));
            if around.is_near(&at, size) {
                patches.push(Patch::square(
                    Panel::flat(at, area * mapped.norm(), mapped.normalize()),
                    Chart::Ellipsoid { centre, radii, polar, angle },
                ));
            }
        }
    }
    patches
}

pub(super) fn triangle_patches<T: From<Patch>>(
    triangles: impl Iterator<Item = Triangle>,
    size: f64,
) -> Vec<T> {
    let mut patches = Vec::new();
    for triangle in triangles {
        subdivide(triangle, size, &mut |t| {
            let whole = area_vector(&t);
            let area = whole.norm();
            if area > 0.0 {
                let panel = Panel::flat((t[0] + t[1] + t[2]) / 3.0, area, whole / area);
                patches.push(Patch::triangle(panel, t[0], t[1] - t[0], t[2] - t[0]).into());
            }
        });
    }
    patches
}
