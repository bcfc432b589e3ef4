"""Implicit motion of the brain slice, one step after another.

TR-BDF2 (Bank et al., IEEE Trans. CAD 4, 436, 1985): the trapezoidal rule over
γ = 2 − √2 of a step, then the second backward difference to its end; second order
in time and strongly damped for what is stiff, such as contact. In both stages
v = k(u − ũ) and kM(v − ṽ) + αMv + f(u) − f_contact(u) = h with the same k, where
ũ, ṽ and h are known. Newton's method meets f(u); essential values are put in first.
"""

from dataclasses import dataclass
from typing import Callable, Protocol

import numpy as np
import scipy.sparse as sp

from .brain_contact import Wall

GAMMA = 2.0 - np.sqrt(2.0)
TOLERANCE = 1e-7
"""Of the residual against the forces that it sums [–]."""
MOST_ITERATIONS = 40
HALVINGS = 8
SLOW = 0.2
"""Above this fall of the residual per iteration the matrix is made anew [–]."""


class Elements(Protocol):
    """What a code provides; vectors hold x and y of each node in turn."""

    mass: sp.csr_matrix

    def force(self, u: np.ndarray) -> np.ndarray: ...

    def stiffness(self, u: np.ndarray) -> sp.csr_matrix: ...

    def factorised(self, matrix: sp.csr_matrix) -> Callable[[np.ndarray], np.ndarray]: ...


@dataclass
class State:
    """Displacements [m], velocities [m/s] and the forces of supports [N] at a time [s]."""

    time: float
    u: np.ndarray
    v: np.ndarray
    support: np.ndarray


class Motion:
    """Steps of a body that is held at `held` (indices into u) until `release` [s]."""

    def __init__(self, elements: Elements, wall: Wall, damping: float, held, held_at, release):
        self.elements, self.wall, self.damping = elements, wall, damping
        self.held, self.held_at, self.release = held, held_at, release
        self.iterations = self.factorisations = self.solves = 0
        self.deepest = 0.0
        self._matrix_of = None

    def at_rest(self) -> State:
        zero = np.zeros(self.elements.mass.shape[0])
        return State(0.0, zero, zero.copy(), zero.copy())

    def step(self, old: State, time: float) -> State:
        """The state at `time`. A step that starts at the release is parted: two short
        ones by backward Euler, which never overshoots, then longer and longer ones."""
        if abs(old.time - self.release) > 1e-9:
            return self._tr_bdf2(old, time)
        dt = time - old.time
        state = self._backward_euler(old, old.time + dt / 16)
        state = self._backward_euler(state, old.time + dt / 8)
        for share in (1 / 4, 1 / 2, 1):
            state = self._tr_bdf2(state, old.time + share * dt)
        return state

    def _backward_euler(self, old: State, time: float) -> State:
        k = 1.0 / (time - old.time)
        is_held = old.time < self.release - 1e-9
        return State(time, *self._solve(k, old.u, old.u, old.u, old.v, 0.0, time, is_held))

    def _tr_bdf2(self, old: State, time: float) -> State:
        dt = time - old.time
        k = 2.0 / (GAMMA * dt)
        is_held = old.time < self.release - 1e-9
        push = self.wall.force(old.u) - self.elements.force(old.u)
        push -= self.damping * (self.elements.mass @ old.v)
        middle, guess = old.time + GAMMA * dt, old.u + GAMMA * dt * old.v
        u, v, _ = self._solve(
            k, guess, old.u, old.u + old.v / k, old.v, push, middle, is_held
        )
        share = 1.0 / (GAMMA * (2.0 - GAMMA))
        before = share * (1.0 - GAMMA) ** 2
        known = share * u - before * old.u, share * v - before * old.v
        guess = u + (1.0 - GAMMA) * dt * v
        return State(time, *self._solve(k, guess, u, *known, 0.0, time, is_held))

    def _solve(self, k, u, old_u, known_u, known_v, push, time, is_held):
        """Newton's method for one stage from the guess u, or from the displacements
        before if the guess turns an element inside out; the matrix is kept while it
        serves."""
        mass = self.elements.mass
        free = np.ones(len(u), dtype=bool)
        u = u.copy()
        if is_held:
            free[self.held] = False
            u[self.held] = self.held_at(time)
        last, self.solves = np.inf, self.solves + 1
        try:
            forces = self._forces(u, k, known_u, known_v, push)
        except FloatingPointError:
            u[free] = old_u[free]
            forces = self._forces(u, k, known_u, known_v, push)
        for _ in range(MOST_ITERATIONS):
            residual, scale = forces
            size = np.linalg.norm(residual[free])
            if size <= TOLERANCE * scale:
                return u, k * (u - known_u), np.where(free, 0.0, residual)
            closed = self.wall.closed(u).tobytes()
            if self._matrix_of != (k, is_held, closed) or size > SLOW * last:
                self._make_matrix(k, u, free)
                self._matrix_of = (k, is_held, closed)
            last = size
            change = np.zeros(len(u))
            change[free] = -self._inverse(residual[free])
            u, forces = self._advanced(
                u, change, lambda u: self._forces(u, k, known_u, known_v, push)
            )
            self.iterations += 1
        raise RuntimeError(f"Newton's method does not end at {time:.4f} s, residual {size:.1e} N")

    def _forces(self, u, k, known_u, known_v, push):
        """Residual of a stage [N] and the size of the forces in it."""
        v = k * (u - known_u)
        inertia = self.elements.mass @ (k * (v - known_v) + self.damping * v)
        inner, contact = self.elements.force(u), self.wall.force(u)
        scale = sum(map(np.linalg.norm, (inner, inertia, contact))) + 1e-9
        return inertia + inner - contact - push, scale

    def _advanced(self, u, change, forces_at):
        """A step of Newton's method, halved while it turns an element inside out."""
        for _ in range(HALVINGS):
            try:
                return u + change, forces_at(u + change)
            except FloatingPointError:
                change = 0.5 * change
        raise RuntimeError("Newton's method turns elements inside out")

    def _make_matrix(self, k, u, free) -> None:
        inertia = (k * k + self.damping * k) * self.elements.mass
        matrix = (inertia + self.elements.stiffness(u) + self.wall.stiffness(u)).tocsr()
        self._inverse = self.elements.factorised(matrix[free][:, free])
        self.factorisations += 1
