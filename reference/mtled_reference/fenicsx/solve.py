"""Solves a case with FEniCSx on one mesh."""

from ..shared.case import Case
from ..shared.materials import THREE_FIELDS
from ..shared.measurements import recorded_times
from . import dynamics, newton, versions
from .conditions import Conditions
from .dynamics import Midpoint, solve_dynamic
from .model import Model, Recipe
from .newton import Newton, solve_static
from .recipes import recipe
from .record import Recorder


def solve_mesh(case: Case, level: int, progress) -> dict:
    """The result on the mesh of a level, as described in mtled_reference/solve.py."""
    progress(0.0, "mesh and forms")
    chosen = recipe(case, level)
    model = Model(case, chosen)
    conditions, solver = Conditions(model), Newton(model)
    recorder = Recorder(model, conditions)
    times = recorded_times(case)
    if case.is_static:
        steps = chosen.load_steps
        reactions = solve_static(model, conditions, solver, steps, progress)
        recorder.record(times[-1], reactions)
    else:
        midpoint = Midpoint(model, conditions, solver, chosen.time_step)
        steps = solve_dynamic(midpoint, recorder, times, progress)
    mesh = {
        "size_m": round(chosen.size, 9),
        "elements": len(chosen.cells),
        "unknowns": len(model.unknown.x.array),
        "load_steps": steps,
        "newton_iterations": solver.iterations,
        "values": recorder.measurements.values,
    }
    if not case.is_static:
        mesh["time_step_s"] = chosen.time_step
    return {"solution": _description(case, model, chosen), "times_s": times, "mesh": mesh}


def _description(case: Case, model: Model, chosen: Recipe) -> dict:
    """Version, formulation, element and solver."""
    residual = (newton if case.is_static else dynamics).RESIDUAL
    simplex = chosen.cell in ("triangle", "tetrahedron")
    letter = "P2" if simplex else "Q2"
    about = {
        "version": versions.version(),
        "formulation": THREE_FIELDS if model.three_fields else "displacement",
        "element": f"{letter} / P1 discontinuous" if model.three_fields else letter,
        "mesh_family": chosen.family,
        "solver": f"Newton, residual {residual:.0e} of the forces, MUMPS",
        "packages": versions.packages(),
    }
    if not case.is_static:
        about["time_scheme"] = "implicit midpoint rule, consistent mass"
    return about
