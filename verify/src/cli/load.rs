//! Options about cases, and errors in running one.

use clap::Args;
use mtled::error::Error;
use mtled_case::scene::{Case, Override, one_error};
use mtled_run::run;

/// Values in place of those of a case file.
#[derive(Debug, Args)]
pub(crate) struct SetArgs {
    /// Use another value in place of that of the case file, as if the file had it; may be
    /// repeated. Keys are written as in messages, such as material.tissue.young_modulus,
    /// prescribe.top.displacement.z or prescribe[0].release, values as in TOML, words without
    /// quotation marks; a whole table is replaced by another, as in 'time={ method = "dynamic",
    /// end = 2 }'.
    #[arg(long = "set", value_name = "KEY=VALUE", help_heading = "Case")]
    pub overrides: Vec<Override>,
}

/// An error of the solver as the mistake in the case file that causes it.
pub(crate) fn located(case: &Case, error: &Error) -> anyhow::Error {
    one_error(vec![run::located(case, error)])
}
