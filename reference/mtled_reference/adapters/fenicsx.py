"""Solves a job with FEniCSx: python -m mtled_reference.adapters.fenicsx JOB ANSWER

Boxes get even meshes of hexahedra of order 2 without symmetry, other cases those of the stored
references.
"""

import numpy as np

from ..fenicsx import versions
from ..fenicsx.conditions import Conditions
from ..fenicsx.mesh_blocks import mesh_of_blocks
from ..fenicsx.mesh_shapes import box
from ..fenicsx.model import Model, Recipe
from ..fenicsx.newton import Newton, solve_static
from ..fenicsx.record import Recorder
from ..shared.case import Case
from ..shared.errors import NotConverged
from ..solve import solver
from .cases import counts, is_even, read, reference_level
from .files import Refused, answer, from_values

RESIDUAL = 1e-6
"""Of Newton's method, over the forces [–]."""
LOAD_STEPS = (4, 16)
"""Numbers of load steps, tried in turn."""


def solve(job: dict) -> dict:
    """The answer to a job."""
    case = read(job)
    try:
        return _even(case, job) if is_even(case) else _stored(case, job)
    except (NotConverged, FloatingPointError) as error:
        raise Refused(str(error), "not_converged") from None


def _even(case: Case, job: dict) -> dict:
    low, high, numbers = counts(case, job["spacing_m"], 2)
    points, cells = mesh_of_blocks(box(low, high, numbers), "hexahedron")
    size = float((high[0] - low[0]) / numbers[0])
    for steps in LOAD_STEPS:
        model = Model(case, Recipe("hexahedron", 2, points, cells, size, "even"))
        conditions = Conditions(model)
        newton = Newton(model, residual=RESIDUAL, correction=np.inf)
        try:
            reactions = solve_static(model, conditions, newton, steps, _silent)
            break
        except NotConverged:
            if steps == LOAD_STEPS[-1]:
                raise
    recorder = Recorder(model, conditions)
    recorder.record(case.time.load_end, reactions)
    element = "Q2/P1 three fields" if model.three_fields else "Q2"
    unknowns = len(model.unknown.x.array)
    return from_values(recorder.measurements.values, unknowns, f"even hexahedra {element}, MUMPS")


def _stored(case: Case, job: dict) -> dict:
    try:
        solved = solver("fenicsx", case.name)(case, reference_level(job), _silent)
    except ValueError as error:
        raise Refused(str(error)) from None
    except ImportError as error:
        raise Refused(f"{error.name} is not installed") from None
    mesh, about = solved["mesh"], solved["solution"]
    method = f"{about['element']}, the meshes of the stored reference"
    return from_values(mesh["values"], mesh["unknowns"], method)


def _silent(fraction: float, message: str) -> None:
    """No progress is shown."""


if __name__ == "__main__":
    answer("FEniCSx", versions.version, solve)
