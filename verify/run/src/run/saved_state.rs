//! The state of a motion as a file, from which `mtled solve --from` goes on with it.
#![allow(non_snake_case)]

use anyhow::{Context, Result, ensure};
use mtled::Model;
use mtled::motion::state::State;
use mtled::problem::{Motion, Problem};
use mtled_checks::report::write_atomically;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::Path;

/// Version of the file.
const VERSION: u32 = 1;

/// What a file of a state holds; `S` is a state, or a reference to one.
#[derive(Serialize, Deserialize)]
struct Saved<S> {
    mtled_state: u32,
    /// Version of the program.
    program: String,
    /// Of nodes, masses and stiffnesses.
    body: String,
    time_s: f64,
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
    pub fn new(model: &Model, state: &State) -> SavedState {
        SavedState { body: fingerprint(model), state: state.clone() }
    }

    fn text(&self) -> Result<String> {
        let saved = Saved {
            mtled_state: VERSION,
            program: env!("CARGO_PKG_VERSION").to_string(),
            body: self.body.clone(),
            time_s: self.state.time,
            state: &self.state,
        };
        Ok(serde_json::to_string(&saved)? + "\n")
    }

    /// The state in a file, for a motion that goes on from it.
    ///
    /// # Errors
    /// A file that cannot be read, of another body, or of a time at which nothing is left of the
    /// motion.
    pub fn read(path: &Path, problem: &Problem, model: &Model) -> Result<State> {
        let named = || path.display().to_string();
        let text = std::fs::read_to_string(path).with_context(named)?;
        let saved: Saved<State> = serde_json::from_str(&text)
            .with_context(|| format!("{}: this is not a state that mtled has written", named()))?;
        let known = saved.mtled_state;
        ensure!(known == VERSION, "{}: version {known} is not known; write it again", named());
        let Motion::Dynamic { end, .. } = problem.motion else {
            anyhow::bail!(
                "{}: only a motion goes on from a state, and the case is static",
                named()
            );
        };
        let fits = saved.body == fingerprint(model) && saved.state.misfit(model).is_none();
        ensure!(
            fits,
            "{}: it is of another body: nodes, materials, masses, what conditions hold and the names of obstacles, in their order, must be those of the run that wrote it; loads and times may differ",
            named()
        );
        let time = saved.time_s;
        ensure!(
            time == saved.state.time && time < end,
            "{}: it is at {time} s, and time.end = {end} s leaves nothing of the motion",
            named()
        );
        Ok(saved.state)
    }
}

/// Whether a name is that of a state of a run.
pub fn is_state(name: &str) -> bool {
    let number = name.strip_prefix("state_").and_then(|rest| rest.strip_suffix(".json"));
    number.is_some_and(|number| number.parse::<usize>().is_ok())
}

/// Writes states to `state_1.json`, `state_2.json`, … in a folder.
pub fn write_states(states: &[SavedState], dir: &Path) -> Result<()> {
    for (number, saved) in states.iter().enumerate() {
        let path = dir.join(format!("state_{}.json", number + 1));
        write_atomically(&path, saved.text()?.as_bytes())?;
    }
    Ok(())
}

/// A hash of what a state belongs to, with the obstacles that it numbers.
fn fingerprint(model: &Model) -> String {
    let mut hash = Sha256::new();
    let mut add = |number: f64| hash.update(number.to_bits().to_le_bytes());
    model.positions.iter().flat_map(|X| X.iter()).for_each(|number| add(*number));
    model.inertia.iter().chain(&model.stiffness).for_each(|number| add(*number));
    for block in &model.blocks {
        block.frames.iter().flatten().flat_map(|entry| entry.0).for_each(&mut add);
    }
    for block in &model.blocks {
        let material = (&block.law, &block.viscosity, &block.active);
        hash.update(format!("{material:?}").as_bytes());
    }
    hash.update(format!("{:?}", model.constraints.held()).as_bytes());
    let obstacles = model.contact.obstacles.iter().map(|obstacle| &obstacle.name);
    hash.update(format!("{:?}", obstacles.collect::<Vec<_>>()).as_bytes());
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
