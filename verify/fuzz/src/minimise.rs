//! Smaller inputs with the same finding.

use crate::mutate::Input;
use crate::station::Station;
use crate::target::Target;
use anyhow::Result;
use std::time::{Duration, Instant};

/// Time for one input.
const MOST_TIME: Duration = Duration::from_secs(8);

/// Cuts out parts, large ones first, while a finding of this signature stays.
pub fn minimised(
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
            match trial.findings.iter().any(|finding| finding.signature() == signature) {
                true => best = smaller,
                false => at += part,
            }
        }
        part /= 2;
    }
    Ok(best)
}
