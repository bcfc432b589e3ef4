//! Values of a run in the layout of a reference solution.

use crate::run::{Recording, Sample, numbers};
use anyhow::{Context, Result};
use mtled_case::reference::{Quantity, is_dynamic, quantities};
use mtled_case::scene::Case;

/// Samples of a dynamic run; values between them are interpolated linearly.
pub const SAMPLES: usize = 1000;

/// All quantities of a case at `times` \[s\], each instant by instant.
pub fn values(case: &Case, recording: &Recording, times: &[f64]) -> Result<Vec<Vec<f64>>> {
    let of = |quantity: &Quantity| series(case, recording, quantity, times);
    quantities(case).iter().map(of).collect()
}

/// The numbers of a quantity at `times` \[s\], instant by instant.
fn series(
    case: &Case,
    recording: &Recording,
    quantity: &Quantity,
    times: &[f64],
) -> Result<Vec<f64>> {
    let recorded = |sample: &Sample| {
        numbers(case, recording, quantity, sample)
            .with_context(|| format!("nothing was recorded of {}", quantity.name))
    };
    if !quantity.changes {
        return recorded(recording.samples.last().context("no sample")?);
    }
    let mut all = Vec::new();
    for time in times {
        let (before, after, fraction) = around(case, recording, *time)?;
        let (before, after) = (recorded(before)?, recorded(after)?);
        all.extend(before.iter().zip(&after).map(|(a, b)| a + fraction * (b - a)));
    }
    Ok(all)
}

/// The samples around a time and where it lies between them; a static case has
/// its last sample only.
fn around<'a>(
    case: &Case,
    recording: &'a Recording,
    time: f64,
) -> Result<(&'a Sample, &'a Sample, f64)> {
    let last = recording.samples.last().context("nothing was recorded")?;
    if !is_dynamic(case) {
        return Ok((last, last, 0.0));
    }
    let index = recording.samples.partition_point(|sample| sample.time < time);
    let after = recording.samples.get(index).unwrap_or(last);
    let before = &recording.samples[index.saturating_sub(1)];
    let length = after.time - before.time;
    let fraction = if length > 0.0 { ((time - before.time) / length).clamp(0.0, 1.0) } else { 0.0 };
    Ok((before, after, fraction))
}
