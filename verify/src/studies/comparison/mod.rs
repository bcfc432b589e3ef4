//! The meshless solver at the recipes of the cases against the references.

pub mod benchmarks;
pub mod convergence;
mod limits;
mod tables;

use crate::accuracy::{Difference, Group, SAMPLES, difference, values};
use crate::bundled::CASES;
use crate::reference::{Agreed, ReferenceFile, agree, is_dynamic};
use crate::run::{Solved, solve_case};
use crate::scene::Case;
use crate::studies::comparison::limits::{Limits, WANTED, limits};
use crate::studies::comparison::tables::{brain_table, cost_figure, differences_table};
use crate::studies::workbench::Workbench;
use anyhow::{Context, Result, bail};
use cpu_time::ThreadTime;
use mtled_checks::study::{Bound, Check, Figure, Kind, Study};
use std::sync::atomic::{AtomicUsize, Ordering};

/// One case, computed and referred to.
pub struct Compared {
    pub case: Case,
    pub file: ReferenceFile,
    pub solved: Solved,
    /// CPU time of one thread, set-up included \[s\].
    pub cpu: f64,
    pub references: Vec<Agreed>,
    /// Computed numbers at the instants of the reference, like its values.
    pub computed: Vec<Vec<f64>>,
}

pub fn comparison(bench: &Workbench, study: &mut Study) -> Result<()> {
    let mut compared = Vec::new();
    let mut failures = Vec::new();
    for result in compare_all(bench) {
        match result {
            Ok(case) => compared.push(case),
            Err(error) => failures.push(format!("{error:#}")),
        }
    }
    study.tables.push(differences_table(&compared));
    if let Some(brain) = compared.iter().find(|c| c.case.name == "brain_slice") {
        study.tables.push(brain_table(brain));
    }
    study.figures.push(Figure::Plot(cost_figure(&compared)));
    study.notes.push(
        "A case is solved once, at the recipe of its file. Differences are relative to the \
         largest number of their kind in the reference; a bound is the limit that is wanted plus the \
         reference's own error bar. Where a limit is above 2 % the check is a regression: it \
         shows change, not truth."
            .into(),
    );
    study.notes.push(
        "Brain slice: what the error bars do not hold is the outline. Voxel marks of about 0.1 mm on \
         it steer how the brain slides along the skull and turns after the release; smoothing them \
         more or less moves the finite-element centres by 0.03 mm at 1 s and 0.05 mm at 2 s, of a \
         displacement of 2 to 6 mm. A centre that is more than 2 % off in the table is off by little \
         more than that. The penalty of the contact moves centres by 0.012 mm, half the step by \
         0.005 mm."
            .into(),
    );
    for case in &compared {
        check(study, case)?;
    }
    if !failures.is_empty() {
        bail!("{}", failures.join("; "));
    }
    Ok(())
}

/// Solves all cases, each on one thread so that its CPU time can be told, and
/// as many at a time as there are threads.
fn compare_all(bench: &Workbench) -> Vec<Result<Compared>> {
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
    let mut case = bench.case(name)?;
    let file = bench.reference(&case)?;
    if is_dynamic(&case) {
        case.outputs.history = case.outputs.history.max(SAMPLES);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let (result, cpu) = pool.install(|| {
        let start = ThreadTime::now();
        (solve_case(&case), start.elapsed().as_secs_f64())
    });
    let (solved, record) = result?;
    let references: Vec<Agreed> = agree(&case, &file).iter().map(|a| a.reference()).collect();
    let computed = values(&case, &record, &file.times_s)?;
    Ok(Compared { case, file, solved, cpu, references, computed })
}

impl Compared {
    /// Of points and lattices.
    pub fn displacement(&self) -> Option<Difference> {
        self.of(Group::Displacement)
    }

    /// Of centres of mass.
    pub fn centre(&self) -> Option<Difference> {
        self.of(Group::CentreOfMass)
    }

    /// Of a group as a whole.
    pub fn of(&self, group: Group) -> Option<Difference> {
        difference(&self.case, group, &self.references, &self.computed)
    }
}

fn check(study: &mut Study, compared: &Compared) -> Result<()> {
    let name = &compared.case.name;
    let Limits { why, rows } = limits(name).with_context(|| format!("{name} has no limits"))?;
    for (what, limit) in rows {
        let (words, difference) = match *what {
            "displacement" => ("displacement of the probes, rms", compared.displacement()),
            "centre_of_mass" => ("centre of mass, rms", compared.centre()),
            "force" => ("reaction, rms", compared.of(Group::Force)),
            "moment" => ("reaction moment, rms", compared.of(Group::Moment)),
            "strain_energy" => ("strain energy, rms", compared.of(Group::StrainEnergy)),
            other => bail!("{other} is not compared"),
        };
        let difference = difference.with_context(|| format!("{name} has no {what}"))?;
        let (kind, source) = match *limit > WANTED {
            true => (Kind::Regression, why),
            false => (Kind::Reference, "2 % of the largest value"),
        };
        let mut check = Check::new(
            &format!("comparison/{name}/{what}"),
            &format!("{}: {words}, relative difference", compared.case.title),
            kind,
            difference.rms,
            Bound::AtMost(limit + difference.bar),
            "1",
            &format!("{source}: {limit}, and {:.1e} of the reference itself", difference.bar),
        );
        check.reference_error = Some(difference.bar);
        study.checks.push(check);
    }
    Ok(())
}
