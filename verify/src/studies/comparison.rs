//! The meshless solver at the recipes of the cases against the references.

use super::Workbench;
use super::comparison_limits::{Limits, WANTED, limits};
use super::comparison_tables::{brain_table, cost_figure, differences_table};
use crate::cases::CASES;
use crate::reference::agreement::rms_of_points;
use crate::reference::{Agreed, Family, Quantity, ReferenceFile, agree, is_dynamic, quantities};
use crate::run::{Record, Sample, Solved, solve_case};
use crate::scene::{Case, ProbeKind};
use crate::study::{Bound, Check, Figure, Kind, Study};
use anyhow::{Context, Result, anyhow, bail};
use cpu_time::ThreadTime;
use mtled::tensor::Vector3;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Samples of a dynamic run; values between them are interpolated linearly.
const SAMPLES: usize = 1000;

/// What is smaller than this share of its kind counts as zero \[–\].
const ZERO: f64 = 1e-6;

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

/// A difference from the reference, relative to the largest number of its kind
/// in the case \[–\].
#[derive(Debug, Clone, Copy)]
pub struct Difference {
    /// Over points and instants.
    pub rms: f64,
    pub max: f64,
    /// The reference's own error, rms.
    pub bar: f64,
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
    let computed = quantities(&case)
        .iter()
        .map(|quantity| series(&case, &record, quantity, &file.times_s))
        .collect::<Result<_>>()?;
    Ok(Compared { case, file, solved, cpu, references, computed })
}

/// The numbers of a quantity at `times` \[s\], instant by instant.
fn series(case: &Case, record: &Record, quantity: &Quantity, times: &[f64]) -> Result<Vec<f64>> {
    if !quantity.changes {
        return numbers(case, record, quantity, record.samples.last().context("no sample")?);
    }
    let mut all = Vec::new();
    for time in times {
        let (before, after, share) = around(case, record, *time)?;
        let before = numbers(case, record, quantity, before)?;
        let after = numbers(case, record, quantity, after)?;
        all.extend(before.iter().zip(&after).map(|(a, b)| a + share * (b - a)));
    }
    Ok(all)
}

/// The samples around a time and where it lies between them; a static case has
/// its last sample only.
fn around<'a>(case: &Case, record: &'a Record, time: f64) -> Result<(&'a Sample, &'a Sample, f64)> {
    let last = record.samples.last().context("nothing was recorded")?;
    if !is_dynamic(case) {
        return Ok((last, last, 0.0));
    }
    let index = record.samples.partition_point(|sample| sample.time < time);
    let after = record.samples.get(index).unwrap_or(last);
    let before = &record.samples[index.saturating_sub(1)];
    let length = after.time - before.time;
    let share = if length > 0.0 { ((time - before.time) / length).clamp(0.0, 1.0) } else { 0.0 };
    Ok((before, after, share))
}

/// The numbers of a quantity in one sample.
fn numbers(case: &Case, record: &Record, quantity: &Quantity, sample: &Sample) -> Result<Vec<f64>> {
    let name = quantity.name.split_once('/').map_or("", |(_, name)| name);
    let probe = || case.probes.iter().position(|probe| probe.name == name);
    let condition = || case.problem.conditions.iter().position(|c| c.name == name);
    let flat = |vectors: &[Vector3]| vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect();
    let found = match quantity.family {
        Family::Displacement => probe().map(|index| flat(&sample.displacements[index])),
        Family::Centre => probe().map(|index| flat(&record.references[index])),
        Family::Force => condition().map(|index| flat(&[sample.reactions[index].force])),
        Family::Moment => condition().map(|index| flat(&[sample.reactions[index].moment])),
        Family::StrainEnergy => Some(vec![sample.energies.strain]),
        Family::KineticEnergy => Some(vec![sample.energies.kinetic]),
    };
    found.ok_or_else(|| anyhow!("nothing was recorded of {}", quantity.name))
}

impl Compared {
    /// The difference over all quantities of a family for which `wanted` holds;
    /// none where there are none or all vanish, as moments do by symmetry.
    pub fn difference(
        &self,
        family: Family,
        wanted: impl Fn(&Quantity) -> bool,
    ) -> Option<Difference> {
        let components = family.components();
        let (mut apart, mut errors) = (Vec::new(), Vec::new());
        let (mut largest, mut max, mut zero) = (0.0f64, 0.0f64, 0.0f64);
        for (reference, computed) in self.references.iter().zip(&self.computed) {
            if reference.quantity.family != family || !wanted(&reference.quantity) {
                continue;
            }
            let length = |vector: &[f64]| vector.iter().map(|v| v * v).sum::<f64>().sqrt();
            let differences: Vec<f64> =
                computed.iter().zip(&reference.values).map(|(a, b)| a - b).collect();
            zero = zero.max(ZERO * reference.scale);
            largest = reference.values.chunks(components).map(length).fold(largest, f64::max);
            max = differences.chunks(components).map(length).fold(max, f64::max);
            errors.extend(std::iter::repeat_n(reference.error, differences.len() / components));
            apart.extend(differences);
        }
        (largest > zero).then(|| Difference {
            rms: rms_of_points(&apart, components) / largest,
            max: max / largest,
            bar: rms_of_points(&errors, 1) / largest,
        })
    }

    fn is_centre(&self, quantity: &Quantity) -> bool {
        self.case.probes.iter().any(|probe| {
            quantity.name.strip_prefix("displacement/") == Some(probe.name.as_str())
                && matches!(probe.kind, ProbeKind::CentreOfMass { .. })
        })
    }

    /// Of points and lattices.
    pub fn displacement(&self) -> Option<Difference> {
        self.difference(Family::Displacement, |quantity| !self.is_centre(quantity))
    }

    /// Of centres of mass.
    pub fn centre(&self) -> Option<Difference> {
        self.difference(Family::Displacement, |quantity| self.is_centre(quantity))
    }

    /// Of a family as a whole.
    pub fn of(&self, family: Family) -> Option<Difference> {
        self.difference(family, |_| true)
    }
}

fn check(study: &mut Study, compared: &Compared) -> Result<()> {
    let name = &compared.case.name;
    let Limits { why, rows } = limits(name).with_context(|| format!("{name} has no limits"))?;
    for (what, limit) in rows {
        let (words, difference) = match *what {
            "displacement" => ("displacement of the probes, rms", compared.displacement()),
            "centre_of_mass" => ("centre of mass, rms", compared.centre()),
            "force" => ("reaction, rms", compared.of(Family::Force)),
            "moment" => ("reaction moment, rms", compared.of(Family::Moment)),
            "strain_energy" => ("strain energy, rms", compared.of(Family::StrainEnergy)),
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
