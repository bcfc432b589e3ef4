//! Verification of numerical codes: claims with checks and bounds, bands around figures, a
//! committed baseline, and reports. The crate does not know what the figures measure.
//!
//! A [study](study::Study) states a claim and judges figures by bounds; a
//! [report](study::Report) of studies is written as JSON, JUnit, HTML and Markdown
//! ([`report`]) and compared with an accepted baseline ([`gate`]).
//!
//! ```
//! use mtled_checks::measure::observed_order;
//! use mtled_checks::report::human;
//! use mtled_checks::study::{Bound, Check, Kind, Provenance, Report, Study};
//!
//! // Values of a second-order scheme for the step sizes 0.1, 0.2 and 0.4.
//! let order = observed_order([1.01, 1.04, 1.16], [0.1, 0.2, 0.4], 1e-9).unwrap();
//! let check = Check::new(
//!     "scheme/order",
//!     "observed order",
//!     Kind::Exact,
//!     order,
//!     Bound::Between(1.9, 2.1),
//!     "1",
//!     "Taylor expansion",
//! );
//! let study = Study {
//!     id: "scheme".into(),
//!     title: "Convergence of the scheme".into(),
//!     claim: "The error falls with the square of the step.".into(),
//!     checks: vec![check],
//!     ..Study::default()
//! };
//! let report = Report {
//!     schema_version: mtled_checks::report::json::SCHEMA_VERSION,
//!     suite: "quick".into(),
//!     provenance: Provenance::default(),
//!     studies: vec![study],
//!     wall_seconds: 0.1,
//!     comparison: None,
//! };
//! assert!(report.passed());
//! assert!(human::to_table(&report, false, false).ends_with("1 of 1 check passed\n"));
//! ```

#![deny(missing_docs)]

pub mod escape;
pub mod input;
pub mod measure;
pub mod temporary;

pub mod study;

pub mod gate;
pub mod report;
