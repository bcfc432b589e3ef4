//! The cheapest recipe with at most a given error, or the most accurate one within a
//! given CPU time: many recipes on coarse clouds, the best of them on finer and more
//! clouds, the winner confirmed on clouds that the search has not used.

mod design;
mod effects;
mod recommend;
mod recommend_report;
mod report;
mod score;
mod search;
mod trial;
mod truth;

pub use recommend::recommend;
pub use recommend_report::recommendation_study;
pub use report::{tune_study, tune_text};
pub use search::{Tuned, tune};
pub use trial::{Goal, TuneRequest};
