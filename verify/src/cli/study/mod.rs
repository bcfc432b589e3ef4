//! `mtled study`.

use super::common::Common;
use super::lab::sweep::{SweepArgs, sweep};
use anyhow::Result;
use clap::Subcommand;
use mtled_lab::lab::sweep::Subject;

#[derive(Debug, Subcommand)]
pub(crate) enum StudyCommand {
    /// Errors of the discrete divergence theorem and the quadrature, and the conditioning of
    /// the supports, over recipes.
    Consistency(SweepArgs),
    /// The affine patch test on the body of the case: errors over recipes.
    Patch(SweepArgs),
    /// The critical time step by the per-point bound, by Lanczos and by bisection of trial
    /// runs, over recipes, at rest and compressed.
    Timestep(SweepArgs),
    /// Errors over spacings against a reference or finer runs, with orders and their scatter
    /// over node clouds.
    Convergence(SweepArgs),
    /// Which recipes and loads end without warnings, and how the others end.
    Stability(SweepArgs),
}

pub(crate) fn study(command: &StudyCommand, common: &Common) -> Result<u8> {
    match command {
        StudyCommand::Consistency(arguments) => sweep(Subject::Consistency, arguments, common),
        StudyCommand::Patch(arguments) => sweep(Subject::Patch, arguments, common),
        StudyCommand::Timestep(arguments) => sweep(Subject::TimeStep, arguments, common),
        StudyCommand::Convergence(arguments) => sweep(Subject::Convergence, arguments, common),
        StudyCommand::Stability(arguments) => sweep(Subject::Stability, arguments, common),
    }
}
