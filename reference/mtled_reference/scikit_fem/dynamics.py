"""Motion by the trapezoidal rule with the consistent mass (Newmark, β = 1/4, γ = 1/2)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from ..shared.errors import NotConverged
from ..shared.measurements import recorded_times
from .factorisation import Factorisation
from .model import Model
from .record import Recorder

RESIDUAL = 1e-8
"""Largest norm of the residual over that of the acting forces [–]."""

MAX_ITERATIONS = 25
SLOW = 0.5
"""An old factorisation is dropped where an iteration leaves more of the residual [–]."""


def solve_dynamic(
    model: Model,
    recorder: Recorder,
    steps: int,
    progress: Callable[[float, str], None],
    factors: Factorisation,
) -> int:
    """Integrates from rest at t = 0 and records the values; returns the number of
    Newton iterations."""
    motion = _Motion(model, model.case.time.end / steps, factors)
    times = recorded_times(model.case)
    every = steps // len(times)
    if every * len(times) != steps:
        raise ValueError("the recorded instants are not multiples of the time step")
    for step in range(1, steps + 1):
        motion.advance(step * motion.dt)
        if step % every == 0:
            kinetic = 0.5 * float(np.sum(motion.v * (motion.mass @ motion.v)))
            recorder.record(motion.u, motion.reactions, motion.strain_energy, kinetic)
            progress(step / steps, f"time step {step} of {steps}")
    return motion.iterations


class _Motion:
    """Displacements [m], velocities [m/s] and accelerations [m/s²], (n, d), in time."""

    def __init__(self, model: Model, dt: float, factors: Factorisation):
        self.model, self.dt, self.factors = model, dt, factors
        self.mass = model.mass
        self.damping = model.case.time.damping
        self.iterations = 0
        self.u = model.prescribed(lambda amplitude: amplitude(0.0))
        self.v = np.zeros_like(self.u)
        self.a = self._initial_acceleration()
        self.scale = 4.0 / dt**2 + 2.0 * self.damping / dt
        """Factor of the mass in the matrix of a step [1/s²]."""
        self.upper_mass = self._upper_mass()
        self.has_matrix = False

    def _initial_acceleration(self) -> np.ndarray:
        """a from M a = f_ext − f_int(u) at t = 0, zero where displacements are prescribed."""
        _, internal = self.model.internal(self.u)
        force = self.model.loads(lambda amplitude: amplitude(0.0)) - internal
        a = np.zeros_like(force)
        for component in range(self.model.d):
            free = ~self.model.fixed[:, component]
            matrix = self.mass[free][:, free].tocsc()
            a[free, component] = sparse.linalg.spsolve(matrix, force[free, component])
        return a

    def _upper_mass(self) -> np.ndarray:
        """The entries of the mass in the sparsity pattern of the free unknowns."""
        full = sparse.kron(self.mass, sparse.identity(self.model.d), format="csr")
        full = full[self.model.free][:, self.model.free]
        pattern = self.model.pattern
        rows = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
        return np.asarray(full[rows, pattern.indices]).ravel()

    def advance(self, t: float) -> None:
        """One step to time t [s], with the factorisation of an earlier step if that
        converges, otherwise with a new one in every iteration."""
        loads = self.model.loads(lambda amplitude: amplitude(t))
        prescribed = self.model.prescribed(lambda amplitude: amplitude(t))
        predicted = self.u + self.dt * self.v + 0.5 * self.dt**2 * self.a
        start = np.where(self.model.fixed, prescribed, predicted)
        end = self._iterate(start, loads, False) if self.has_matrix else None
        end = end or self._iterate(start, loads, True)
        if end is None:
            raise NotConverged(f"no convergence at t = {t:.6g} s")
        self.u, self.v, self.a = end.u, end.v, end.a
        self.reactions, self.strain_energy = end.forces, end.energy

    def _iterate(self, start, loads, renew: bool) -> "_Balance | None":
        """Newton's method from `start`; None where it does not converge."""
        u, previous = start, np.inf
        for _ in range(MAX_ITERATIONS):
            try:
                balance = self._balance(u, loads)
            except FloatingPointError:
                return None
            if balance.norm <= RESIDUAL * balance.size:
                return balance
            if renew:
                tangent = self.model.internal(u, True)[2]
                tangent.data += self.scale * self.upper_mass
                self.factors.factorise(tangent)
                self.has_matrix = True
            elif balance.norm > SLOW * previous:
                return None
            previous = balance.norm
            change = np.zeros(u.size)
            change[self.model.free] = -self.factors.solve(balance.forces.ravel()[self.model.free])
            u = u + change.reshape(u.shape)
            self.iterations += 1
        return None

    def _balance(self, u: np.ndarray, loads: np.ndarray) -> "_Balance":
        """The unbalanced forces if the step ends at displacements u."""
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
    """Motion at the end of a step, the unbalanced forces (n, d) [N], which are reactions
    where displacements are prescribed, their norm over the free unknowns, and the size of
    the acting forces [N]."""

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    forces: np.ndarray
    energy: float
    norm: float
    size: float
