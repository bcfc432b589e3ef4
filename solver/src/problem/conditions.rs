//! Prescribed displacements.

use crate::algebra::tensor::Vector3;
use crate::geometry::{Extent, Field, Selector};
use crate::problem::amplitude::Amplitude;

/// A prescribed displacement on a selection of nodes.
#[derive(Debug, Clone)]
pub struct EssentialCondition {
    /// Name in reports and messages.
    pub name: String,
    /// Whether it acts on boundary nodes only.
    pub extent: Extent,
    /// Which of those nodes it acts on.
    pub part: Selector,
    /// The displacement at amplitude 1.
    pub prescribed: Prescribed,
    /// The factor over time.
    pub amplitude: Amplitude,
    /// Enforced while t < `release` \[s\]; for ever if `None`.
    pub release: Option<f64>,
}

impl EssentialCondition {
    /// All components of a displacement \[m\] on the nodes of the boundary that `part`
    /// selects, for ever.
    pub fn on_surface(
        name: &str,
        part: Selector,
        displacement: Vector3,
        amplitude: Amplitude,
    ) -> EssentialCondition {
        EssentialCondition {
            name: name.to_string(),
            extent: Extent::Surface,
            part,
            prescribed: Prescribed::Displacement([0, 1, 2].map(|k| Some(displacement[k]))),
            amplitude,
            release: None,
        }
    }

    /// Whether it says anything about a component.
    pub fn prescribes(&self, component: usize) -> bool {
        match self.prescribed {
            Prescribed::Displacement(values) => values[component].is_some(),
            Prescribed::Rotation { .. } | Prescribed::Field(_) => true,
        }
    }
}

/// What is prescribed at amplitude 1.
#[derive(Debug, Clone)]
pub enum Prescribed {
    /// A displacement \[m\] per component; `None` leaves a component free.
    Displacement([Option<f64>; 3]),
    /// u = (R(amplitude · angle) − I)(X − point).
    Rotation {
        /// A point on the axis \[m\].
        point: Vector3,
        /// Unit vector along the axis.
        axis: Vector3,
        /// \[rad\]
        angle: f64,
    },
    /// All components of a displacement field \[m\], at the nodes' own positions.
    Field(Field),
}
