//! Verification harness of the meshless solver `mtled`: studies produce plain
//! data ([`study`]), and [`report`] turns it into pages and files.

pub mod exact;
pub mod measure;
pub mod report;
pub mod study;
