//! Closed forms and published values.

pub mod bar;
pub mod beam;
pub mod cook;
pub mod hertz;
pub mod homogeneous;
pub mod inclusion;
mod jet;
pub mod land;
pub mod manufactured;
mod published;
pub mod shell;
pub mod torsion;
pub mod turek_hron;

pub use published::Published;
