//! Runs of the published problems.

use anyhow::{Result, ensure};
use cpu_time::ThreadTime;
use mtled::frequencies::MassKind;
use mtled::problem::Motion;
use mtled_case::scene::Case;
use mtled_checks::report::four_digits;
use mtled_run::frequencies::find_modes;
use mtled_run::run::{self, Recording, error_bars, solve_case};
use std::collections::BTreeMap;

/// A run that is to be done.
pub(crate) struct Plan {
    pub problem: String,
    pub case: Case,
    pub spacing: f64,
    pub is_own: bool,
    /// Natural frequencies that are asked for; none where the case is solved.
    pub modes: usize,
}

/// What a run finds.
pub(crate) enum Found {
    History(Recording),
    /// The lowest ones of elastic vibrations, in ascending order \[Hz\].
    Frequencies(Vec<f64>),
}

/// A run that was done.
pub(crate) struct Solved {
    pub problem: String,
    pub case: Case,
    pub spacing: f64,
    pub is_own: bool,
    pub nodes: usize,
    /// CPU time of set-up and solution \[s\].
    pub cpu: f64,
    /// What it has found, or why it has found nothing.
    pub found: Result<Found, String>,
    /// Reasons to doubt it.
    pub doubts: Vec<String>,
    /// Our own error bars by quantity, in words where there is none.
    pub bars: BTreeMap<String, String>,
}

impl Solved {
    pub(crate) fn remark(&self) -> String {
        match &self.found {
            Err(reason) => format!("no answer: {reason}"),
            Ok(_) => self.doubts.join("; "),
        }
    }
}

/// Finds what the plan asks for on one thread, whose time is measured.
pub(crate) fn solved(plan: Plan, with_bars: bool) -> Solved {
    let Plan { problem, case, spacing, is_own, modes } = plan;
    let start = ThreadTime::now();
    let mut run = Solved {
        problem,
        case,
        spacing,
        is_own,
        nodes: 0,
        cpu: 0.0,
        found: Err("it was not tried".into()),
        doubts: Vec::new(),
        bars: BTreeMap::new(),
    };
    if modes > 0 {
        let found = frequencies(&mut run, modes);
        run.cpu = start.elapsed().as_secs_f64();
        run.found = found.map_err(|error| error.to_string());
        return run;
    }
    let solved = solve_case(&run.case);
    run.cpu = start.elapsed().as_secs_f64();
    run.found = match solved {
        Err(error) => Err(error.to_string()),
        Ok((solved, record)) => {
            let is_static = matches!(run.case.problem.motion, Motion::Static { .. });
            if with_bars && is_own && is_static {
                run.bars = bars(&run.case, &solved, &record);
            }
            run.nodes = solved.simulation.discretisation.cloud.positions.len();
            run.doubts = solved.doubts();
            Ok(Found::History(record))
        }
    };
    run
}

/// The lowest natural frequencies of the body of a case.
fn frequencies(run: &mut Solved, modes: usize) -> Result<Found> {
    let found = find_modes(&run.case, modes, MassKind::Consistent, &|_| ())?;
    ensure!(found.modes.converged(), "the search for natural frequencies has not converged");
    run.nodes = found.simulation.discretisation.cloud.positions.len();
    run.doubts = found.doubts;
    Ok(Found::Frequencies(found.modes.modes.iter().map(|mode| mode.frequency).collect()))
}

/// Our own error bars in words, by quantity.
fn bars(case: &Case, solved: &run::Solved, record: &Recording) -> BTreeMap<String, String> {
    let Ok(estimated) = error_bars(case, solved, record, false) else { return BTreeMap::new() };
    let text =
        |bar: &run::ErrorBar| bar.size.as_ref().map_or("none".into(), |size| bar_text(*size));
    estimated.bars.iter().map(|bar| (bar.quantity.name.clone(), text(bar))).collect()
}

/// A bar as text.
fn bar_text(bar: f64) -> String {
    format!("± {}", four_digits(bar))
}
