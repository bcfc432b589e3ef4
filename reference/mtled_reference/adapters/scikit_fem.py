"""Solves a job with scikit-fem: python -m mtled_reference.adapters.scikit_fem JOB ANSWER

Boxes get even meshes of hexahedra of order 2 without symmetry, other cases those of the stored
references. With --element a box, or a quarter of a ring in plane strain, is solved as in a race,
with this element.
"""

import numpy as np
import skfem

from ..scikit_fem.case_meshes import quarter_ring
from ..scikit_fem.factorisation import Factorisation
from ..scikit_fem.hexahedra import box_block
from ..scikit_fem.mesh import mesh_of_blocks
from ..scikit_fem.model import Model
from ..scikit_fem.newton import StaticSolution, solve_static
from ..scikit_fem.record import Recorder
from ..shared.case import Case
from ..shared.errors import NotConverged
from ..solve import solver
from .cases import counts, counts_of_ring, is_even, read, reference_level
from .files import Quick, Refused, answer, from_values

RESIDUAL = 1e-6
"""Of Newton's method, over the internal forces [–]."""
LOAD_STEPS = 4
ELEMENTS = {
    "Q1": (1, False),
    "Q2": (2, False),
    "Q1/P0": (1, True),
    "Q2/P1": (2, True),
}
"""Degree of u, and whether p and θ are independent fields."""


def solve(job: dict, element: str | None) -> dict:
    """The answer to a job."""
    case = read(job, pressures_on_rings=True)
    if element is not None:
        return _quick(case, job, element)
    try:
        return _even(case, job) if is_even(case) else _stored(case, job)
    except (NotConverged, FloatingPointError) as error:
        raise Refused(str(error), "not_converged") from None


def _even(case: Case, job: dict) -> dict:
    low, high, numbers = counts(case, job["spacing_m"], 2)
    model = Model(case, mesh_of_blocks([box_block(low, high, numbers)]), [])
    factors = Factorisation()
    solved = solve_static(model, LOAD_STEPS, _silent, factors, residual=RESIDUAL)
    element = "Q2/P1 three fields" if model.is_mixed else "Q2"
    return _recorded(model, solved, f"even hexahedra {element}, {factors.name}")


def _recorded(model: Model, solved: StaticSolution, method: str) -> dict:
    recorder = Recorder(model)
    recorder.record(solved.displacements, solved.reactions, solved.strain_energy)
    return from_values(recorder.measurements.values, int(model.free.sum()), method)


def _quick(case: Case, job: dict, element: str) -> dict:
    degree, three_fields = ELEMENTS[element]
    meshed = _box if is_even(case) else _ring
    factors = Factorisation()

    def attempt(parts: int):
        model = Model(case, meshed(case, job["spacing_m"], degree), [], degree, three_fields)
        least, residual = 1.0 / parts, Quick.RESIDUAL
        return model, solve_static(
            model, parts, _silent, factors, residual=residual, smallest_step=least
        )

    quick = Quick((NotConverged, RuntimeError, FloatingPointError))
    model, solved = quick.solved(attempt)
    content = _recorded(model, solved, f"even {element}, {factors.name}")
    return content | {"apart_cpu_s": quick.apart_s()}


def _box(case: Case, spacing: float, degree: int) -> skfem.Mesh:
    low, high, numbers = counts(case, spacing, degree)
    axes = [np.linspace(low[k], high[k], numbers[k] + 1) for k in range(3)]
    return skfem.MeshHex.init_tensor(*axes)


def _ring(case: Case, spacing: float, degree: int) -> skfem.Mesh:
    return mesh_of_blocks([quarter_ring(*counts_of_ring(case, spacing, degree))])


def _stored(case: Case, job: dict) -> dict:
    try:
        solved = solver("scikit-fem", case.name)(case, reference_level(job), _silent)
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
    answer("scikit-fem", lambda: skfem.__version__, solve, tuple(ELEMENTS))
