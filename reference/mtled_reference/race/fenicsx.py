"""A run of the race with FEniCSx."""

import basix
import numpy as np
import ufl
from dolfinx import fem

from ..fenicsx import versions
from ..fenicsx.conditions import Conditions
from ..fenicsx.mesh_blocks import mesh_of_blocks
from ..fenicsx.mesh_shapes import box
from ..fenicsx.model import Model, Recipe
from ..fenicsx.newton import Newton, solve_static
from ..fenicsx.probes import Locator, PointValues
from ..shared.selection import bounding_box
from .problems import Problem
from .run import RESIDUAL, Clock, Run

ELEMENTS = {
    "P1": ("tetrahedron", 1, False, 1),
    "P2": ("tetrahedron", 2, False, 3),
    "Q1": ("hexahedron", 1, False, 3),
    "Q2": ("hexahedron", 2, False, 4),
    "Q1/P0": ("hexahedron", 1, True, 3),
    "Q2/P1": ("hexahedron", 2, True, 4),
}
"""Cell, degree of u, whether p and θ are unknown fields, degree of quadrature."""

OPTIMISED = ("-O3", "-march=native", "-ffast-math")
"""Flags for the compiler of the kernels."""


def run(problem: Problem, element: str, cells: int, steps: int, clock: Clock) -> Run:
    """As described in run.py."""
    cell, degree, three_fields, quadrature = ELEMENTS[element]
    case = problem.case
    before = versions.compile_seconds()
    low, high = bounding_box(case.shape)
    points, numbers = mesh_of_blocks(box(low, high, (cells,) * 3), cell)
    recipe = Recipe(
        cell,
        1,
        *_straight(cell, points, numbers),
        (high[0] - low[0]) / cells,
        "uniform",
        degree=degree,
        three_fields=three_fields,
        quadrature_degree=quadrature,
        compiler_flags=OPTIMISED,
    )
    model = Model(case, recipe)
    conditions = Conditions(model)
    force = _body_force(model, problem, quadrature)
    newton = Newton(model, residual=RESIDUAL, correction=np.inf)
    solve_static(model, conditions, newton, steps, lambda *_: None, force)
    clock.apart += versions.compile_seconds() - before
    clock.stop()
    return Run(
        versions.version(),
        f"Newton, residual {RESIDUAL:g} of the forces, MUMPS",
        len(model.unknown.x.array),
        len(numbers),
        newton.iterations,
        _displacements(model, problem.lattice),
    )


def _straight(cell: str, points, numbers):
    """The corners of a mesh of order 2, as a mesh of order 1."""
    corners = len(basix.geometry(getattr(basix.CellType, cell)))
    used, numbers = np.unique(numbers[:, :corners], return_inverse=True)
    return points[used], np.reshape(numbers, (-1, corners))


def _body_force(model: Model, problem: Problem, degree: int) -> np.ndarray:
    """Nodal forces (nodes, 3) [N] of the manufactured body force, which is interpolated
    with an element of one degree more than u."""
    if problem.solution is None:
        return np.zeros(model.fields.shape)
    order = model.recipe.degree + 1
    element = versions.vector_element(model.recipe.cell, order, 3)
    space = versions.function_space(model.domain, element)
    density = fem.Function(space)
    density.interpolate(lambda X: problem.solution.body_force(X.T).T)
    dx = ufl.Measure("dx", model.domain, metadata={"quadrature_degree": degree + 1})
    rho = problem.solution.material.density
    v = ufl.TestFunction(model.u_space)
    form = versions.form(rho * ufl.inner(density, v) * dx, OPTIMISED)
    return versions.assemble_vector(form).reshape(-1, 3)


def _displacements(model: Model, positions: np.ndarray) -> np.ndarray:
    """Displacements (n, 3) [m] at positions (n, 3) [m]."""
    u = fem.Function(model.u_space)
    u.x.array[:] = model.u().ravel()
    return PointValues(model, Locator(model), positions).displacements(u, [])
