//! Runs of the meshless solver, each in a process of its own, and what any run is.

use super::recipes::{Family, families};
use super::{Challenge, Code};
use crate::machine::{cpu_seconds, peak_memory};
use crate::run::{Work, march, prepare_to_run};
use anyhow::{Context, Result, bail};
use mtled::motion::observe::Unobserved;
use mtled_checks::measure::median;
use serde::{Deserialize, Serialize};
use std::process::Command;
use std::time::Instant;

/// One run of any code.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Run {
    pub challenge: String,
    pub code: Code,
    /// The recipe of `mtled`, the element of the others.
    pub family: String,
    /// Spacings or cells along an edge of the body.
    pub per_edge: usize,
    /// Displacement components, with p and θ where they are solved for.
    pub unknowns: usize,
    /// In the unit of the challenge.
    pub error: f64,
    /// Set-up and solution \[s\].
    pub cpu_s: f64,
    /// Of that the set-up \[s\], of `mtled`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_up_cpu_s: Option<f64>,
    /// Start of the interpreter and imports \[s\], not in `cpu_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_cpu_s: Option<f64>,
    /// Generation and compilation of kernels \[s\], not in `cpu_s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compile_cpu_s: Option<f64>,
    pub wall_s: f64,
    pub peak_memory_bytes: u64,
    /// Steps of dynamic relaxation, or corrections of Newton's method.
    pub steps: usize,
    /// Of `mtled`: evaluations of the internal force, products with the tangent
    /// included, and support entries that they visited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub internal_forces: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub neighbour_visits: Option<usize>,
    /// Whether it is from another day, perhaps another machine.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stored: bool,
}

impl Run {
    /// What a user waits for who starts the code anew, kernels compiled before \[s\].
    pub fn with_start(&self) -> f64 {
        self.cpu_s + self.start_cpu_s.unwrap_or(0.0)
    }
}

/// Name of a run on the command line: `CHALLENGE/FAMILY/SPACINGS`.
fn key(challenge: Challenge, family: &Family, spacings: usize) -> String {
    format!("{}/{}/{spacings}", challenge.name(), family.name)
}

/// All runs of a challenge, in child processes with one thread each.
pub fn own(challenge: Challenge) -> Result<Vec<Run>> {
    let program = std::env::current_exe().context("where is this program?")?;
    let mut runs = Vec::new();
    for family in families(challenge) {
        for &spacings in family.ladder {
            let key = key(challenge, family, spacings);
            let mut command = Command::new(&program);
            command.args(["study", "race", "--threads", "1", "--run", &key]);
            let output = command.output().with_context(|| format!("cannot start {key}"))?;
            if !output.status.success() {
                bail!("{key}: {}", String::from_utf8_lossy(&output.stderr).trim());
            }
            runs.push(serde_json::from_slice(&output.stdout).with_context(|| key)?);
        }
    }
    Ok(runs)
}

/// Runs `key` in this process.
pub fn run_here(key: &str) -> Result<Run> {
    let wanted = <Challenge as clap::ValueEnum>::value_variants().iter().find_map(|&challenge| {
        let family = |family: &&Family| {
            family.ladder.iter().any(|&n| self::key(challenge, family, n) == key)
        };
        let found = families(challenge).iter().find(family)?;
        let spacings = found.ladder.iter().find(|&&n| self::key(challenge, found, n) == key)?;
        Some((challenge, found, *spacings))
    });
    let Some((challenge, family, spacings)) = wanted else { bail!("there is no run {key}") };
    let start = Instant::now();
    let mut problem = challenge.pose()?;
    family.apply(challenge, spacings, &mut problem);
    let prepared = prepare_to_run(&problem)?;
    let set_up_cpu_s = cpu_seconds();
    let solved = march(&problem, prepared, &mut Unobserved)?;
    let (cpu_s, wall_s) = (cpu_seconds(), start.elapsed().as_secs_f64());
    let peak_memory_bytes = peak_memory().context("the system does not tell the peak memory")?;
    let truth = challenge.truth()?;
    let components = solved.prepared.model.components;
    let rows = solved.prepared.discretisation.rows_at(&truth.places)?;
    let displacement = |i| rows.interpolate(i, &solved.state.displacement, components).into();
    let work = Work::of(&solved);
    let displacements: Vec<[f64; 3]> = (0..rows.len()).map(displacement).collect();
    Ok(Run {
        challenge: challenge.name().to_string(),
        code: Code::Mtled,
        family: family.name.to_string(),
        per_edge: spacings,
        unknowns: solved.prepared.model.size(),
        error: truth.error(&displacements),
        cpu_s,
        set_up_cpu_s: Some(set_up_cpu_s),
        start_cpu_s: None,
        compile_cpu_s: None,
        wall_s,
        peak_memory_bytes,
        steps: solved.summary.newton.map_or(solved.summary.steps, |newton| newton.iterations),
        internal_forces: Some(work.force_evaluations),
        neighbour_visits: Some(work.neighbour_visits),
        stored: false,
    })
}

/// The runs of the first turn with the medians of all turns; every turn has the
/// same runs in the same order.
pub fn medians(turns: &[Vec<Run>]) -> Vec<Run> {
    let Some(first) = turns.first() else { return Vec::new() };
    let middle = |index: usize, of: fn(&Run) -> Option<f64>| {
        let seen: Option<Vec<f64>> = turns.iter().map(|turn| of(&turn[index])).collect();
        seen.and_then(|seen| median(&seen))
    };
    let merged = |(index, run): (usize, &Run)| Run {
        cpu_s: middle(index, |run| Some(run.cpu_s)).unwrap_or(run.cpu_s),
        wall_s: middle(index, |run| Some(run.wall_s)).unwrap_or(run.wall_s),
        set_up_cpu_s: middle(index, |run| run.set_up_cpu_s),
        start_cpu_s: middle(index, |run| run.start_cpu_s),
        compile_cpu_s: middle(index, |run| run.compile_cpu_s),
        ..run.clone()
    };
    first.iter().enumerate().map(merged).collect()
}
