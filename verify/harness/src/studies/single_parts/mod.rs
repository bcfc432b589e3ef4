//! Laws, masses, loads, single steps and the detection of divergence, each by itself: what theory
//! claims of them without the solution of a boundary value problem.

mod laws;
mod model;
mod motion;

use crate::studies::workbench::Workbench;
use anyhow::Result;
use mtled_checks::study::Study;

/// Checks of every part.
pub(crate) fn parts(bench: &Workbench, study: &mut Study) -> Result<()> {
    laws::laws(bench, study)?;
    model::masses(bench, study)?;
    model::amplitude(study);
    motion::threads(bench, study)?;
    motion::components(bench, study)?;
    motion::contact(bench, study)?;
    motion::damping(bench, study)?;
    model::thickness(bench, study)?;
    model::not_a_number(bench, study)
}
