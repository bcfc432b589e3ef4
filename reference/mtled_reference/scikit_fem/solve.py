"""Solves a case with scikit-fem on one mesh."""

import platform

import numpy as np
import scipy
import skfem

from ..shared.case import Case
from ..shared.materials import THREE_FIELDS
from ..shared.measurements import recorded_times
from .case_meshes import CaseMesh, case_mesh
from .dynamics import solve_dynamic
from .factorisation import Factorisation
from .mesh import interpolated, mesh_of_blocks
from .model import Model
from .newton import RESIDUAL, StaticSolution, solve_static
from .record import Recorder


def solve_mesh(case: Case, level: int, progress) -> dict:
    """The result on the mesh of a level, as described in mtled_reference/solve.py."""
    division = case_mesh(case, level)
    model, factors = _model(case, division), Factorisation()
    recorder = Recorder(model)
    mesh = {
        "size_m": division.size,
        "elements": int(model.mesh.nelements),
        "unknowns": int(model.free.sum()),
    }
    solution = _description(model, division, factors)
    if case.is_static:
        solved = _static(case, level, model, factors, progress)
        recorder.record(solved.displacements, solved.reactions, solved.strain_energy)
        mesh |= {"load_steps": solved.load_steps, "newton_iterations": solved.newton_iterations}
    else:
        steps = division.time_steps
        iterations = solve_dynamic(model, recorder, steps, progress, factors)
        solution["time_scheme"] = "trapezoidal rule, consistent mass"
        mesh |= {
            "time_step_s": case.time.end / steps,
            "load_steps": steps,
            "newton_iterations": iterations,
        }
    mesh["values"] = recorder.measurements.values
    return {"solution": solution, "times_s": recorded_times(case), "mesh": mesh}


def _model(case: Case, division: CaseMesh) -> Model:
    return Model(case, mesh_of_blocks(division.blocks), division.symmetry)


def _static(
    case: Case, level: int, model: Model, factors: Factorisation, progress
) -> StaticSolution:
    """The solution at a level; above level 0, if the case allows, it starts from that of the
    level below."""
    division, guess = case_mesh(case, level), None
    if level > 0 and division.from_coarser:
        below = case_mesh(case, level - 1)
        coarse = _model(case, below)

        def early(fraction: float, message: str) -> None:
            progress(0.3 * fraction, f"mesh {level - 1} as the start: {message}")

        solved = _static(case, level - 1, coarse, Factorisation(), early)
        guess = interpolated(
            below.blocks, division.blocks, (coarse.basis, model.basis), solved.displacements
        )

    def late(fraction: float, message: str) -> None:
        progress(fraction if guess is None else 0.3 + 0.7 * fraction, message)

    return solve_static(model, division.load_steps, late, factors, guess)


def _description(model: Model, division: CaseMesh, factors: Factorisation) -> dict:
    """Version, formulation, element and solver."""
    shape = {2: "quadrilaterals", 3: "hexahedra"}[model.d]
    planes = ", ".join(f"{'xyz'[axis]} = {value:g} m" for axis, value in model.symmetry)
    family = division.family + (f"; mirror symmetry about {planes}" if planes else "")
    mixed = model.is_mixed
    return {
        "version": skfem.__version__,
        "formulation": THREE_FIELDS if mixed else "displacement",
        "element": f"Q2 {shape}" + (" / P1 discontinuous" if mixed else ""),
        "mesh_family": family,
        "solver": f"Newton, residual {RESIDUAL:g} of the internal forces, {factors.name}",
        "packages": packages(),
    }


def packages() -> dict[str, str]:
    """Versions of Python and the packages by name."""
    return {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "scikit-fem": skfem.__version__,
    }
