//! The door of the protocol to this solver.

use anyhow::{Result, bail};
use mtled::Simulation;
use mtled_case::protocol::{
    Answer, Job, PROTOCOL, Refusal, RefusalReason, Refused, Reply, SolverName,
};
use mtled_case::reference::{Family, is_dynamic, quantities};
use mtled_case::scene::{Case, Knob, Override, Setting, edited, one_error, parse_overridden};
use mtled_run::accuracy::{SAMPLES, values};
use mtled_run::machine::{cpu_seconds, peak_memory};
use mtled_run::run::{Recorder, integrate, refuse_beyond_memory};
use std::collections::BTreeMap;
use std::path::Path;

/// Solves a job with the recipe of its case file at the wanted spacing, and with other values in
/// place of those of the file.
pub fn solve_job(job: &Job, overrides: &[Override]) -> Result<Reply> {
    let case = match case_of(job, overrides)? {
        Ok(case) => case,
        Err(reason) => return Ok(refusal(RefusalReason::Resolution, reason)),
    };
    if let Err(shortage) = refuse_beyond_memory(&case) {
        return Ok(refusal(RefusalReason::Resolution, shortage.to_string()));
    }
    let simulation = match Simulation::new(&case.problem) {
        Ok(simulation) => simulation,
        Err(error) => return Ok(refusal(RefusalReason::Resolution, error.to_string())),
    };
    let unknowns = unknowns(&case, &simulation);
    let mut recorder = Recorder::new(&case, &simulation, 0)?;
    match integrate(simulation, &mut recorder) {
        Ok(solved) if solved.summary.stopped => bail!("stopped"),
        Ok(_) => {}
        Err(error) => return Ok(refusal(RefusalReason::NotConverged, error.to_string())),
    }
    let values = values(&case, &recorder.finish(), &job.instants_s)?;
    Ok(Reply::Answer(answer(&case, &values, unknowns)))
}

/// Components of all nodes without those that are prescribed at the end.
fn unknowns(case: &Case, simulation: &Simulation) -> u64 {
    let mut prescribed = 0;
    let end = case.problem.motion.end();
    simulation.model.constraints.for_each_row(end, |_, _| prescribed += 1);
    (simulation.model.size() as u64).saturating_sub(prescribed).max(1)
}

/// The case at the wanted spacing, or why there is none.
fn case_of(job: &Job, overrides: &[Override]) -> Result<Result<Case, String>> {
    let text = match edited(&job.case_text()?, &[Setting::number(Knob::Spacing, job.spacing_m)]) {
        Ok(text) => text,
        Err(reason) => return Ok(Err(reason.to_string())),
    };
    let name = format!("{}.toml", job.case);
    let mut case = parse_overridden(&text, &name, Path::new("."), overrides).map_err(one_error)?;
    if is_dynamic(&case) {
        case.outputs.history = case.outputs.history.max(SAMPLES);
    }
    Ok(Ok(case))
}

fn solver() -> SolverName {
    SolverName { name: "mtled".into(), version: env!("CARGO_PKG_VERSION").into() }
}

/// The recipe in words.
fn method(overrides: &[Override]) -> String {
    let set: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    let with = if set.is_empty() { String::new() } else { format!(" with {}", set.join(", ")) };
    format!("the recipe of the case file{with}")
}

fn refusal(reason: RefusalReason, what: String) -> Reply {
    let refused = Refused { reason, what };
    Reply::Refusal(Refusal { protocol: PROTOCOL, solver: solver(), refused })
}

fn answer(case: &Case, values: &[Vec<f64>], unknowns: u64) -> Answer {
    let (mut displacements_m, mut reactions_n) = (BTreeMap::new(), BTreeMap::new());
    let mut moments_nm = BTreeMap::new();
    let (mut strain_energy_j, mut kinetic_energy_j) = (None, None);
    for (quantity, values) in quantities(case).iter().zip(values) {
        let name = quantity.name.split_once('/').map_or("", |(_, name)| name).to_string();
        let triples: Vec<[f64; 3]> = values.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect();
        match quantity.family {
            Family::Displacement => {
                let positions = quantity.width / quantity.family.components();
                let instants = triples.chunks(positions).map(<[_]>::to_vec).collect();
                displacements_m.insert(name, instants);
            }
            Family::Force => drop(reactions_n.insert(name, triples)),
            Family::Moment => drop(moments_nm.insert(name, triples)),
            Family::StrainEnergy => strain_energy_j = Some(values.clone()),
            Family::KineticEnergy => kinetic_energy_j = Some(values.clone()),
            Family::Centre => {}
        }
    }
    Answer {
        protocol: PROTOCOL,
        solver: solver(),
        displacements_m,
        reactions_n,
        moments_nm,
        strain_energy_j,
        kinetic_energy_j,
        unknowns,
        cpu_s: Some(cpu_seconds()),
        peak_memory_bytes: peak_memory(),
        apart_cpu_s: None,
        method: Some(method(case.overrides())),
    }
}
