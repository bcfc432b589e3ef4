//! Fuzzing of every file that mtled reads, on stable Rust: inputs are mutated
//! ([`mutate`]) from valid ones ([`seeds`]) and given to child processes ([`child`])
//! that are limited in time and memory, in a folder with sentinels around it
//! ([`sandbox`]). What must never happen is a finding ([`judge`]).
#![cfg(unix)]

// A module uses only modules above it.
pub mod finding;
pub mod target;

pub mod dictionary;
pub mod mutate;

pub mod seeds;

pub mod child;

pub mod judge;
pub mod process;
pub mod sandbox;

pub mod worker;

pub mod station;

pub mod corpus;
pub mod minimise;
pub mod tally;

pub mod campaign;
