"""A case solved with scikit-fem on one mesh."""

import platform

import numpy as np
import scipy
import skfem

from .case import Case
from .hexahedra_cases import CaseMesh, case_mesh
from .measure import Measurements, recorded_times
from .scikit_fem_dynamics import solve_dynamic
from .scikit_fem_measure import Observer
from .scikit_fem_mesh import carried_over, mesh_of_blocks
from .scikit_fem_model import Model
from .scikit_fem_newton import RESIDUAL, Factorisation, StaticSolution, solve_static


def solve_mesh(case: Case, level: int, progress) -> dict:
    """The values of a case on mesh `level`, as solve.py describes."""
    division = case_mesh(case, level)
    model, factors, values = _model(case, division), Factorisation(), Measurements()
    observer = Observer(model)
    observer.record_centres(values)
    mesh = {
        "size_m": division.size,
        "elements": int(model.mesh.nelements),
        "unknowns": int(model.free.sum()),
    }
    solution = _description(model, division, factors)
    if case.is_static:
        solved = _static(case, level, model, factors, progress)
        observer.record(values, solved.displacements, solved.reactions, solved.strain_energy)
        mesh |= {"load_steps": solved.load_steps, "newton_iterations": solved.newton_iterations}
    else:
        motion = solve_dynamic(model, observer, values, division.time_steps, progress, factors)
        solution["time_scheme"] = "trapezoidal rule, consistent mass"
        mesh |= {
            "time_step_s": case.time.end / division.time_steps,
            "load_steps": division.time_steps,
            "newton_iterations": motion,
        }
    mesh["values"] = values.values
    return {"solution": solution, "times_s": recorded_times(case), "mesh": mesh}


def _model(case: Case, division: CaseMesh) -> Model:
    return Model(case, mesh_of_blocks(division.blocks), division.symmetry)


def _static(
    case: Case, level: int, model: Model, factors: Factorisation, progress
) -> StaticSolution:
    """The solution at a level; above level 0 it starts from that of the level below."""
    division, guess = case_mesh(case, level), None
    if level > 0 and division.from_coarser:
        below = case_mesh(case, level - 1)
        coarse = _model(case, below)

        def early(fraction: float, message: str) -> None:
            progress(0.3 * fraction, f"mesh {level - 1}, to start from: {message}")

        solved = _static(case, level - 1, coarse, Factorisation(), early)
        guess = carried_over(
            below.blocks, division.blocks, (coarse.basis, model.basis), solved.displacements
        )

    def late(fraction: float, message: str) -> None:
        progress(fraction if guess is None else 0.3 + 0.7 * fraction, message)

    return solve_static(model, division.load_steps, late, factors, guess)


def _description(model: Model, division: CaseMesh, factors: Factorisation) -> dict:
    """What was solved how."""
    shape = {2: "quadrilaterals", 3: "hexahedra"}[model.d]
    planes = ", ".join(f"{'xyz'[axis]} = {value:g} m" for axis, value in model.symmetry)
    family = division.family + (f"; mirror symmetry about {planes}" if planes else "")
    mixed = model.is_mixed
    fields = "three fields u, p, θ: ψ((θ/J)^(1/3) F) + p(J − θ)" if mixed else "displacement"
    return {
        "version": skfem.__version__,
        "formulation": fields,
        "element": f"Q2 {shape}" + (" / P1 discontinuous" if mixed else ""),
        "mesh_family": family,
        "solver": f"Newton, residual {RESIDUAL:g} of the internal forces, {factors.name}",
        "packages": {
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
            "scikit-fem": skfem.__version__,
        },
    }
