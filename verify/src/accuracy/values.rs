//! The numbers of a run that a truth can be compared with.

use crate::reference::{Family, Quantity, is_dynamic, quantities};
use crate::run::{Record, Sample};
use crate::scene::Case;
use anyhow::{Context, Result, anyhow};
use mtled::algebra::tensor::Vector3;

/// Samples of a dynamic run; values between them are interpolated linearly.
pub const SAMPLES: usize = 1000;

/// All quantities of a case at `times` \[s\], each instant by instant.
pub fn values(case: &Case, record: &Record, times: &[f64]) -> Result<Vec<Vec<f64>>> {
    let of = |quantity: &Quantity| series(case, record, quantity, times);
    quantities(case).iter().map(of).collect()
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
