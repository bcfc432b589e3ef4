//! Pythons that can run the finite-element codes.

use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// How to get FEniCSx, told where it is not found.
const FENICSX: &str =
    "no Python that imports dolfinx was found. Install FEniCSx in one of these ways:
  Debian, Ubuntu:  apt-get install python3-dolfinx-real libopenblas0-serial
  conda-forge:     conda create -n fenicsx -c conda-forge fenics-dolfinx && conda activate fenicsx
  container:       docker run -ti -v \"$PWD\":/work -w /work dolfinx/dolfinx:stable";

/// How to get what a virtual environment needs.
const VENV: &str = "Install Python 3.11 or newer with venv (Debian: apt-get install python3-venv) and let pip reach a package index";

/// An interpreter with its flags.
#[derive(Debug, Clone)]
pub struct Python {
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
    pub fn module(&self, reference: &Path) -> Command {
        let mut command = self.command();
        command.args(["-m", "mtled_reference"]).env("PYTHONPATH", reference);
        command
    }

    /// Program and flags.
    pub fn words(&self) -> Vec<String> {
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

/// The Python that runs `code`; an error tells what to install.
pub fn python_for(code: &str, reference: &Path, say: &dyn Fn(&str)) -> Result<Python> {
    match code {
        "fenicsx" => fenicsx(),
        _ => scikit_fem(reference, say),
    }
}

/// The Python that runs `code` as things are; nothing is installed.
pub fn installed(code: &str, reference: &Path) -> Option<Python> {
    match code {
        "fenicsx" => fenicsx().ok(),
        _ => Some(virtual_environment(reference)).filter(|python| python.imports("skfem")),
    }
}

fn virtual_environment(reference: &Path) -> Python {
    let program = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };
    Python { program: reference.join(".venv").join(program), flags: &[] }
}

/// Debian's own first: `-s` keeps packages of the user out, which break petsc4py.
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

/// The virtual environment `reference/.venv`, made where it is missing.
fn scikit_fem(reference: &Path, say: &dyn Fn(&str)) -> Result<Python> {
    let folder = reference.join(".venv");
    let python = virtual_environment(reference);
    if python.imports("skfem") {
        return Ok(python);
    }
    say("making reference/.venv with scikit-fem");
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
