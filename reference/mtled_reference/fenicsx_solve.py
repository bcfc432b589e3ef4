"""A case solved with FEniCSx (DOLFINx) on one of its meshes."""

from . import fenicsx_dynamics, fenicsx_newton
from . import fenicsx_versions as versions
from .case import Case
from .fenicsx_conditions import Conditions
from .fenicsx_dynamics import Midpoint, solve_dynamic
from .fenicsx_model import Model, Recipe
from .fenicsx_newton import Newton, solve_static
from .fenicsx_recipes import recipe
from .fenicsx_record import Recorder
from .measure import recorded_times


def solve_mesh(case: Case, level: int, progress) -> dict:
    """The solution on the mesh of the level, as solve.py asks for it."""
    progress(0.0, "mesh and forms")
    chosen = recipe(case, level)
    model = Model(case, chosen)
    conditions, newton = Conditions(model), Newton(model)
    recorder = Recorder(model, conditions)
    times = recorded_times(case)
    if case.is_static:
        steps = chosen.load_steps
        reactions = solve_static(model, conditions, newton, steps, progress)
        recorder.record(times[-1], reactions)
    else:
        midpoint = Midpoint(model, conditions, newton, chosen.time_step)
        steps = solve_dynamic(case, midpoint, recorder, times, progress)
    mesh = {
        "size_m": round(chosen.size, 9),
        "elements": len(chosen.cells),
        "unknowns": len(model.unknown.x.array),
        "load_steps": steps,
        "newton_iterations": newton.iterations,
        "values": recorder.measurements.values,
    }
    if not case.is_static:
        mesh["time_step_s"] = chosen.time_step
    return {"solution": _description(case, model, chosen), "times_s": times, "mesh": mesh}


def _description(case: Case, model: Model, chosen: Recipe) -> dict:
    """Version, formulation, element and solver."""
    three = "three fields u, p, θ: ψ((θ/J)^(1/3) F) + p(J − θ)"
    residual = (fenicsx_newton if case.is_static else fenicsx_dynamics).RESIDUAL
    simplex = chosen.cell in ("triangle", "tetrahedron")
    letter = "P2" if simplex else "Q2"
    about = {
        "version": versions.version(),
        "formulation": three if model.three_fields else "displacement",
        "element": f"{letter} / P1 discontinuous" if model.three_fields else letter,
        "mesh_family": chosen.family,
        "solver": f"Newton, residual {residual:.0e} of the forces, MUMPS",
        "packages": versions.packages(),
    }
    if not case.is_static:
        about["time_scheme"] = "implicit midpoint rule, consistent mass"
    return about
