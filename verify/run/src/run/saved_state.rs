//! The state of a motion as a file, from which `mtled solve --from` goes on with it.
#![allow(non_snake_case)]

use anyhow::{Context, Result, ensure};
use mtled::motion::state::State;
use mtled::problem::Motion;
use mtled::{Model, Simulation};
use mtled_checks::report::write_atomically;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::Path;

/// Version of the file.
const VERSION: u32 = 2;

/// What a file of a state holds; `S` is a state, or a reference to one.
#[derive(Serialize, Deserialize)]
struct Saved<S> {
    mtled_state: u32,
    /// Version of the program.
    program: String,
    /// A hash of nodes, materials, masses and what else must be the same.
    body: String,
    time_s: f64,
    /// Of the state.
    digest: String,
    state: S,
}

/// A state that is to be written.
#[derive(Debug, Clone)]
pub struct SavedState {
    body: String,
    state: State,
}

impl SavedState {
    /// Of a model.
    pub(crate) fn new(model: &Model, state: &State) -> SavedState {
        SavedState { body: fingerprint(model), state: state.clone() }
    }

    fn text(&self) -> Result<String> {
        let saved = Saved {
            mtled_state: VERSION,
            program: env!("CARGO_PKG_VERSION").to_string(),
            body: self.body.clone(),
            time_s: self.state.time,
            digest: digest(&self.state)?,
            state: &self.state,
        };
        Ok(serde_json::to_string(&saved)? + "\n")
    }

    /// Has a motion go on from the state in a file.
    ///
    /// # Errors
    /// A file that cannot be read, of another body, or of a time at which nothing is left of the
    /// motion.
    pub fn read(path: &Path, simulation: &mut Simulation) -> Result<()> {
        let named = || path.display().to_string();
        let text = std::fs::read_to_string(path).with_context(named)?;
        let saved: Saved<State> = serde_json::from_str(&text)
            .with_context(|| format!("{}: this is not a state that mtled has written", named()))?;
        let known = saved.mtled_state;
        ensure!(known == VERSION, "{}: version {known} is not known; write it again", named());
        let Motion::Dynamic { end, .. } = simulation.problem.motion else {
            anyhow::bail!(
                "{}: only a motion goes on from a state, and the case is static",
                named()
            );
        };
        let fits = saved.body == fingerprint(&simulation.model);
        ensure!(
            fits,
            "{}: it is of another body: nodes, materials, masses, initial velocities, what conditions hold and the names of obstacles, in their order, must be those of the run that wrote it; loads and times may differ",
            named()
        );
        let time = saved.time_s;
        let kept = time == saved.state.time && saved.digest == digest(&saved.state)?;
        ensure!(kept, "{}: its numbers are not those that mtled has written", named());
        ensure!(
            time < end,
            "{}: it is at {time} s, and time.end = {end} s leaves nothing of the motion",
            named()
        );
        simulation.continue_from(saved.state).with_context(named)
    }
}

/// Whether a name is that of a state of a run.
pub(crate) fn is_state(name: &str) -> bool {
    let number = name.strip_prefix("state_").and_then(|rest| rest.strip_suffix(".json"));
    number.is_some_and(|number| number.parse::<usize>().is_ok())
}

/// Writes states to `state_1.json`, `state_2.json`, … in a folder.
pub(crate) fn write_states(states: &[SavedState], dir: &Path) -> Result<()> {
    for (number, saved) in states.iter().enumerate() {
        let path = dir.join(format!("state_{}.json", number + 1));
        write_atomically(&path, saved.text()?.as_bytes())?;
    }
    Ok(())
}

/// A hash of all numbers of a state.
fn digest(state: &State) -> Result<String> {
    Ok(hex(Sha256::new().chain_update(serde_json::to_string(state)?)))
}

fn hex(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A hash of what a state belongs to, with the obstacles that it numbers.
fn fingerprint(model: &Model) -> String {
    let mut hash = Sha256::new();
    let mut add = |number: f64| hash.update(number.to_bits().to_le_bytes());
    model.positions.iter().flat_map(|X| X.iter()).for_each(|number| add(*number));
    let of_nodes = model.inertia.iter().chain(&model.stiffness).chain(&model.initial_velocity);
    of_nodes.for_each(|number| add(*number));
    for block in &model.points.blocks {
        block.frames.iter().flatten().flat_map(|entry| entry.0).for_each(&mut add);
    }
    for block in &model.points.blocks {
        let material = (&block.law, &block.viscosity, &block.active);
        hash.update(format!("{material:?}").as_bytes());
    }
    hash.update(format!("{:?}", model.constraints.held()).as_bytes());
    let obstacles = model.contact.obstacles.iter().map(|obstacle| &obstacle.name);
    hash.update(format!("{:?}", obstacles.collect::<Vec<_>>()).as_bytes());
    hex(hash)
}
