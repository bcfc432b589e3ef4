//! Bundled cases from their file to their result.

use super::figures::{BenchSettings, CaseRow};
use crate::machine::cpu_seconds;
use crate::run::solve_case;
use crate::scene::{Case, one_error, read_case};
use mtled_checks::measure::median;
use std::path::Path;

/// A bundled case in the folder where the cases were unpacked.
pub fn bundled_case(cases: &Path, name: &str) -> anyhow::Result<Case> {
    read_case(&cases.join(format!("{name}.toml"))).map_err(one_error)
}

/// Solves a case three times.
pub fn case_row(settings: &BenchSettings, cases: &Path, name: &str) -> anyhow::Result<CaseRow> {
    let case = bundled_case(cases, name)?;
    let mut measured = Vec::new();
    for _ in 0..3 {
        let cpu = cpu_seconds();
        let (solved, _) = settings.one.install(|| solve_case(&case))?;
        measured.push((cpu_seconds() - cpu, solved));
    }
    let middle = |value: &dyn Fn(usize) -> f64| {
        median(&(0..measured.len()).map(value).collect::<Vec<_>>()).unwrap_or(f64::NAN)
    };
    let solved = &measured[0].1;
    Ok(CaseRow {
        name: name.to_string(),
        nodes: solved.prepared.model.positions.len(),
        points: solved.prepared.discretisation.supports.len(),
        force_evaluations: solved.summary.force_evaluations,
        set_up_seconds: middle(&|i| measured[i].1.prepared.setup_seconds),
        solve_seconds: middle(&|i| measured[i].1.solve_seconds),
        cpu_seconds: middle(&|i| measured[i].0),
    })
}
