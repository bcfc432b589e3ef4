//! Signed distance of single solids \[m\], negative inside.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;

/// Of an axis-parallel box.
pub fn box_distance(X: &Vector3, min: &Vector3, max: &Vector3) -> f64 {
    let q = (min - X).sup(&(X - max));
    q.sup(&Vector3::zeros()).norm() + q.max().min(0.0)
}

/// Of a product of two solids of lower dimension from their own distances.
pub fn product_distance(radial: f64, axial: f64) -> f64 {
    radial.max(0.0).hypot(axial.max(0.0)) + radial.max(axial).min(0.0)
}

/// Of a finite cylinder.
pub fn cylinder_distance(
    X: &Vector3,
    base: &Vector3,
    axis: &Vector3,
    radius: f64,
    height: f64,
) -> f64 {
    let d = X - base;
    let s = d.dot(axis);
    product_distance((d - s * axis).norm() - radius, (-s).max(s - height))
}

/// Point of an axis-parallel ellipsoid closest to `d`, both from its centre.
/// An infinite third radius makes it an elliptic cylinder.
///
/// The closest point is xᵢ = rᵢ²dᵢ/(t + rᵢ²) with t the root of
/// Σ (rᵢdᵢ/(t + rᵢ²))² = 1 right of −min rᵢ² (Eberly 2013). One over the root of the sum is
/// concave there and nearly linear, so Newton's method from a lower bound cannot overshoot and
/// takes few steps (Moré & Sorensen 1983, of a secular equation). Zero coordinates are moved by 1e-14 r, which moves the distance by no more.
pub fn closest_on_ellipsoid(d: &Vector3, radii: &Vector3) -> Vector3 {
    let axes = if radii.z.is_finite() { 3 } else { 2 };
    let small = 1e-14 * radii.rows(0, axes).max();
    let y = d.map(|c| c.abs().max(small));
    // t + rᵢ² = s + excessᵢ loses no digits where t is close to −min rᵢ².
    let least = radii.rows(0, axes).min();
    let excess = radii.map(|r| (r - least) * (r + least));
    let mut s = (0..axes).map(|i| radii[i] * y[i] - excess[i]).fold(0.0, f64::max);
    for _ in 0..200 {
        let (mut sum, mut slope) = (0.0, 0.0);
        for i in 0..axes {
            let inverse = 1.0 / (s + excess[i]);
            let term = (radii[i] * y[i] * inverse).powi(2);
            sum += term;
            slope += term * inverse;
        }
        let step = sum * (sum.sqrt() - 1.0) / slope;
        // Converged, or turned back by rounding.
        if step.is_nan() || step <= 1e-16 * s {
            break;
        }
        s += step;
    }
    let mut closest = *d;
    for i in 0..axes {
        let squared = radii[i] * radii[i];
        closest[i] = (squared * y[i] / (s + excess[i])).copysign(d[i]);
    }
    closest
}

/// Of an axis-parallel ellipsoid, `d` from its centre.
pub fn ellipsoid_distance(d: &Vector3, radii: &Vector3) -> f64 {
    let distance = (d - closest_on_ellipsoid(d, radii)).norm();
    let inside = d.component_div(radii).norm_squared() < 1.0;
    if inside { -distance } else { distance }
}

/// Outward normal of an ellipsoid at its point closest to `d`.
pub fn ellipsoid_normal(d: &Vector3, radii: &Vector3) -> Vector3 {
    let closest = closest_on_ellipsoid(d, radii);
    let mut normal = closest.component_div(radii).component_div(radii);
    if radii.z.is_infinite() {
        normal.z = 0.0;
    }
    normal.try_normalize(0.0).unwrap_or_else(Vector3::x)
}

/// Two unit vectors perpendicular to a unit vector and to each other.
pub fn perpendicular(axis: &Vector3) -> (Vector3, Vector3) {
    let e = if axis.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let u = (e - e.dot(axis) * axis).normalize();
    (u, axis.cross(&u))
}
