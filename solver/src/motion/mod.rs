//! Runs: time steps, dynamic relaxation and Newton's method.

pub mod balance;
pub mod critical_time_step;
pub mod energy;
pub mod extra_stress;
pub mod mass_scaling;
pub mod newton;
pub mod nodal_fields;
pub mod observe;
pub mod relaxation;
pub mod simulate;
pub(crate) mod stability;
pub mod state;
pub mod step;
pub mod step_control;
pub mod strain;
pub mod summary;
pub mod tangent;
