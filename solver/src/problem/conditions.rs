//! What acts on the body: prescribed displacements and loads.

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

/// Every load, and the velocity at the start.
#[derive(Debug, Clone, Default)]
pub struct Loads {
    /// Forces per mass; they add up.
    pub body_forces: Vec<BodyForce>,
    /// Forces per reference area; they add up.
    pub tractions: Vec<Traction>,
    /// Pressures on the deformed surface; they add up.
    pub pressures: Vec<Pressure>,
    /// Velocity at t = 0 \[m/s\], the first part that contains a node, at whose parameters it is set.
    pub initial_velocities: Vec<(Selector, Field)>,
}

/// A force per mass \[N/kg\] on the body or a part of it, such as what lies above a fluid.
#[derive(Debug, Clone)]
pub struct BodyForce {
    /// The quadrature points that it acts on.
    pub part: Selector,
    /// At amplitude 1 \[N/kg\].
    pub acceleration: Field,
    /// The factor over time.
    pub amplitude: Amplitude,
}

/// A dead traction: force per reference area \[Pa\], whose direction stays as it is.
#[derive(Debug, Clone)]
pub struct Traction {
    /// Name in reports and messages.
    pub name: String,
    /// Which part of the boundary.
    pub part: Selector,
    /// At amplitude 1 \[Pa\].
    pub traction: Field,
    /// The factor over time.
    pub amplitude: Amplitude,
}

/// A pressure \[Pa\] along the inward normal of the deformed surface: it turns with the
/// surface, and its force goes with the deformed area.
#[derive(Debug, Clone)]
pub struct Pressure {
    /// Name in reports and messages.
    pub name: String,
    /// Which part of the boundary.
    pub part: Selector,
    /// At amplitude 1 \[Pa\]; positive where it presses on the body.
    pub pressure: f64,
    /// The factor over time.
    pub amplitude: Amplitude,
}
