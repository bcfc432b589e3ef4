//! Closed forms and published values.

pub(crate) mod bar;
pub(crate) mod beam;
pub(crate) mod cook;
pub(crate) mod hertz;
pub(crate) mod homogeneous;
pub(crate) mod inclusion;
mod jet;
pub(crate) mod land;
pub(crate) mod manufactured;
mod published;
pub(crate) mod torsion;
pub(crate) mod turek_hron;

pub(crate) use published::Published;
