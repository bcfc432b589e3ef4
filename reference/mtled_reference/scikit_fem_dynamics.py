"""Motion by the trapezoidal rule with the consistent mass (Newmark, β = 1/4, γ = 1/2)."""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sparse

from .measure import Measurements, recorded_times
from .scikit_fem_measure import Observer
from .scikit_fem_model import Model
from .scikit_fem_newton import Factorisation, NotConverged

RESIDUAL = 1e-8
"""A step has converged at this residual over the forces at work [–]."""

MAX_ITERATIONS = 25
SLOW = 0.15
"""The matrix is renewed where an iteration reduces the residual by less [–]."""


def solve_dynamic(
    model: Model,
    observer: Observer,
    values: Measurements,
    steps: int,
    progress: Callable[[float, str], None],
    factors: Factorisation,
) -> int:
    """Motion from rest at t = 0; records the values and returns Newton iterations."""
    motion = _Motion(model, model.case.time.end / steps, factors)
    times = recorded_times(model.case)
    every = steps // len(times)
    if every * len(times) != steps:
        raise ValueError("the time steps do not fall on the recorded times")
    for step in range(1, steps + 1):
        motion.advance(step * motion.dt)
        if step % every == 0:
            observer.record(values, motion.u, motion.reactions, motion.strain_energy)
            kinetic = 0.5 * float(np.sum(motion.v * (motion.mass @ motion.v)))
            values.kinetic_energy(kinetic * observer.images)
            progress(step / steps, f"time step {step} of {steps}")
    return motion.iterations


class _Motion:
    """Displacements, velocities and accelerations (n, d), step by step."""

    def __init__(self, model: Model, dt: float, factors: Factorisation):
        self.model, self.dt, self.factors = model, dt, factors
        self.mass = model.mass
        self.damping = model.case.time.damping
        self.iterations = 0
        self.u = model.prescribed(lambda amplitude: amplitude(0.0))
        self.v = np.zeros_like(self.u)
        self.a = self._initial_acceleration()
        self.scale = 4.0 / dt**2 + 2.0 * self.damping / dt
        """Of the mass in the matrix of a step [1/s²]."""
        self.upper_mass = self._upper_mass()
        self.renewed = False

    def _initial_acceleration(self) -> np.ndarray:
        """a from M a = f − F(u) at t = 0, nothing where displacements are prescribed."""
        _, internal = self.model.internal(self.u)
        force = self.model.loads(lambda amplitude: amplitude(0.0)) - internal
        a = np.zeros_like(force)
        for component in range(self.model.d):
            free = ~self.model.fixed[:, component]
            matrix = self.mass[free][:, free].tocsc()
            a[free, component] = sparse.linalg.spsolve(matrix, force[free, component])
        return a

    def _upper_mass(self) -> sparse.csr_matrix:
        full = sparse.kron(self.mass, sparse.identity(self.model.d), format="csr")
        return sparse.triu(full[self.model.free][:, self.model.free], format="csr")

    def advance(self, t: float) -> None:
        """One step to time t [s]; Newton with a matrix that is kept while it serves."""
        model, dt = self.model, self.dt
        loads = model.loads(lambda amplitude: amplitude(t))
        prescribed = model.prescribed(lambda amplitude: amplitude(t))
        u = np.where(model.fixed, prescribed, self.u + dt * self.v + 0.25 * dt**2 * self.a)
        previous = np.inf
        for _ in range(MAX_ITERATIONS):
            a = 4.0 / dt**2 * (u - self.u - dt * self.v) - self.a
            v = self.v + 0.5 * dt * (self.a + a)
            energy, internal = model.internal(u)
            inertia = self.mass @ (a + self.damping * v)
            balance = internal + inertia - loads
            residual = balance.ravel()[model.free]
            norm = float(np.linalg.norm(residual))
            size = max(np.linalg.norm(internal), np.linalg.norm(loads), np.linalg.norm(inertia))
            if norm <= RESIDUAL * size:
                self.u, self.v, self.a = u, v, a
                self.reactions, self.strain_energy = balance, energy
                return
            if not self.renewed or norm > SLOW * previous:
                tangent = model.internal(u, True)[2]
                self.factors.factorise((tangent + self.scale * self.upper_mass).tocsr())
                self.renewed = True
            previous = norm
            change = np.zeros(u.size)
            change[model.free] = -self.factors.solve(residual)
            u = u + change.reshape(u.shape)
            self.iterations += 1
        raise NotConverged(f"no convergence at t = {t:.6g} s")
