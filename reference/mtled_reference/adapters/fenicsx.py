"""Solves a job with FEniCSx: python -m mtled_reference.adapters.fenicsx JOB ANSWER

Boxes get even meshes of hexahedra of order 2 without symmetry, other cases those of the stored
references. With --element a box, or a quarter of a ring in plane strain, is solved as in a race,
with this element.
"""

from dataclasses import replace

import basix
import numpy as np

from ..fenicsx import versions
from ..fenicsx.conditions import Conditions
from ..fenicsx.kinematics import PlaneStrain
from ..fenicsx.mesh_blocks import mesh_of_blocks
from ..fenicsx.mesh_shapes import box
from ..fenicsx.model import Model, Recipe
from ..fenicsx.newton import Newton, solve_static
from ..fenicsx.recipes import quarter_ring
from ..fenicsx.record import Recorder
from ..shared.case import Case
from ..shared.errors import NotConverged
from ..solve import solver
from .cases import counts, counts_of_ring, is_even, read, reference_level
from .files import Quick, Refused, answer, from_values

RESIDUAL = 1e-6
"""Of Newton's method, over the forces [–]."""
LOAD_STEPS = (4, 16)
"""Numbers of load steps, tried in turn."""
ELEMENTS = {
    "P1": ("tetrahedron", 1, False, 1),
    "P2": ("tetrahedron", 2, False, 3),
    "Q1": ("hexahedron", 1, False, 3),
    "Q2": ("hexahedron", 2, False, 4),
    "Q1/P0": ("hexahedron", 1, True, 3),
    "Q2/P1": ("hexahedron", 2, True, 4),
}
"""Cell, degree of u, whether p and θ are unknown fields, degree of quadrature."""
PLANE_CELLS = {"tetrahedron": "triangle", "hexahedron": "quadrilateral"}
OPTIMISED = ("-O3", "-march=native", "-ffast-math")
"""Flags for the compiler of the kernels in a race."""


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


def _quick(case: Case, job: dict, element: str) -> dict:
    cell, degree, three_fields, quadrature = ELEMENTS[element]
    meshed = _box if is_even(case) else _ring

    def attempt(parts: int):
        recipe = meshed(case, job["spacing_m"], cell, degree)
        effort = {"quadrature_degree": quadrature, "compiler_flags": OPTIMISED}
        fields = {"degree": degree, "three_fields": three_fields}
        model = Model(case, replace(recipe, **fields, **effort))
        conditions = Conditions(model)
        newton = Newton(model, residual=Quick.RESIDUAL, correction=np.inf)
        return model, conditions, solve_static(model, conditions, newton, parts, _silent)

    quick = Quick((NotConverged, RuntimeError, FloatingPointError), versions.compile_seconds)
    model, conditions, reactions = quick.solved(attempt)
    recorder = Recorder(model, conditions)
    recorder.record(case.time.load_end, reactions)
    values, unknowns = recorder.measurements.values, len(model.unknown.x.array)
    content = from_values(values, unknowns, f"even {element}, MUMPS")
    return content | {"apart_cpu_s": quick.apart_s()}


def _box(case: Case, spacing: float, cell: str, degree: int) -> Recipe:
    """An even mesh with straight edges."""
    low, high, numbers = counts(case, spacing, degree)
    points, cells = _straight(cell, *mesh_of_blocks(box(low, high, numbers), cell))
    return Recipe(cell, 1, points, cells, float((high[0] - low[0]) / numbers[0]), "even")


def _ring(case: Case, spacing: float, cell: str, degree: int) -> Recipe:
    """An even mesh of a quarter of a ring in plane strain, its edges of the order of the element."""
    radii, numbers = counts_of_ring(case, spacing, degree)
    cell = PLANE_CELLS[cell]
    points, cells = quarter_ring(radii, numbers, cell)
    if degree == 1:
        points, cells = _straight(cell, points, cells)
    kinematics = PlaneStrain(case.thickness, case.plane_z)
    size = (radii[1] - radii[0]) / numbers[0]
    return Recipe(cell, degree, points, cells, size, "even", kinematics=kinematics)


def _straight(cell: str, points, numbers):
    """The corners of a mesh of order 2, as a mesh of order 1."""
    corners = len(basix.geometry(getattr(basix.CellType, cell)))
    used, numbers = np.unique(numbers[:, :corners], return_inverse=True)
    return points[used], np.reshape(numbers, (-1, corners))


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
    answer("FEniCSx", versions.version, solve, tuple(ELEMENTS))
