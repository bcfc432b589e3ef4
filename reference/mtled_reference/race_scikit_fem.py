"""A run of the race with scikit-fem."""

import numpy as np
import skfem

from .race import RESIDUAL, Clock, Problem, Run
from .scikit_fem_measure import located
from .scikit_fem_model import Model, scatter
from .scikit_fem_newton import Factorisation, solve_static
from .selection import bounding_box

ELEMENTS = {
    "Q1": (1, False),
    "Q2": (2, False),
    "Q1/P0": (1, True),
    "Q2/P1": (2, True),
}
"""Degree of u, and whether p and θ are fields of their own."""


class RaceModel(Model):
    """A model that a manufactured body force may push."""

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
        weights = self.solution.material.density * basis.dx
        shapes = np.stack([np.broadcast_to(b_[0], basis.dx.shape) for b_ in basis.basis])
        shares = np.einsum("aeq,eq,eqk->eak", shapes, weights, b, optimize=True)
        scatter(forces, basis.element_dofs.T, shares)
        return forces


def run(problem: Problem, element: str, cells: int, steps: int, clock: Clock) -> Run:
    """As race.py says."""
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
    (lattice,) = [probe for probe in problem.case.probes if probe.name == "lattice"]
    nodes, shapes = located(model, lattice.positions)
    return Run(
        skfem.__version__,
        f"Newton, residual {RESIDUAL:g} of the internal forces, {factors.name}",
        int(model.free.sum()),
        int(model.mesh.nelements),
        solved.newton_iterations,
        np.einsum("pa,pad->pd", shapes, solved.displacements[nodes]),
    )
