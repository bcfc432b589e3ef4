//! Smaller inputs with the same finding.

use crate::mutate::{Input, smaller_scenes};
use crate::station::Station;
use crate::target::Target;
use anyhow::Result;
use std::time::{Duration, Instant};

/// Time for one input.
const MOST_TIME: Duration = Duration::from_secs(8);

/// Cuts out parts, large ones first, while a finding of this signature stays.
pub(crate) fn minimised(
    station: &mut Station,
    target: Target,
    input: &Input,
    signature: &str,
) -> Result<Input> {
    let start = Instant::now();
    let mut best = input.clone();
    let mut part = best.bytes.len().div_ceil(2);
    while part > 0 {
        let mut at = 0;
        while at < best.bytes.len() {
            if start.elapsed() > MOST_TIME {
                return Ok(best);
            }
            let mut smaller = best.clone();
            smaller.bytes.drain(at..(at + part).min(best.bytes.len()));
            let trial = station.try_input(target, &smaller)?;
            if trial.findings.iter().any(|finding| finding.signature() == signature) {
                best = smaller
            } else {
                at += part
            }
        }
        part /= 2;
    }
    Ok(best)
}

/// Time for a scene, each of which takes a second \[s\].
const MOST_TIME_OF_SCENE: Duration = Duration::from_secs(60);

/// Leaves out one thing of a scene after another while a finding of this signature stays.
pub(crate) fn smallest_scene(
    station: &mut Station,
    input: &Input,
    signature: &str,
) -> Result<Input> {
    let start = Instant::now();
    let mut best = input.clone();
    'smaller: loop {
        for next in smaller_scenes(&best) {
            if start.elapsed() > MOST_TIME_OF_SCENE {
                return Ok(best);
            }
            let trial = station.try_input(Target::Scene, &next)?;
            if trial.findings.iter().any(|finding| finding.signature() == signature) {
                best = next;
                continue 'smaller;
            }
        }
        return Ok(best);
    }
}
