"""Solves a job with scikit-fem: python -m mtled_reference.adapters.scikit_fem JOB ANSWER

Boxes get even meshes of hexahedra of order 2 without symmetry, other cases those of the stored
references.
"""

import skfem

from ..scikit_fem.factorisation import Factorisation
from ..scikit_fem.hexahedra import box_block
from ..scikit_fem.mesh import mesh_of_blocks
from ..scikit_fem.model import Model
from ..scikit_fem.newton import solve_static
from ..scikit_fem.record import Recorder
from ..shared.case import Case
from ..shared.errors import NotConverged
from ..solve import solver
from .cases import counts, is_even, read, reference_level
from .files import Refused, answer, from_values

RESIDUAL = 1e-6
"""Of Newton's method, over the internal forces [–]."""
LOAD_STEPS = 4


def solve(job: dict) -> dict:
    """The answer to a job."""
    case = read(job)
    try:
        return _even(case, job) if is_even(case) else _stored(case, job)
    except (NotConverged, FloatingPointError) as error:
        raise Refused(str(error), "not_converged") from None


def _even(case: Case, job: dict) -> dict:
    low, high, numbers = counts(case, job["spacing_m"], 2)
    model = Model(case, mesh_of_blocks([box_block(low, high, numbers)]), [])
    factors = Factorisation()
    solved = solve_static(model, LOAD_STEPS, _silent, factors, residual=RESIDUAL)
    recorder = Recorder(model)
    recorder.record(solved.displacements, solved.reactions, solved.strain_energy)
    element = "Q2/P1 three fields" if model.is_mixed else "Q2"
    method = f"even hexahedra {element}, {factors.name}"
    return from_values(recorder.measurements.values, int(model.free.sum()), method)


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
    answer("scikit-fem", lambda: skfem.__version__, solve)
