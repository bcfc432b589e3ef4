//! Verification harness of the meshless solver `mtled`: case files
//! ([`scene`]) become problems, runs ([`run`]) become results, studies
//! ([`studies`], [`lab`], [`contests`], [`suite`], [`frequencies`], [`sensitivity`], [`unloaded`]) become the plain data of [`mtled_checks::study`],
//! and [`mtled_checks::report`] turns those into pages and files.

// A module uses only modules above it.
pub mod exact;
pub mod files;
pub mod machine;

pub mod scene;

pub mod reference;

pub mod protocol;

pub mod bundled;
pub mod display;
pub mod picture;
pub mod run;

pub mod frequencies;
pub mod warp;

pub mod accuracy;
pub mod specimens;
pub mod studies;

pub mod lab;

pub mod contests;
pub mod suite;

pub mod sensitivity;
pub mod unloaded;

pub mod cli;
