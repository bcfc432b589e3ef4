//! Whether the reference solution can decide a search, before that is begun.

use super::trial::{Goal, TuneRequest};
use crate::lab::label::percent;
use crate::lab::store::{RunRecord, TaskRunner};
use crate::lab::sweep::{REFINEMENT, ReferenceSource, find_reference};
use anyhow::{Result, bail};
use mtled_checks::report::four_digits;
use mtled_run::accuracy::{Group, ReferenceSolution};

/// Error of a reference that leaves room for the search, over the goal \[–\].
const ROOM: f64 = 0.5;
/// Power of the number of nodes with which the time of a run grows \[–\].
const GROWTH: f64 = 1.2;
/// Largest refinement of the reference \[–\].
const FINEST: f64 = 8.0;

/// The reference solution of a search.
pub(crate) struct Truth {
    pub reference: ReferenceSolution,
    pub group: Group,
    /// Why it cannot decide whether a recipe meets the goal, and what could.
    pub undecided: Option<String>,
}

/// Finds the reference solution; where its own error is as large as the goal, a finer one is made
/// if that is expected to stay within the CPU time that is allowed for it.
pub(crate) fn truth(request: &TuneRequest, tasks: &TaskRunner) -> Result<Truth> {
    let source = &request.source;
    let mut from = request.reference.clone();
    loop {
        let (reference, group) = reference(request, &from, tasks)?;
        let bar = reference.bar(&source.case, group);
        let Goal::Error(target) = request.goal else {
            return Ok(Truth { reference, group, undecided: None });
        };
        let disagreement = reference.disagreements(&source.case, group).first().map(|text| {
            format!(
                "{text}: errors against it decide nothing; make a better one, or use finer runs \
                     (--reference own)"
            )
        });
        if disagreement.is_some() || bar < target {
            return Ok(Truth { reference, group, undecided: disagreement });
        }
        let runs = tasks.records(&from.tasks(source, &[]))?;
        let mut why = format!(
            "the error of the reference itself, {}, is not below the goal of {}",
            percent(bar),
            percent(target)
        );
        if runs.is_empty() {
            why += ": a better reference is needed (--reference FILE), or finer runs (--reference own)";
            return Ok(Truth { reference, group, undecided: Some(why) });
        }
        let now = if let ReferenceSource::Own(refinement) = from { refinement } else { REFINEMENT };
        // The error bar of own runs assumes the first order.
        let finer = now * bar / (ROOM * target);
        let cpu_s = cost(request, &runs, finer / now);
        if finer <= FINEST && cpu_s <= request.truth_budget_s {
            from = ReferenceSource::Own(finer);
            continue;
        }
        why += &if finer <= FINEST {
            format!(
                ": finer runs, with a spacing {} times smaller than that of the case, would decide \
                 it in about {} s of CPU time (--truth-budget {:.0}s)",
                four_digits(finer),
                four_digits(cpu_s),
                (1.2 * cpu_s).ceil()
            )
        } else {
            ": runs fine enough to decide it are out of reach; take a larger goal, or a \
                      reference of another code (--reference FILE)"
                .to_string()
        };
        return Ok(Truth { reference, group, undecided: Some(why) });
    }
}

/// A reference solution, and the quantities whose error is measured.
pub(crate) fn reference(
    request: &TuneRequest,
    from: &ReferenceSource,
    tasks: &TaskRunner,
) -> Result<(ReferenceSolution, Group)> {
    let source = &request.source;
    let reference = find_reference(from, source, &[], tasks)?;
    let Some(group) = request.group.or_else(|| reference.group(&source.case)) else {
        bail!("{}: has no probe and no support whose error can be measured", source.name);
    };
    Ok((reference, group))
}

/// Expected CPU time of reference runs with spacings smaller by `factor` \[s\].
fn cost(request: &TuneRequest, runs: &[RunRecord], factor: f64) -> f64 {
    let components = request.source.case.problem.dimension.components() as f64;
    runs.iter().map(RunRecord::cpu_s).sum::<f64>() * factor.powf(GROWTH * components)
}
