//! What a scene may have besides conditions and loads: springs, a fluid, memory, and an obstacle
//! that may move and rub.

use super::part::Part;
use serde::{Deserialize, Serialize};

/// Springs on a part of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bed {
    /// Where.
    pub part: Part,
    /// Stiffness along the normal, times size over stiffness \[–\].
    pub normal: f64,
    /// The same along the surface.
    pub tangential: f64,
}

/// Which part of a body is of another material.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Piece {
    /// What lies behind the middle along the axis.
    #[default]
    Half,
    /// A layer across the axis, this thick, over the edge of the box \[–\].
    Layer(f64),
    /// The same, a third of a right angle askew.
    Askew(f64),
    /// A ball about the middle, of this radius over the shortest edge of the box \[–\].
    Ball(f64),
}

/// A fluid that fills the hole of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Filling {
    /// Bulk modulus over the stiffness \[–\].
    pub bulk_modulus: f64,
    /// Volume that is added over that of the hole \[–\].
    pub inflow: f64,
}

/// A stress that relaxes by one term of a Prony series.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// The part of the isochoric stress that relaxes \[–\].
    pub part: f64,
    /// Relaxation time over that of the run \[–\].
    pub time: f64,
}

/// A solid below the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Wall {
    /// Whether it is a ball instead of a plane.
    pub round: bool,
    /// Gap over the size \[–\].
    pub gap: f64,
    /// How it moves, if it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<Drift>,
    /// What happens along its surface.
    #[serde(default)]
    pub rubs: Rubs,
}

/// How an obstacle moves: a rotation, and a translation after it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Drift {
    /// Over the size \[–\].
    pub by: [f64; 3],
    /// About z through its highest point \[rad\].
    pub turn: f64,
}

/// What happens along the surface of an obstacle.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rubs {
    /// Nodes slide.
    #[default]
    Free,
    /// Nodes that touch do not slide.
    Sticks,
    /// Coulomb's law with this coefficient \[–\].
    Coulomb(f64),
}
