//! A vector as a function of the reference position.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::field::scattered::Scattered;
use std::fmt;
use std::sync::Arc;

/// A vector field over the reference configuration, in the unit that its
/// context states. It is evaluated when a model is built, never in a step.
#[derive(Clone)]
pub enum Field {
    /// The same everywhere.
    Uniform(Vector3),
    /// A function of the reference position \[m\].
    Function(Arc<dyn Fn(&Vector3) -> Vector3 + Send + Sync>),
    /// Through data at scattered points.
    Scattered(Arc<Scattered>),
}

impl Field {
    /// From a function of the reference position \[m\].
    pub fn of(function: impl Fn(&Vector3) -> Vector3 + Send + Sync + 'static) -> Field {
        Field::Function(Arc::new(function))
    }

    /// The vector at the reference position `X` \[m\].
    pub fn at(&self, X: &Vector3) -> Vector3 {
        match self {
            Field::Uniform(value) => *value,
            Field::Function(function) => function(X),
            Field::Scattered(data) => data.at(X),
        }
    }
}

impl From<Vector3> for Field {
    fn from(value: Vector3) -> Field {
        Field::Uniform(value)
    }
}

impl fmt::Debug for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Field::Uniform(value) => f.debug_tuple("Uniform").field(value).finish(),
            Field::Function(_) => f.write_str("Function"),
            Field::Scattered(_) => f.write_str("Scattered"),
        }
    }
}
