//! Runs of the finite-element codes, by `python -m mtled_reference race`.

use super::problems::triples;
use super::{Challenge, Run};
use crate::machine::provenance;
use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::process::Command;

/// Who races.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Code {
    Mtled,
    Fenicsx,
    ScikitFem,
}

impl Code {
    /// As the Python package calls it.
    pub fn name(self) -> &'static str {
        match self {
            Code::Mtled => "mtled",
            Code::Fenicsx => "fenicsx",
            Code::ScikitFem => "scikit-fem",
        }
    }

    pub fn title(self) -> &'static str {
        match self {
            Code::Mtled => "mtled",
            Code::Fenicsx => "FEniCSx",
            Code::ScikitFem => "scikit-fem",
        }
    }
}

/// The finite-element codes.
pub const RIVALS: [Code; 2] = [Code::Fenicsx, Code::ScikitFem];

/// A code that is installed: `python -m mtled_reference` as words.
#[derive(Debug, Clone)]
pub struct Interpreter {
    pub code: Code,
    pub program: Vec<String>,
    /// The folder `reference` of a checkout.
    pub reference: PathBuf,
}

/// An element and cells along an edge.
type Ladder = (&'static str, &'static [usize]);

/// What each code is raced with, whole bodies, uniform meshes. `Q1/P0` and `Q2/P1`
/// have p and θ as fields of their own.
fn ladders(code: Code, challenge: Challenge) -> &'static [Ladder] {
    match (code, challenge) {
        (Code::Mtled, _) => &[],
        (Code::Fenicsx, Challenge::BondedBlock) => &[
            ("P1", &[4, 8, 12, 16]),
            ("P2", &[2, 4, 6]),
            ("Q1/P0", &[4, 8, 12]),
            ("Q2/P1", &[2, 3, 4, 6]),
        ],
        (Code::ScikitFem, Challenge::BondedBlock) => {
            &[("Q1", &[4, 8, 12]), ("Q1/P0", &[4, 8, 12]), ("Q2/P1", &[2, 3, 4, 6])]
        }
        (Code::Fenicsx, Challenge::SmoothCompressible) => &[
            ("P1", &[4, 8, 12, 16]),
            ("P2", &[2, 3, 4, 6]),
            ("Q1", &[4, 8, 12]),
            ("Q2", &[2, 3, 4]),
        ],
        (Code::ScikitFem, Challenge::SmoothCompressible) => {
            &[("Q1", &[4, 8, 12]), ("Q2", &[2, 3, 4])]
        }
        (Code::Fenicsx, Challenge::SmoothNearlyIncompressible) => &[
            ("P1", &[4, 8, 12, 16]),
            ("P2", &[2, 3, 4, 6]),
            ("Q1/P0", &[4, 8, 12]),
            ("Q2/P1", &[2, 3, 4]),
        ],
        (Code::ScikitFem, Challenge::SmoothNearlyIncompressible) => {
            &[("Q1/P0", &[4, 8, 12]), ("Q2/P1", &[2, 3, 4])]
        }
    }
}

/// Timings of another day.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Timings {
    pub schema_version: u32,
    /// YYYY-MM-DD.
    pub date: String,
    pub processor: String,
    /// Version and solver by code.
    pub codes: Vec<Description>,
    pub runs: Vec<Run>,
}

/// What ran.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Description {
    pub code: Code,
    pub version: String,
    pub solver: String,
}

/// What a run of Python writes.
#[derive(Debug, Deserialize)]
struct Written {
    version: String,
    solver: String,
    unknowns: usize,
    newton_iterations: usize,
    start_cpu_s: f64,
    compile_cpu_s: f64,
    cpu_s: f64,
    wall_s: f64,
    peak_memory_bytes: u64,
    displacement_m: Vec<f64>,
}

/// The finite-element codes: those that are here, and what is stored of the others.
#[derive(Debug)]
pub struct Rivals<'a> {
    here: &'a [Interpreter],
    pub stored: Timings,
    described: std::cell::RefCell<Vec<Description>>,
}

const ONE_THREAD: [&str; 4] =
    ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"];

impl Rivals<'_> {
    pub fn new(here: &[Interpreter]) -> Result<Rivals<'_>> {
        let text = include_str!("../../../../reference/race/timings.json");
        let stored = serde_json::from_str(text).context("reference/race/timings.json")?;
        Ok(Rivals { here, stored, described: Vec::new().into() })
    }

    pub fn is_here(&self, code: Code) -> bool {
        self.here.iter().any(|interpreter| interpreter.code == code)
    }

    /// All runs of the codes that are here.
    pub fn runs(&self, challenge: Challenge) -> Result<Vec<Run>> {
        let truth = challenge.truth()?;
        let mut runs = Vec::new();
        for interpreter in self.here {
            for &(element, cells) in ladders(interpreter.code, challenge) {
                for &cells in cells {
                    let written = interpreter.run(challenge, element, cells)?;
                    self.describe(interpreter.code, &written);
                    let displacements = triples(&written.displacement_m);
                    if displacements.len() != truth.places.len() {
                        bail!("{} has looked elsewhere", interpreter.code.title());
                    }
                    let error = truth.error(&displacements);
                    runs.push(written.into_run(challenge, interpreter.code, element, cells, error));
                }
            }
        }
        Ok(runs)
    }

    fn describe(&self, code: Code, written: &Written) {
        let description =
            Description { code, version: written.version.clone(), solver: written.solver.clone() };
        let mut described = self.described.borrow_mut();
        if !described.contains(&description) {
            described.push(description);
        }
    }

    /// Version and solver of what ran, and of what is stored.
    pub fn descriptions(&self) -> Vec<Description> {
        let stored = self.stored.codes.iter().filter(|known| !self.is_here(known.code));
        self.described.borrow().iter().chain(stored).cloned().collect()
    }

    /// Stored runs of the codes that are not here.
    pub fn stored(&self, challenge: Challenge) -> Vec<Run> {
        let wanted = |run: &&Run| run.challenge == challenge.name() && !self.is_here(run.code);
        let mark = |run: &Run| Run { stored: true, ..run.clone() };
        self.stored.runs.iter().filter(wanted).map(mark).collect()
    }

    /// What `reference/race/timings.json` would hold of these runs.
    pub fn timings<'r>(&self, runs: impl Iterator<Item = &'r Run>) -> Timings {
        let here = provenance();
        let own = runs.filter(|run| run.code != Code::Mtled && !run.stored);
        Timings {
            schema_version: self.stored.schema_version,
            date: here.date,
            processor: here.processor,
            codes: self.described.borrow().clone(),
            runs: own.cloned().collect(),
        }
    }
}

impl Interpreter {
    fn run(&self, challenge: Challenge, element: &str, cells: usize) -> Result<Written> {
        let folder = tempfile::tempdir()?;
        let out = folder.path().join("run.json");
        let (program, flags) = self.program.split_first().context("no interpreter")?;
        let mut command = Command::new(program);
        command.args(flags).args(["-m", "mtled_reference", "race", challenge.name()]);
        command.arg("--cases").arg(self.reference.join("cases"));
        command.args(["--code", self.code.name(), "--element", element]);
        command.args(["--cells", &cells.to_string()]).arg("--out").arg(&out);
        command.env("PYTHONPATH", &self.reference);
        ONE_THREAD.iter().for_each(|name| {
            command.env(name, "1");
        });
        let output = command.output().with_context(|| format!("cannot start {program}"))?;
        if !output.status.success() {
            let reason = String::from_utf8_lossy(&output.stderr);
            let last = reason.lines().last().unwrap_or_default();
            bail!("{}, {element}, {cells} cells: {last}", self.code.title());
        }
        Ok(serde_json::from_str(&std::fs::read_to_string(&out)?)?)
    }
}

impl Written {
    fn into_run(
        self,
        challenge: Challenge,
        code: Code,
        element: &str,
        cells: usize,
        error: f64,
    ) -> Run {
        Run {
            challenge: challenge.name().to_string(),
            code,
            family: element.to_string(),
            per_edge: cells,
            unknowns: self.unknowns,
            error,
            cpu_s: self.cpu_s,
            set_up_cpu_s: None,
            start_cpu_s: Some(self.start_cpu_s),
            compile_cpu_s: Some(self.compile_cpu_s),
            wall_s: self.wall_s,
            peak_memory_bytes: self.peak_memory_bytes,
            steps: self.newton_iterations,
            internal_forces: None,
            neighbour_visits: None,
            stored: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn timings_are_stored_of_every_rung_of_every_ladder() {
        let rivals = Rivals::new(&[]).unwrap();
        for &challenge in Challenge::value_variants() {
            let stored = rivals.stored(challenge);
            for code in RIVALS {
                for (element, cells) in ladders(code, challenge) {
                    for cells in *cells {
                        let run = stored.iter().find(|run| {
                            run.code == code && run.family == *element && run.per_edge == *cells
                        });
                        let run = run.unwrap_or_else(|| panic!("{code:?} {element} {cells}"));
                        assert!(run.stored && run.cpu_s > 0.0 && run.error > 0.0);
                    }
                }
            }
        }
    }
}
