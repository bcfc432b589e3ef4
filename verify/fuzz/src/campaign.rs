//! All targets in turn: first the corpus, then mutations until the time is up.

use crate::corpus;
use crate::finding::{Finding, Outcome};
use crate::minimise::{minimised, smallest_scene};
use crate::mutate::{Input, drawn_scene, mutated};
use crate::process::Limits;
use crate::seeds;
use crate::station::{Station, Trial};
use crate::tally::Tally;
use crate::target::Target;
use anyhow::{Result, anyhow};
use fastrand::Rng;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};

/// A target is tried this long before the next one.
const SLICE: Duration = Duration::from_millis(500);
/// Accepted mutations that are mutated further, for each target.
const MOST_KEPT: usize = 200;
/// Larger mutations are not mutated further \[byte\].
const LARGEST_KEPT: usize = 20_000;

/// What is run.
#[derive(Debug, Clone)]
pub struct Options {
    /// Targets.
    pub targets: Vec<Target>,
    /// Time for mutations.
    pub time: Duration,
    /// Stations at work at the same time.
    pub jobs: usize,
    /// Of the random numbers.
    pub seed: u64,
    /// Folder of earlier findings, to which new ones are added.
    pub corpus: PathBuf,
    /// Of each child.
    pub limits: Limits,
}

/// What came of it.
#[derive(Debug, Default)]
pub struct Results {
    /// Counts.
    pub tallies: BTreeMap<Target, Tally>,
    /// Distinct findings with their inputs.
    pub findings: Vec<(Target, Finding, PathBuf)>,
    known: BTreeSet<(Target, String)>,
}

/// Runs everything; findings are told as they come.
pub fn run(options: &Options, tell: &(dyn Fn(&str) + Sync)) -> Result<Results> {
    let campaign = Campaign { options, tell, results: Mutex::default() };
    let companions = seeds::companions()?;
    let mut stations = (0..options.jobs.max(1))
        .map(|_| Station::new(companions.clone(), options.limits))
        .collect::<Result<Vec<_>>>()?;
    campaign.replay(&mut stations[0])?;
    if !options.time.is_zero() {
        let deadline = Instant::now() + options.time;
        let jobs: Vec<Result<()>> = std::thread::scope(|scope| {
            let campaign = &campaign;
            let handles: Vec<_> = (stations.iter_mut().enumerate())
                .map(|(job, station)| scope.spawn(move || campaign.job(job, station, deadline)))
                .collect();
            handles
                .into_iter()
                .map(|handle| handle.join().unwrap_or_else(|_| Err(anyhow!("a job panicked"))))
                .collect()
        });
        jobs.into_iter().collect::<Result<Vec<()>>>()?;
    }
    Ok(campaign.results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner()))
}

struct Campaign<'a> {
    options: &'a Options,
    tell: &'a (dyn Fn(&str) + Sync),
    results: Mutex<Results>,
}

/// Inputs of a target, with the random numbers that choose among them.
struct Pool {
    inputs: Vec<Input>,
    first_kept: usize,
    rng: Rng,
}

impl Campaign<'_> {
    fn results(&self) -> MutexGuard<'_, Results> {
        self.results.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Tries what was found before.
    fn replay(&self, station: &mut Station) -> Result<()> {
        for &target in &self.options.targets {
            for (path, input) in corpus::read(&self.options.corpus, target)? {
                let trial = self.counted(station, target, &input)?;
                for finding in trial.findings {
                    self.add(target, finding, path.clone());
                }
            }
        }
        Ok(())
    }

    fn job(&self, job: usize, station: &mut Station, deadline: Instant) -> Result<()> {
        let mut pools = BTreeMap::new();
        for &target in &self.options.targets {
            let mut inputs = seeds::inputs(target)?;
            let found = corpus::read(&self.options.corpus, target)?;
            inputs.extend(found.into_iter().map(|(_, input)| input));
            let mixed = self.options.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
                ^ ((target as u64) << 32)
                ^ job as u64;
            pools.insert(
                target,
                Pool { first_kept: inputs.len(), inputs, rng: Rng::with_seed(mixed) },
            );
        }
        while Instant::now() < deadline {
            for (&target, pool) in &mut pools {
                let end = (Instant::now() + SLICE).min(deadline);
                while Instant::now() < end {
                    self.one(station, target, pool)?;
                }
            }
        }
        Ok(())
    }

    /// One mutation.
    fn one(&self, station: &mut Station, target: Target, pool: &mut Pool) -> Result<()> {
        let Pool { inputs, first_kept, rng } = pool;
        let [a, b] = [0, 1].map(|_| rng.usize(..inputs.len()));
        let input = match target {
            Target::Scene => drawn_scene(rng),
            _ => mutated(&inputs[a], &inputs[b], target.extensions(), rng),
        };
        let trial = self.counted(station, target, &input)?;
        for finding in &trial.findings {
            self.save(station, target, &input, finding)?;
        }
        if trial.outcome == Some(Outcome::Succeeded) && input.bytes.len() < LARGEST_KEPT {
            if inputs.len() - *first_kept < MOST_KEPT {
                inputs.push(input);
            } else {
                let at = rng.usize(*first_kept..inputs.len());
                inputs[at] = input;
            }
        }
        Ok(())
    }

    fn counted(&self, station: &mut Station, target: Target, input: &Input) -> Result<Trial> {
        let start = Instant::now();
        let trial = station.try_input(target, input)?;
        let seconds = start.elapsed().as_secs_f64();
        self.results().tallies.entry(target).or_default().count(&trial, seconds);
        Ok(trial)
    }

    /// Adds the first input of each signature to the corpus.
    fn save(
        &self,
        station: &mut Station,
        target: Target,
        input: &Input,
        finding: &Finding,
    ) -> Result<()> {
        let signature = finding.signature();
        if !self.results().known.insert((target, signature.clone())) {
            return Ok(());
        }
        let small = match target {
            Target::Scene => smallest_scene(station, input, &signature)?,
            _ => minimised(station, target, input, &signature)?,
        };
        let path = corpus::save(&self.options.corpus, target, finding.kind, &small)?;
        self.add(target, finding.clone(), path);
        Ok(())
    }

    fn add(&self, target: Target, finding: Finding, path: PathBuf) {
        (self.tell)(&format!("{}: {finding}\n    {}", target.name(), path.display()));
        let mut results = self.results();
        results.known.insert((target, finding.signature()));
        results.findings.push((target, finding, path));
    }
}
