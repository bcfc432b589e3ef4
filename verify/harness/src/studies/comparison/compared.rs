//! Every bundled case solved with its own recipe, and the reference to compare it with.

use crate::studies::comparison::cut_drawings::cut_panels;
use crate::studies::workbench::Workbench;
use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use mtled_case::bundled::CASES;
use mtled_case::reference::{Mesh, ReferenceFile, ReferenceValues, agreements, is_dynamic};
use mtled_case::scene::Case;
use mtled_checks::study::Panels;
use mtled_run::accuracy::{Difference, Group, SAMPLES, difference, values};
use mtled_run::machine::on_threads;
use mtled_run::run::{Solved, solve_case};
use std::sync::atomic::{AtomicUsize, Ordering};

/// One case, its solution and its reference.
pub(crate) struct Compared {
    pub case: Case,
    pub file: ReferenceFile,
    pub solved: Solved,
    /// CPU time of one thread, set-up included \[s\].
    pub cpu: f64,
    pub references: Vec<ReferenceValues>,
    /// A cut through the body of a label map.
    pub cut: Option<Panels>,
    /// Computed values at the instants of the reference, in the order of `references`.
    pub computed: Vec<Vec<f64>>,
}

/// Solves all cases, each on one thread so that its CPU time can be measured, and as many at a
/// time as there are threads.
pub(crate) fn compare_all(bench: &Workbench) -> Vec<Result<Compared>> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some((name, _)) = CASES.get(next.fetch_add(1, Ordering::Relaxed)) {
            done.push((name, compare(bench, name).with_context(|| format!("{name} fails"))));
        }
        done
    };
    let mut results: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> =
            (0..rayon::current_num_threads()).map(|_| scope.spawn(work)).collect();
        let finished = workers.into_iter().map(|worker| worker.join());
        finished.flat_map(|done| done.unwrap_or_else(|p| std::panic::resume_unwind(p))).collect()
    });
    results.sort_by_key(|(name, _)| *name);
    results.into_iter().map(|(_, result)| result).collect()
}

fn compare(bench: &Workbench, name: &str) -> Result<Compared> {
    on_threads(1, || compare_here(bench, name))?
}

fn compare_here(bench: &Workbench, name: &str) -> Result<Compared> {
    let mut case = bench.case(name)?;
    let file = bench.reference(&case)?;
    if is_dynamic(&case) {
        case.outputs.history = case.outputs.history.max(SAMPLES);
    }
    let start = ThreadTime::now();
    let (solved, record) = solve_case(&case)?;
    let cpu = start.elapsed().as_secs_f64();
    let references: Vec<ReferenceValues> =
        agreements(&case, &file).iter().map(|a| a.reference()).collect();
    let computed = values(&case, &record, &file.times_s)?;
    let cut = cut_panels(&case, &solved)?;
    Ok(Compared { case, file, solved, cpu, references, cut, computed })
}

impl Compared {
    /// Difference of all quantities of a group from the reference.
    pub(crate) fn of(&self, group: Group) -> Option<Difference> {
        difference(&self.case, group, &self.references, &self.computed)
    }

    /// The same of a finite-element mesh.
    pub(crate) fn of_mesh(&self, group: Group, mesh: &Mesh) -> Option<Difference> {
        let values = |reference: &ReferenceValues| {
            mesh.values.get(&reference.quantity.name).map(|values| values.flat())
        };
        let values: Vec<Vec<f64>> = self.references.iter().map(values).collect::<Option<_>>()?;
        difference(&self.case, group, &self.references, &values)
    }
}
