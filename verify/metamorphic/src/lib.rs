//! Random scenes and relations that must hold of any scene: who asks for the same in other
//! words must get the same answer. No relation needs a known solution, and none is about one
//! particular body.
//!
//! A [`scene::Scene`] is plain data, drawn at random, written to a file and made smaller;
//! [`build`] makes it a problem, [`relation`] compares the answers, [`hunt`] goes through all
//! of it and looks for the smallest scene that shows a fault.
#![deny(missing_docs)]

// A module uses only modules above it.
pub mod scene;

pub mod build;

pub mod answer;

pub mod relation;

pub mod known;

pub mod hunt;
