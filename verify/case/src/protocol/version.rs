//! The version that both files name.

/// Version of the protocol.
pub const PROTOCOL: u32 = 1;
