//! Studies of the harness itself and of single parts.

pub mod faults;
pub mod parts;
mod parts_model;
mod parts_motion;
pub mod references;
pub mod set_up;
pub mod smallest;
pub mod work;
