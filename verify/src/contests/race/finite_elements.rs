//! Runs of the finite-element codes, by `python -m mtled_reference race`.

use super::challenge::{Challenge, triples};
use super::race_run::{Code, RaceRun};
use crate::machine::provenance;
use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::process::Command;

/// A Python interpreter with an installed finite-element code.
#[derive(Debug, Clone)]
pub struct Interpreter {
    /// The code.
    pub code: Code,
    /// Program and flags.
    pub program: Vec<String>,
    /// The folder `reference` of a checkout.
    pub reference: PathBuf,
}

/// An element, and numbers of cells along an edge.
type MeshSeries = (&'static str, &'static [usize]);

/// Elements and uniform meshes of the whole body. `Q1/P0` and `Q2/P1` have p and θ as
/// separate fields.
fn mesh_series(code: Code, challenge: Challenge) -> &'static [MeshSeries] {
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
            ("P2", &[2, 3, 4, 6, 8]),
            ("Q1", &[4, 8, 12]),
            ("Q2", &[2, 3, 4, 6]),
        ],
        (Code::ScikitFem, Challenge::SmoothCompressible) => {
            &[("Q1", &[4, 8, 12]), ("Q2", &[2, 3, 4, 6])]
        }
        (Code::Fenicsx, Challenge::SmoothNearlyIncompressible) => &[
            ("P1", &[4, 8, 12, 16]),
            ("P2", &[2, 3, 4, 6, 8]),
            ("Q1/P0", &[4, 8, 12]),
            ("Q2/P1", &[2, 3, 4, 6]),
        ],
        (Code::ScikitFem, Challenge::SmoothNearlyIncompressible) => {
            &[("Q1/P0", &[4, 8, 12]), ("Q2/P1", &[2, 3, 4, 6])]
        }
    }
}

/// Timings of the finite-element codes, as stored in `reference/race/timings.json`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Timings {
    /// Version of the layout.
    pub schema_version: u32,
    /// YYYY-MM-DD.
    pub date: String,
    /// Name of the processor.
    pub processor: String,
    /// Version and solver of each code.
    pub codes: Vec<Description>,
    /// All runs.
    pub runs: Vec<RaceRun>,
}

/// Version and solver of a code.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// The code.
    pub code: Code,
    /// Its version.
    pub version: String,
    /// Its linear and nonlinear solver.
    pub solver: String,
}

/// What a run of the Python package writes.
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

/// The finite-element codes: those that are installed, and stored timings of the others.
#[derive(Debug)]
pub struct FiniteElementCodes<'a> {
    installed: &'a [Interpreter],
    pub stored: Timings,
    described: std::cell::RefCell<Vec<Description>>,
}

const ONE_THREAD: [&str; 4] =
    ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"];

impl FiniteElementCodes<'_> {
    /// The installed codes, with the bundled timings of the others.
    pub fn new(installed: &[Interpreter]) -> Result<FiniteElementCodes<'_>> {
        let stored = serde_json::from_str(mtled_reference::RACE_TIMINGS)
            .context("reference/race/timings.json")?;
        Ok(FiniteElementCodes { installed, stored, described: Vec::new().into() })
    }

    pub fn is_installed(&self, code: Code) -> bool {
        self.installed.iter().any(|interpreter| interpreter.code == code)
    }

    /// All runs of the installed codes.
    pub fn runs(&self, challenge: Challenge) -> Result<Vec<RaceRun>> {
        let solution = challenge.solution()?;
        let mut runs = Vec::new();
        for interpreter in self.installed {
            for &(element, cells) in mesh_series(interpreter.code, challenge) {
                for &cells in cells {
                    let written = interpreter.run(challenge, element, cells)?;
                    self.describe(interpreter.code, &written);
                    let displacements = triples(&written.displacement_m);
                    if displacements.len() != solution.positions.len() {
                        bail!("{} has other sample points", interpreter.code.title());
                    }
                    let error = solution.error(&displacements);
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

    /// Version and solver of the codes that ran and of those with stored timings.
    pub fn descriptions(&self) -> Vec<Description> {
        let stored = self.stored.codes.iter().filter(|known| !self.is_installed(known.code));
        self.described.borrow().iter().chain(stored).cloned().collect()
    }

    /// Stored runs of the codes that are not installed.
    pub fn stored(&self, challenge: Challenge) -> Vec<RaceRun> {
        let matches =
            |run: &&RaceRun| run.challenge == challenge.name() && !self.is_installed(run.code);
        let mark = |run: &RaceRun| RaceRun { stored: true, ..run.clone() };
        self.stored.runs.iter().filter(matches).map(mark).collect()
    }

    /// The content of `reference/race/timings.json` with these runs.
    pub fn timings<'r>(&self, runs: impl Iterator<Item = &'r RaceRun>) -> Timings {
        let provenance = provenance();
        let own = runs.filter(|run| run.code != Code::Mtled && !run.stored);
        Timings {
            schema_version: self.stored.schema_version,
            date: provenance.date,
            processor: provenance.processor,
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
    ) -> RaceRun {
        RaceRun {
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
    use super::super::race_run::FINITE_ELEMENT_CODES;
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn timings_of_every_mesh_are_stored() {
        let codes = FiniteElementCodes::new(&[]).unwrap();
        for &challenge in Challenge::value_variants() {
            let stored = codes.stored(challenge);
            for code in FINITE_ELEMENT_CODES {
                for (element, cells) in mesh_series(code, challenge) {
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
