//! Runs of the published problems.

use crate::run::{Recording, error_bars, solve_case};
use crate::scene::Case;
use cpu_time::ThreadTime;
use mtled::problem::Motion;
use mtled_checks::report::four_digits;
use std::collections::BTreeMap;

/// A run that is to be done.
pub struct Plan {
    pub problem: String,
    pub case: Case,
    pub spacing: f64,
    pub is_own: bool,
}

/// A run that was done.
pub struct Solved {
    pub problem: String,
    pub case: Case,
    pub spacing: f64,
    pub is_own: bool,
    pub nodes: usize,
    /// CPU time of set-up and solution \[s\].
    pub cpu: f64,
    /// Samples, or why there are none.
    pub record: Result<Recording, String>,
    /// Reasons to doubt it.
    pub doubts: Vec<String>,
    /// Our own error bars by quantity, in words where there is none.
    pub bars: BTreeMap<String, String>,
}

impl Solved {
    pub fn remark(&self) -> String {
        match &self.record {
            Err(reason) => format!("no answer: {reason}"),
            Ok(_) => self.doubts.join("; "),
        }
    }
}

/// Solves a case on one thread, whose time is measured.
pub fn solved(plan: Plan, with_bars: bool) -> Solved {
    let Plan { problem, case, spacing, is_own } = plan;
    let start = ThreadTime::now();
    let run = solve_case(&case);
    let cpu = start.elapsed().as_secs_f64();
    let mut bars = BTreeMap::new();
    let (nodes, record, doubts) = match run {
        Err(error) => (0, Err(error.to_string()), Vec::new()),
        Ok((solved, record)) => {
            if with_bars && is_own && matches!(case.problem.motion, Motion::Static { .. }) {
                let estimated = error_bars(&case, &solved, &record, false);
                if let Ok(estimated) = estimated {
                    for bar in &estimated.bars {
                        let text =
                            bar.size.as_ref().map_or_else(|_| "none".into(), |b| bar_text(*b));
                        bars.insert(bar.quantity.name.clone(), text);
                    }
                }
            }
            let nodes = solved.prepared.discretisation.cloud.positions.len();
            (nodes, Ok(record), solved.doubts())
        }
    };
    Solved { problem, case, spacing, is_own, nodes, cpu, record, doubts, bars }
}

/// A bar as text.
fn bar_text(bar: f64) -> String {
    format!("± {}", four_digits(bar))
}
