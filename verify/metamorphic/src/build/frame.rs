//! Where a scene lies in space.

use crate::scene::Scene;
use mtled::Vector3;
use mtled::algebra::tensor::Matrix3;
use mtled::problem::defaults::SELECTION_TOLERANCE;

/// Part of the usual tolerance of selections \[–\], so that a part whose depth has three digits
/// does not end at a node of a lattice.
const UNEVEN: f64 = 0.9713;

/// From coordinates over the size to places in space: x = size (Q X + shift).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    /// \[m\]
    pub size: f64,
    /// Rotation or mirror image that maps axes to axes.
    pub turn: Matrix3,
    /// Over the size \[–\].
    pub shift: Vector3,
    /// Edges of the box over the size, at home \[–\].
    pub edges: Vector3,
    /// How far a selection reaches beyond its shape \[m\].
    pub tolerance: f64,
}

impl Frame {
    /// The box with a corner at the origin and its edges along the axes.
    pub(crate) fn home(scene: &Scene) -> Frame {
        Frame {
            size: scene.size,
            turn: Matrix3::identity(),
            shift: Vector3::zeros(),
            edges: scene.edges.into(),
            tolerance: UNEVEN * SELECTION_TOLERANCE * scene.size / f64::from(scene.spacings),
        }
    }

    /// One of the 48 rotations and mirror images that map axes to axes; of the eight that
    /// leave z in a plane.
    pub(crate) fn turned(scene: &Scene, which: usize) -> Frame {
        const ORDERS: [[usize; 3]; 6] =
            [[1, 0, 2], [0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0]];
        let (orders, signs) = if scene.components() == 2 { (2, 4) } else { (6, 8) };
        let (order, sign) = (ORDERS[which % orders], which / orders % signs);
        let mut turn = Matrix3::zeros();
        for (axis, to) in order.into_iter().enumerate() {
            turn[(to, axis)] = if sign >> axis & 1 == 1 { -1.0 } else { 1.0 };
        }
        Frame { turn, ..Frame::home(scene) }
    }

    /// Middle of the box over the size, at home.
    pub(crate) fn middle(&self) -> Vector3 {
        0.5 * self.edges
    }

    /// A place \[m\].
    pub(crate) fn point(&self, at: &Vector3) -> Vector3 {
        self.size * (self.turn * at + self.shift)
    }

    /// A direction.
    pub(crate) fn direction(&self, along: &Vector3) -> Vector3 {
        self.turn * along
    }

    /// A displacement \[m\].
    pub(crate) fn length(&self, by: &Vector3) -> Vector3 {
        self.size * (self.turn * by)
    }

    /// A place over the size, at home, from a place in space \[m\].
    pub(crate) fn home_of(&self, place: &Vector3) -> Vector3 {
        self.turn.transpose() * (place / self.size - self.shift)
    }

    /// The axis to which one is mapped.
    pub(crate) fn axis(&self, axis: usize) -> usize {
        (0..3).find(|&to| self.turn[(to, axis)] != 0.0).unwrap_or(axis)
    }
}
