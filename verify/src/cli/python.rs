//! Python interpreters for the finite-element codes.

use anyhow::{Context, Result, anyhow, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// How to install FEniCSx.
const FENICSX: &str =
    "no Python that imports dolfinx was found. Install FEniCSx in one of these ways:
  Debian, Ubuntu:  apt-get install python3-dolfinx-real libopenblas0-serial
  conda-forge:     conda create -n fenicsx -c conda-forge fenics-dolfinx && conda activate fenicsx
  container:       docker run -ti -v \"$PWD\":/work -w /work dolfinx/dolfinx:stable";

/// How to install what a virtual environment needs.
const VENV: &str = "Install Python 3.11 or newer with venv (Debian: apt-get install python3-venv) and let pip reach a package index";

/// An interpreter with its flags.
#[derive(Debug, Clone)]
pub(crate) struct Python {
    program: PathBuf,
    flags: &'static [&'static str],
}

impl Python {
    fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.args(self.flags);
        command
    }

    /// `python -m mtled_reference` with the package in the folder `reference`.
    pub(crate) fn module(&self, reference: &Path) -> Command {
        let mut command = self.command();
        command.args(["-m", "mtled_reference"]).env("PYTHONPATH", reference);
        command
    }

    /// Program and flags.
    pub(crate) fn program_and_flags(&self) -> Vec<String> {
        let program = self.program.display().to_string();
        std::iter::once(program).chain(self.flags.iter().map(|flag| flag.to_string())).collect()
    }

    fn imports(&self, module: &str) -> bool {
        let mut command = self.command();
        command.args(["-c", &format!("import {module}")]);
        let status = command.stdout(Stdio::null()).stderr(Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    }
}

/// The Python that runs `code`, set up if necessary; an error says what to install.
pub(crate) fn python_for(code: &str, reference: &Path, say: &dyn Fn(&str)) -> Result<Python> {
    match code {
        "fenicsx" => fenicsx(),
        _ => scikit_fem(reference, say),
    }
}

/// A Python that imports a module, if there is one.
pub(crate) fn with_module(module: &str, reference: &Path) -> Option<Python> {
    match module {
        "dolfinx" => fenicsx().ok(),
        _ => Some(virtual_environment(reference)).filter(|python| python.imports(module)),
    }
}

/// The folder `reference` of the checkout around the working directory.
pub(crate) fn checkout() -> Result<PathBuf> {
    let here = std::env::current_dir()?;
    let found = here.ancestors().map(|folder| folder.join("reference"));
    let found = found.into_iter().find(|folder| folder.join("pyproject.toml").is_file());
    found.ok_or_else(|| {
        anyhow!("no folder `reference` with the Python package was found; work in a checkout or name it with --reference DIR")
    })
}

fn virtual_environment(reference: &Path) -> Python {
    let program = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };
    Python { program: reference.join(".venv").join(program), flags: &[] }
}

/// That of Debian first: `-s` ignores packages of the user, which break petsc4py.
fn fenicsx() -> Result<Python> {
    let candidates = [("/usr/bin/python3", &["-s"] as &[&str]), ("python3", &[])];
    for (program, flags) in candidates {
        let python = Python { program: program.into(), flags };
        if python.imports("dolfinx") {
            return Ok(python);
        }
    }
    bail!(FENICSX)
}

/// The virtual environment `reference/.venv`, created if it is missing.
fn scikit_fem(reference: &Path, say: &dyn Fn(&str)) -> Result<Python> {
    let folder = reference.join(".venv");
    let python = virtual_environment(reference);
    if python.imports("skfem") {
        return Ok(python);
    }
    say("creating reference/.venv with scikit-fem");
    let system = if cfg!(windows) { "python" } else { "python3" };
    run(Command::new(system).args(["-m", "venv"]).arg(&folder))?;
    let package = format!("{}[scikit-fem]", reference.display());
    run(python.command().args(["-m", "pip", "install", "--quiet", &package]))?;
    if !python.imports("skfem") {
        bail!("{} does not import skfem. {VENV}", folder.display());
    }
    Ok(python)
}

fn run(command: &mut Command) -> Result<()> {
    let output = command.output().with_context(|| format!("cannot start Python. {VENV}"))?;
    if !output.status.success() {
        let reason = String::from_utf8_lossy(&output.stderr).trim().to_string();
        let reason = if reason.is_empty() {
            String::from_utf8_lossy(&output.stdout).trim().to_string()
        } else {
            reason
        };
        bail!("{reason}\n{VENV}");
    }
    Ok(())
}
