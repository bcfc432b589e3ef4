//! Selections as functions of the position: negative where they select.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::{Panel, Selector};

/// Value of such a function.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Level {
    /// Negative or 0 where the place is selected \[m\].
    pub value: f64,
    /// Whether the value is a bound of the distance to where that changes; otherwise only its
    /// sign says something.
    pub metric: bool,
}

impl Level {
    pub fn selects(&self) -> bool {
        self.value <= 0.0
    }

    /// Whether surely nothing changes within a reach \[m\].
    pub fn is_uniform(&self, reach: f64) -> bool {
        self.metric && self.value.abs() > reach
    }
}

/// The level of a selection at a place, on the boundary with its outward normal.
pub(crate) fn level(selector: &Selector, X: &Vector3, normal: Option<&Vector3>) -> Level {
    let known = |value: f64| Level { value, metric: true };
    match selector {
        Selector::All => known(f64::NEG_INFINITY),
        Selector::Plane { point, normal, tolerance } => {
            known((X - point).dot(normal).abs() - tolerance)
        }
        Selector::Inside { shape, tolerance } => known(shape.signed_distance(X) - tolerance),
        Selector::Label { .. } | Selector::Facing { .. } => {
            let selected = match normal {
                Some(&normal) => selector.contains_panel(&Panel::flat(*X, 0.0, normal)),
                None => selector.contains(X),
            };
            // All of a flat piece of the boundary faces the same way.
            let metric = normal.is_some() && matches!(selector, Selector::Facing { .. });
            Level { value: if selected { f64::NEG_INFINITY } else { f64::INFINITY }, metric }
        }
        Selector::Union(parts) => {
            let lower = |a: Level, b: Level| Level {
                value: a.value.min(b.value),
                metric: a.metric && b.metric,
            };
            parts.iter().map(|part| level(part, X, normal)).fold(known(f64::INFINITY), lower)
        }
        Selector::Intersection(parts) => {
            let higher = |a: Level, b: Level| Level {
                value: a.value.max(b.value),
                metric: a.metric && b.metric,
            };
            parts.iter().map(|part| level(part, X, normal)).fold(known(f64::NEG_INFINITY), higher)
        }
        Selector::Not(part) => {
            let Level { value, metric } = level(part, X, normal);
            Level { value: -value, metric }
        }
    }
}
