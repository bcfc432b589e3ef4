//! Verification harness of the meshless solver `mtled`: case files
//! ([`scene`]) become problems, runs ([`run`]) become results, studies
//! ([`studies`], [`race`]) become plain data ([`study`]), and [`report`] turns those into
//! pages and files.

pub mod exact;
pub mod files;
pub mod scene;

pub mod measure;
pub mod reference;
pub mod study;

pub mod gate;
pub mod report;

pub mod cases;
pub mod machine;
pub mod run;

pub mod accuracy;
pub mod studies;

pub mod bench;
pub mod race;

pub mod store;
pub mod sweep;

pub mod budget;
pub mod tune;

pub mod cli;
