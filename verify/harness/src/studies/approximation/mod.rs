//! Studies of the shape functions.

pub mod consistency;
