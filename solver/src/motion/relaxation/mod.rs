//! Dynamic relaxation: its loop, its damping, and the stability of what it finds.

mod damping;
mod relax;
mod stability;

pub(crate) use relax::relax;
