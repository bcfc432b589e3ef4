"""Newton's method with conditions on places of the unknown; MUMPS solves."""

import numpy as np
from petsc4py import PETSc

from . import fenicsx_versions as versions

RESIDUAL = 1e-10
"""Largest norm of the free residual, relative to the forces that act."""
CORRECTION = 1e-7
"""Largest last correction, relative to the largest unknown; the one after it would
be of the order of its square."""
ITERATIONS = 25
HALVINGS = 6


class NotConverged(RuntimeError):
    """Newton's method did not converge."""


class Newton:
    """Solves residual(w) + extra(w) = load with w prescribed at some places."""

    def __init__(self, model, residual: float = RESIDUAL, correction: float = CORRECTION):
        self.model, self.residual, self.correction = model, residual, correction
        self.matrix = versions.new_matrix(model.jacobian_form)
        self.rhs = self.matrix.createVecRight()
        self.step = self.rhs.duplicate()
        self.iterations = 0
        self.solver = PETSc.KSP().create(PETSc.COMM_SELF)
        self.solver.setType("preonly")
        self.solver.setOperators(self.matrix)
        factorisation = self.solver.getPC()
        factorisation.setType("lu" if model.three_fields else "cholesky")
        factorisation.setFactorSolverType("mumps")

    def internal_forces(self) -> np.ndarray:
        """The derivative of the energy."""
        return versions.assemble_vector(self.model.residual_form)

    def load(self, forces: np.ndarray) -> np.ndarray:
        """Nodal forces (nodes, components) [N] in the places of the unknown."""
        full = np.zeros(len(self.model.unknown.x.array))
        full[self.model.fields] = forces
        return full

    def solve(self, places, values, forces) -> np.ndarray:
        """Equilibrium with the values at the places; returns the residual, which is
        the reaction at the places (nodes, components) [N]."""
        unknown, load = self.model.unknown.x.array, self.load(forces)
        free = np.ones(len(unknown), dtype=bool)
        free[places] = False
        correction = np.inf
        residual = self.internal_forces() - load
        for _ in range(ITERATIONS):
            error = np.linalg.norm(residual[free])
            scale = max(np.linalg.norm(residual[~free]), np.linalg.norm(load))
            held = np.abs(unknown[places] - values).max(initial=0.0)
            largest = np.abs(unknown[self.model.fields]).max()
            if held <= 1e-12 * largest and error <= self.residual * scale:
                if correction <= self.correction * largest:
                    return residual[self.model.fields]
            self._factorise(places, values - unknown[places], -residual)
            self.solver.solve(self.rhs, self.step)
            self._assert_solved()
            residual, share = self._advance(load)
            correction = share * np.abs(self.step.array[self.model.fields]).max()
            self.iterations += 1
        raise NotConverged(f"residual {error:.1e} of {scale:.1e} after {ITERATIONS} iterations")

    def _advance(self, load) -> tuple[np.ndarray, float]:
        """Adds the step, or a part of it where the whole would turn a cell inside out
        (the energy is then undefined); returns the residual and the part."""
        unknown = self.model.unknown.x.array
        start, share = unknown.copy(), 1.0
        for _ in range(HALVINGS):
            unknown[:] = start + share * self.step.array
            residual = self.internal_forces() - load
            if np.all(np.isfinite(residual)):
                return residual, share
            share *= 0.5
        raise NotConverged("the residual is not finite")

    def _factorise(self, places, increments, rhs) -> None:
        versions.assemble_matrix(self.matrix, self.model.jacobian_form)
        self.rhs.array[:] = rhs
        self.step.set(0.0)
        self.step.array[places] = increments
        self.matrix.zeroRowsColumns(places, 1.0, self.step, self.rhs)
        self.solver.setUp()

    def _assert_solved(self) -> None:
        if self.solver.getConvergedReason() < 0:
            raise NotConverged("the linear solver failed")


def solve_static(model, conditions, newton, steps: int, progress) -> np.ndarray:
    """Loads the body in equal steps; returns the reactions (nodes, components) [N]."""
    t = model.case.time.load_end
    for n in range(steps):
        share = (n + 1) / steps
        places, values = conditions.prescribed(t, share)
        reactions = newton.solve(places, values, conditions.external_forces(t, share))
        progress(share, f"load step {n + 1} of {steps}")
    return reactions
