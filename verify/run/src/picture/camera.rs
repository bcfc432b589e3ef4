//! A direction of view with parallel rays.
#![allow(non_snake_case)]

use mtled::algebra::tensor::Vector3;

/// Where the viewer stands, seen from the body; not of length zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction(pub Vector3);

impl Direction {
    /// From the front, the right and above.
    pub(crate) fn oblique() -> Direction {
        Direction(Vector3::new(0.55, -1.0, 0.55))
    }

    /// From above, for bodies in a plane.
    pub(crate) fn above() -> Direction {
        Direction(Vector3::z())
    }
}

/// Unit vectors to the right, upwards and towards the viewer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Camera {
    pub right: Vector3,
    pub up: Vector3,
    pub towards: Vector3,
}

impl Camera {
    /// z is up, and y where one looks along z.
    pub(crate) fn new(direction: Direction) -> Camera {
        let towards = direction.0.try_normalize(0.0).unwrap_or_else(Vector3::z);
        let upright = if towards.z.abs() > 0.999 { Vector3::y() } else { Vector3::z() };
        let right = upright.cross(&towards).normalize();
        Camera { right, up: towards.cross(&right), towards }
    }

    /// To the right, upwards and towards the viewer \[m\].
    pub(crate) fn seen(&self, x: &Vector3) -> Vector3 {
        Vector3::new(x.dot(&self.right), x.dot(&self.up), x.dot(&self.towards))
    }
}
