"""Implicit time integration of the brain slice.

TR-BDF2 (Bank et al., IEEE Trans. CAD 4, 436, 1985): the trapezoidal rule over
γ = 2 − √2 of a step, then the second-order backward difference to its end. It is of
second order and strongly damps stiff modes, such as those of contact. In both stages
v = k(u − ũ) and kM(v − ṽ) + αMv + f_int(u) − f_con(u) = h with the same k, where
ũ, ṽ and h are known. Newton's method solves for u after the prescribed values are set.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from ..shared.errors import NotConverged
from .contact import Wall

GAMMA = 2.0 - np.sqrt(2.0)
TOLERANCE = 1e-7
"""Largest norm of the residual over the sum of the norms of its terms [–]."""
MAX_ITERATIONS = 40
HALVINGS = 8
SLOW = 0.2
"""The matrix is factorised again where an iteration leaves more of the residual [–]."""


class Elements(Protocol):
    """What a code provides; vectors have x and y of each node in turn."""

    mass: sp.csr_matrix

    def force(self, u: np.ndarray) -> np.ndarray: ...

    def stiffness(self, u: np.ndarray) -> sp.csr_matrix: ...

    def factorised(self, matrix: sp.csr_matrix) -> Callable[[np.ndarray], np.ndarray]: ...


@dataclass
class State:
    """Displacements [m], velocities [m/s] and reactions of the supports [N] at a time [s]."""

    time: float
    u: np.ndarray
    v: np.ndarray
    reactions: np.ndarray


class Motion:
    """Steps of a body whose unknowns `prescribed` (indices into u) have the values
    `values_at(time)` until `release` [s], and are free from then on."""

    def __init__(
        self, elements: Elements, wall: Wall, damping: float, prescribed, values_at, release
    ):
        self.elements, self.wall, self.damping = elements, wall, damping
        self.prescribed, self.values_at, self.release = prescribed, values_at, release
        self.iterations = 0
        self._factorised_for = None

    def at_rest(self) -> State:
        """The state without displacements at t = 0."""
        zero = np.zeros(self.elements.mass.shape[0])
        return State(0.0, zero, zero.copy(), zero.copy())

    def step(self, old: State, time: float) -> State:
        """The state at `time`. A step that starts at the release is divided: two short
        steps by backward Euler, which does not overshoot, then steps of growing length."""
        if abs(old.time - self.release) > 1e-9:
            return self._tr_bdf2(old, time)
        dt = time - old.time
        state = self._backward_euler(old, old.time + dt / 16)
        state = self._backward_euler(state, old.time + dt / 8)
        for fraction in (1 / 4, 1 / 2, 1):
            state = self._tr_bdf2(state, old.time + fraction * dt)
        return state

    def _is_free(self, old: State) -> bool:
        """Whether nothing is prescribed in a step that starts from `old`."""
        return old.time >= self.release - 1e-9

    def _backward_euler(self, old: State, time: float) -> State:
        k = 1.0 / (time - old.time)
        stage = _Stage(k, old.u, old.v, 0.0, time, self._is_free(old))
        return State(time, *self._solve(stage, old.u, old.u))

    def _tr_bdf2(self, old: State, time: float) -> State:
        dt = time - old.time
        k = 2.0 / (GAMMA * dt)
        is_free = self._is_free(old)
        h = self.wall.force(old.u) - self.elements.force(old.u)
        h -= self.damping * (self.elements.mass @ old.v)
        middle, guess = old.time + GAMMA * dt, old.u + GAMMA * dt * old.v
        stage = _Stage(k, old.u + old.v / k, old.v, h, middle, is_free)
        u, v, _ = self._solve(stage, guess, old.u)
        now = 1.0 / (GAMMA * (2.0 - GAMMA))
        before = now * (1.0 - GAMMA) ** 2
        guess = u + (1.0 - GAMMA) * dt * v
        stage = _Stage(k, now * u - before * old.u, now * v - before * old.v, 0.0, time, is_free)
        return State(time, *self._solve(stage, guess, u))

    def _solve(self, stage: "_Stage", guess: np.ndarray, old_u: np.ndarray):
        """Displacements, velocities and reactions of a stage by Newton's method from a
        guess, or from the displacements before if the guess inverts an element; a
        factorisation is kept while it converges fast."""
        free = np.ones(len(guess), dtype=bool)
        u = guess.copy()
        if not stage.is_free:
            free[self.prescribed] = False
            u[self.prescribed] = self.values_at(stage.time)
        last = np.inf
        try:
            forces = self._forces(stage, u)
        except FloatingPointError:
            u[free] = old_u[free]
            forces = self._forces(stage, u)
        for _ in range(MAX_ITERATIONS):
            residual, scale = forces
            size = np.linalg.norm(residual[free])
            if size <= TOLERANCE * scale:
                return u, stage.k * (u - stage.u), np.where(free, 0.0, residual)
            state = (stage.k, stage.is_free, self.wall.closed(u).tobytes())
            if self._factorised_for != state or size > SLOW * last:
                self._factorise(stage.k, u, free)
                self._factorised_for = state
            last = size
            change = np.zeros(len(u))
            change[free] = -self._inverse(residual[free])
            u, forces = self._advanced(stage, u, change)
            self.iterations += 1
        raise NotConverged(f"no convergence at t = {stage.time:.4f} s, residual {size:.1e} N")

    def _forces(self, stage: "_Stage", u: np.ndarray):
        """Residual of a stage [N] and the sum of the norms of its terms [N]."""
        v = stage.k * (u - stage.u)
        inertia = self.elements.mass @ (stage.k * (v - stage.v) + self.damping * v)
        internal, contact = self.elements.force(u), self.wall.force(u)
        scale = sum(map(np.linalg.norm, (internal, inertia, contact))) + 1e-9
        return inertia + internal - contact - stage.h, scale

    def _advanced(self, stage: "_Stage", u: np.ndarray, change: np.ndarray):
        """A step of Newton's method, halved while it inverts an element, and the forces
        after it."""
        for _ in range(HALVINGS):
            try:
                return u + change, self._forces(stage, u + change)
            except FloatingPointError:
                change = 0.5 * change
        raise NotConverged("the steps of Newton's method invert elements")

    def _factorise(self, k, u, free) -> None:
        inertia = (k * k + self.damping * k) * self.elements.mass
        matrix = (inertia + self.elements.stiffness(u) + self.wall.stiffness(u)).tocsr()
        self._inverse = self.elements.factorised(matrix[free][:, free])


@dataclass(frozen=True)
class _Stage:
    """k [1/s], ũ [m], ṽ [m/s] and h [N] of the equation of a stage, the time at its end
    [s], and whether nothing is prescribed."""

    k: float
    u: np.ndarray
    v: np.ndarray
    h: np.ndarray | float
    time: float
    is_free: bool
