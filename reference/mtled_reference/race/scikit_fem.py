"""A run of the race with scikit-fem."""

import numpy as np
import skfem

from ..scikit_fem.factorisation import Factorisation
from ..scikit_fem.model import Model, scatter
from ..scikit_fem.newton import solve_static
from ..scikit_fem.probes import located
from ..shared.selection import bounding_box
from .problems import Problem
from .run import RESIDUAL, Clock, Run

ELEMENTS = {
    "Q1": (1, False),
    "Q2": (2, False),
    "Q1/P0": (1, True),
    "Q2/P1": (2, True),
}
"""Degree of u, and whether p and θ are independent fields."""


class RaceModel(Model):
    """A model with a manufactured body force."""

    def __init__(self, problem: Problem, mesh: skfem.Mesh, degree: int, three_fields: bool):
        self.solution = problem.solution
        super().__init__(problem.case, mesh, [], degree, three_fields)

    def loads(self, factor_of) -> np.ndarray:
        forces = super().loads(factor_of)
        if self.solution is None:
            return forces
        basis = self.basis
        points = np.asarray(basis.global_coordinates())
        b = self.solution.body_force(points.reshape(3, -1).T).reshape(*points.shape[1:], 3)
        masses = self.solution.material.density * basis.dx
        shapes = np.stack([np.broadcast_to(shape[0], basis.dx.shape) for shape in basis.basis])
        contributions = np.einsum("aeq,eq,eqk->eak", shapes, masses, b, optimize=True)
        scatter(forces, basis.element_dofs.T, contributions)
        return forces


def run(problem: Problem, element: str, cells: int, steps: int, clock: Clock) -> Run:
    """As described in run.py."""
    degree, three_fields = ELEMENTS[element]
    low, high = bounding_box(problem.case.shape)
    axes = [np.linspace(low[k], high[k], cells + 1) for k in range(3)]
    model = RaceModel(problem, skfem.MeshHex.init_tensor(*axes), degree, three_fields)
    factors = Factorisation()
    solved = solve_static(
        model,
        steps,
        lambda *_: None,
        factors,
        residual=RESIDUAL,
        smallest_step=1.0 / steps,
    )
    clock.stop()
    nodes, shapes = located(model, problem.lattice)
    return Run(
        skfem.__version__,
        f"Newton, residual {RESIDUAL:g} of the internal forces, {factors.name}",
        int(model.free.sum()),
        int(model.mesh.nelements),
        solved.newton_iterations,
        np.einsum("pa,pad->pd", shapes, solved.displacements[nodes]),
    )
