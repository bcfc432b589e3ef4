"""Motion by the trapezoidal rule with the consistent mass (Newmark, β = 1/4, γ = 1/2)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from .measure import Measurements, recorded_times
from .scikit_fem_measure import Observer
from .scikit_fem_model import Model
from .scikit_fem_newton import Factorisation, NotConverged

RESIDUAL = 1e-8
"""A step has converged at this residual over the forces at work [–]."""

MAX_ITERATIONS = 25
SLOW = 0.5
"""A matrix is renewed where an iteration with it reduces the residual by less [–]."""


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
        self.has_matrix = False

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

    def _upper_mass(self) -> np.ndarray:
        """The mass in the places of the matrix of free unknowns."""
        full = sparse.kron(self.mass, sparse.identity(self.model.d), format="csr")
        full = full[self.model.free][:, self.model.free]
        pattern = self.model.pattern
        rows = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
        return np.asarray(full[rows, pattern.indices]).ravel()

    def advance(self, t: float) -> None:
        """One step to time t [s]: with the matrix of an earlier step if that serves,
        otherwise with a new one in every iteration."""
        loads = self.model.loads(lambda amplitude: amplitude(t))
        prescribed = self.model.prescribed(lambda amplitude: amplitude(t))
        foreseen = self.u + self.dt * self.v + 0.5 * self.dt**2 * self.a
        start = np.where(self.model.fixed, prescribed, foreseen)
        end = self._iterate(start, loads, False) if self.has_matrix else None
        end = end or self._iterate(start, loads, True)
        if end is None:
            raise NotConverged(f"no convergence at t = {t:.6g} s")
        self.u, self.v, self.a = end.u, end.v, end.a
        self.reactions, self.strain_energy = end.forces, end.energy

    def _iterate(self, start, loads, renew: bool) -> "_Balance | None":
        """Newton from `start`, or None where it does not converge."""
        u, previous = start, np.inf
        for _ in range(MAX_ITERATIONS):
            try:
                found = self._balance(u, loads)
            except FloatingPointError:
                return None
            if found.norm <= RESIDUAL * found.size:
                return found
            if renew:
                tangent = self.model.internal(u, True)[2]
                tangent.data += self.scale * self.upper_mass
                self.factors.factorise(tangent)
                self.has_matrix = True
            elif found.norm > SLOW * previous:
                return None
            previous = found.norm
            change = np.zeros(u.size)
            change[self.model.free] = -self.factors.solve(found.forces.ravel()[self.model.free])
            u = u + change.reshape(u.shape)
            self.iterations += 1
        return None

    def _balance(self, u: np.ndarray, loads: np.ndarray) -> "_Balance":
        """The forces that are missing if the step ends at displacements u."""
        dt = self.dt
        a = 4.0 / dt**2 * (u - self.u - dt * self.v) - self.a
        v = self.v + 0.5 * dt * (self.a + a)
        energy, internal = self.model.internal(u)
        inertia = self.mass @ (a + self.damping * v)
        forces = internal + inertia - loads
        norm = float(np.linalg.norm(forces.ravel()[self.model.free]))
        size = max(np.linalg.norm(part) for part in (internal, loads, inertia))
        return _Balance(u, v, a, forces, energy, norm, float(size))


@dataclass(frozen=True)
class _Balance:
    """Motion at the end of a step, the forces (n, d) [N] that the supports would
    have to exert on every node, their norm over free unknowns and its measure."""

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    forces: np.ndarray
    energy: float
    norm: float
    size: float
