//! Runs of the meshless solver, each in its own process.

use super::challenge::Challenge;
use super::race_run::{Code, RaceRun};
use super::recipes::{Family, families};
use crate::machine::{cpu_seconds, peak_memory};
use crate::run::{Work, integrate, prepare_to_run};
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use mtled::motion::observe::Unobserved;
use std::process::Command;
use std::time::Instant;

/// Name of a run on the command line: `CHALLENGE/FAMILY/SPACINGS`.
fn key(challenge: Challenge, family: &Family, spacings: usize) -> String {
    format!("{}/{}/{spacings}", challenge.name(), family.name)
}

/// All runs of a challenge, in child processes with one thread each.
pub fn own_runs(challenge: Challenge) -> Result<Vec<RaceRun>> {
    let program = std::env::current_exe().context("the path of this program is not known")?;
    let mut runs = Vec::new();
    for family in families(challenge) {
        for &spacings in family.spacings {
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
pub fn run_here(key: &str) -> Result<RaceRun> {
    let mut all = Challenge::value_variants().iter().flat_map(|&challenge| {
        families(challenge).iter().flat_map(move |family| {
            family.spacings.iter().map(move |&spacings| (challenge, family, spacings))
        })
    });
    let run =
        all.find(|&(challenge, family, spacings)| self::key(challenge, family, spacings) == key);
    let Some((challenge, family, spacings)) = run else { bail!("there is no run {key}") };
    let start = Instant::now();
    let mut problem = challenge.problem()?;
    family.apply(challenge, spacings, &mut problem);
    let prepared = prepare_to_run(&problem)?;
    let set_up_cpu_s = cpu_seconds();
    let solved = integrate(&problem, prepared, &mut Unobserved)?;
    let (cpu_s, wall_s) = (cpu_seconds(), start.elapsed().as_secs_f64());
    let peak_memory_bytes = peak_memory().context("the system does not report the peak memory")?;
    let solution = challenge.solution()?;
    let components = solved.prepared.model.components;
    let rows = solved.prepared.discretisation.rows_at(&solution.positions)?;
    let displacement = |i| rows.interpolate(i, &solved.state.displacement, components).into();
    let work = Work::of(&solved);
    let displacements: Vec<[f64; 3]> = (0..rows.len()).map(displacement).collect();
    Ok(RaceRun {
        challenge: challenge.name().to_string(),
        code: Code::Mtled,
        family: family.name.to_string(),
        per_edge: spacings,
        unknowns: solved.prepared.model.size(),
        error: solution.error(&displacements),
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
