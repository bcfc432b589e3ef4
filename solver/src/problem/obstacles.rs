//! Rigid obstacles, and how they move.

use crate::algebra::tensor::Vector3;
use crate::geometry::Shape;
use crate::problem::amplitude::Amplitude;
use crate::problem::check::{Mistake, Mistakes};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion};

/// A rigid obstacle that nodes may not enter.
#[derive(Debug, Clone)]
pub struct Obstacle {
    /// Name in reports and messages.
    pub name: String,
    /// The solid, or the cavity, before it moves.
    pub shape: Shape,
    /// The shape is grown by this much first \[m\].
    pub offset: f64,
    /// Where the body is.
    pub side: ObstacleSide,
    /// What happens along the surface.
    pub friction: Friction,
    /// How it moves, one motion after the other in axes that stay; nothing where it stands still.
    pub motions: Vec<RigidMotion>,
}

/// On which side of the obstacle's surface the body lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObstacleSide {
    /// The shape is solid; the body stays outside.
    Outside,
    /// The shape is a cavity, as in a skull; the body stays inside.
    Inside,
}

/// What happens along the surface of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    /// Nodes slide freely.
    Frictionless,
    /// Nodes that touch do not slide while they touch.
    NoSlip,
    /// Coulomb's law: the force along the surface is at most this coefficient \[–\] times the one
    /// that pushes, and a node that slides is pushed against its way.
    Coulomb(f64),
}

/// A prescribed motion of an obstacle.
#[derive(Debug, Clone)]
pub struct RigidMotion {
    /// Its way at amplitude 1.
    pub way: RigidWay,
    /// The factor over time of the way, or of the angle.
    pub amplitude: Amplitude,
}

/// A translation or a rotation.
#[derive(Debug, Clone, Copy)]
pub enum RigidWay {
    /// \[m\]
    Translation(Vector3),
    /// About an axis.
    Rotation {
        /// A point on the axis \[m\].
        point: Vector3,
        /// Unit vector along the axis.
        axis: Vector3,
        /// \[rad\]
        angle: f64,
    },
}

impl Friction {
    /// Every number that cannot be used.
    pub fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        if let Friction::Coulomb(coefficient) = self {
            found.not_negative("coulomb", *coefficient);
            found.finite("coulomb", *coefficient);
        }
        found.0
    }
}

impl RigidMotion {
    /// Where it has led at time `t` \[s\].
    fn at(&self, t: f64) -> Isometry3<f64> {
        let factor = self.amplitude.at(t);
        match self.way {
            RigidWay::Translation(way) => {
                Isometry3::from_parts(Translation3::from(factor * way), UnitQuaternion::identity())
            }
            RigidWay::Rotation { point, axis, angle } => {
                let turn =
                    UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), factor * angle);
                Isometry3::from_parts(Translation3::from(point - turn * point), turn)
            }
        }
    }
}

impl Obstacle {
    /// One that stands still, grown by nothing, without friction, with the body outside of it.
    pub fn new(name: &str, shape: Shape) -> Obstacle {
        Obstacle {
            name: name.to_string(),
            shape,
            offset: 0.0,
            side: ObstacleSide::Outside,
            friction: Friction::Frictionless,
            motions: Vec::new(),
        }
    }

    /// Every number that cannot be used.
    pub(super) fn check(&self) -> Vec<Mistake> {
        let mut found = Mistakes::default();
        found.finite("offset", self.offset);
        found.part("friction", self.friction.check());
        for (n, motion) in self.motions.iter().enumerate() {
            found.part(&format!("motions[{n}].amplitude"), motion.amplitude.check());
        }
        found.0
    }

    /// Where it has moved at time `t` \[s\]; nothing where it stands still.
    pub fn place(&self, t: f64) -> Option<Isometry3<f64>> {
        self.motions.iter().map(|motion| motion.at(t)).reduce(|before, after| after * before)
    }
}

/// Whether the way on which a body came to rest matters, because it sticks to an obstacle or rubs
/// along one.
pub(crate) fn depends_on_way(obstacles: &[Obstacle]) -> bool {
    obstacles.iter().any(|obstacle| obstacle.friction != Friction::Frictionless)
}
