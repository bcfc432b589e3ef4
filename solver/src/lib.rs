//! Meshless Total Lagrangian Explicit Dynamics (MTLED) for soft tissue.
//!
//! One way through the crate: a [`Problem`](problem::Problem) states what is
//! to be solved, a [`Discretisation`](discretisation::Discretisation) holds
//! nodes, quadrature points and Grad φ, a [`Model`](model::Model) everything
//! that stays constant, a [`State`](state::State) what evolves, and
//! [`simulate`](simulate::simulate) marches it while an
//! [`Observer`](observe::Observer) watches.
//!
//! Everything is total Lagrangian: `X` is a reference position, `Grad` means
//! ∂/∂X, and `grad_phi` is Grad φ. Units are SI throughout.

pub mod tensor;

pub mod material;

pub mod geometry;
pub mod selection;

pub mod nodes;
pub mod problem;
