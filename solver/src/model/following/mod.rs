//! Loads that depend on displacements: pressures, springs, and what fills cavities.

mod cavity;
mod loads;
mod part;
mod pressed_surface;
mod pressure;
mod spring;
mod tangent;

pub use cavity::{CavityLoad, CavityState, OwnFluid};
pub use loads::FollowingLoads;
pub use part::Following;
pub use pressure::PressureLoad;
pub use spring::SpringLoad;
pub(crate) use spring::directions;
pub use tangent::FollowingTangent;
