//! Dynamic relaxation: its loop and its damping.

mod damping;
mod relax;

pub(crate) use relax::relax;
