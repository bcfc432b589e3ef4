//! The studies of `mtled verify` ([`studies`]) and the exact solutions that they compare with
//! ([`exact`]). They become the plain data of [`mtled_checks::study`]. Nothing here knows the laboratory.

// A module uses only modules above it.
pub mod exact;

pub mod manufactured;

pub mod studies;
