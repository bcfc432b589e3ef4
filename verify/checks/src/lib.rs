//! Claims, checks with bounds, bands around figures, a committed baseline, and pages
//! that show all of it. Nothing in here knows any mechanics.

pub mod measure;
pub mod study;

pub mod gate;
pub mod report;
