"""Newton's method with prescribed unknowns; MUMPS solves the linear systems."""

import numpy as np
from petsc4py import PETSc

from ..shared.errors import NotConverged
from . import versions

RESIDUAL = 1e-10
"""Largest norm of the residual at free unknowns over that of the acting forces [–]."""
CORRECTION = 1e-7
"""Largest last correction over the largest displacement [–]; the next correction would
be of the order of its square."""
ITERATIONS = 25
HALVINGS = 6


def direct_solver(matrix: PETSc.Mat, factorisation: str) -> PETSc.KSP:
    """A direct solver by MUMPS: `lu`, or `cholesky` of a symmetric matrix."""
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setType("preonly")
    solver.setOperators(matrix)
    solver.getPC().setType(factorisation)
    solver.getPC().setFactorSolverType("mumps")
    return solver


class Factors:
    """Factors of a matrix (CSR of SciPy): `lu`, or `cholesky` of a symmetric one, which need
    not be definite."""

    def __init__(self, matrix, factorisation: str):
        matrix.sort_indices()
        self.matrix = PETSc.Mat().createAIJ(
            matrix.shape, csr=(matrix.indptr, matrix.indices, matrix.data), comm=PETSc.COMM_SELF
        )
        self.matrix.setOption(PETSc.Mat.Option.SYMMETRIC, factorisation == "cholesky")
        self.solver = direct_solver(self.matrix, factorisation)
        self.solver.setUp()

    def solve(self, right: np.ndarray) -> np.ndarray:
        """The solution for a right-hand side (n,)."""
        b, x = self.matrix.createVecs()
        b.array[:] = right
        self.solver.solve(b, x)
        if self.solver.getConvergedReason() < 0:
            raise NotConverged("the linear solver failed")
        answer = x.array.copy()
        b.destroy()
        x.destroy()
        return answer

    def release(self) -> None:
        """Frees the memory of the factors."""
        self.solver.destroy()
        self.matrix.destroy()


class Newton:
    """Equilibrium of internal forces and loads with some unknowns prescribed."""

    def __init__(self, model, residual: float = RESIDUAL, correction: float = CORRECTION):
        self.model, self.residual, self.correction = model, residual, correction
        self.matrix = versions.new_matrix(model.jacobian_form)
        self.rhs = self.matrix.createVecRight()
        self.step = self.rhs.duplicate()
        self.iterations = 0
        self.solver = direct_solver(self.matrix, "lu" if model.three_fields else "cholesky")

    def internal_forces(self) -> np.ndarray:
        """The derivative of the energy with respect to the unknowns."""
        return versions.assemble_vector(self.model.residual_form)

    def load(self, forces: np.ndarray) -> np.ndarray:
        """Nodal forces (nodes, components) [N] in the order of the unknowns."""
        full = np.zeros(len(self.model.unknown.x.array))
        full[self.model.fields] = forces
        return full

    def solve(self, fixed, values, forces) -> np.ndarray:
        """Equilibrium with the unknowns `fixed` at their values; returns the residual
        (nodes, components) [N], which is the reaction there."""
        unknown, load = self.model.unknown.x.array, self.load(forces)
        free = np.ones(len(unknown), dtype=bool)
        free[fixed] = False
        correction = np.inf
        residual = self.internal_forces() - load
        for _ in range(ITERATIONS):
            error = np.linalg.norm(residual[free])
            scale = max(np.linalg.norm(residual[~free]), np.linalg.norm(load))
            violation = np.abs(unknown[fixed] - values).max(initial=0.0)
            largest = np.abs(unknown[self.model.fields]).max()
            if violation <= 1e-12 * largest and error <= self.residual * scale:
                if correction <= self.correction * largest:
                    return residual[self.model.fields]
            self._factorise(fixed, values - unknown[fixed], -residual)
            self.solver.solve(self.rhs, self.step)
            self._assert_solved()
            residual, fraction = self._advance(load)
            correction = fraction * np.abs(self.step.array[self.model.fields]).max()
            self.iterations += 1
        raise NotConverged(f"residual {error:.1e} of {scale:.1e} after {ITERATIONS} iterations")

    def _advance(self, load) -> tuple[np.ndarray, float]:
        """Adds the step, halved while it would invert a cell (the energy is undefined
        there); returns the residual and the fraction of the step that was taken."""
        unknown = self.model.unknown.x.array
        start, fraction = unknown.copy(), 1.0
        for _ in range(HALVINGS):
            unknown[:] = start + fraction * self.step.array
            residual = self.internal_forces() - load
            if np.all(np.isfinite(residual)):
                return residual, fraction
            fraction *= 0.5
        raise NotConverged("the residual is not finite")

    def _factorise(self, fixed, increments, rhs) -> None:
        versions.assemble_matrix(self.matrix, self.model.jacobian_form)
        self.rhs.array[:] = rhs
        self.step.set(0.0)
        self.step.array[fixed] = increments
        self.matrix.zeroRowsColumns(fixed, 1.0, self.step, self.rhs)
        self.solver.setUp()

    def _assert_solved(self) -> None:
        if self.solver.getConvergedReason() < 0:
            raise NotConverged("the linear solver failed")


def solve_static(model, conditions, newton, steps: int, progress) -> np.ndarray:
    """Loads the body in equal steps; returns the reactions (nodes, components) [N]."""
    t = model.case.time.load_end
    for n in range(steps):
        fraction = (n + 1) / steps
        model.load_pressures(t, fraction)
        fixed, values = conditions.prescribed(t, fraction)
        forces = conditions.external_forces(t, fraction)
        reactions = newton.solve(fixed, values, forces)
        progress(fraction, f"load step {n + 1} of {steps}")
    return reactions
