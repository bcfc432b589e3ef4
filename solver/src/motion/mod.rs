//! What moves: internal forces, time steps, dynamic relaxation and Newton's method.

pub mod balance;
pub mod critical_time_step;
pub mod energy;
pub mod equilibrium;
pub mod internal_force;
mod kernel;
pub mod mass_scaling;
pub mod observe;
pub mod pace;
pub mod relaxation;
pub mod simulate;
pub mod state;
pub mod step;
pub mod tangent;
