"""Time steps, contact and elements of the brain slice."""

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg

from mtled_reference.brain.contact import Wall
from mtled_reference.brain.motion import Motion


class Spring:
    """Two components: an oscillator of 1 kg with a stiffening spring, and a prescribed one."""

    mass = sp.identity(2, format="csr")

    def force(self, u):
        return np.array([9.0 * u[0] + u[0] ** 3 + 2.0 * u[1], 5.0 * u[1] + 2.0 * u[0]])

    def stiffness(self, u):
        return sp.csr_matrix([[9.0 + 3.0 * u[0] ** 2, 2.0], [2.0, 5.0]])

    def factorised(self, matrix):
        return sp.linalg.splu(matrix.tocsc()).solve


class NoWall:
    def closed(self, u):
        return np.zeros(1, dtype=bool)

    def force(self, u):
        return np.zeros(2)

    def stiffness(self, u):
        return sp.csr_matrix((2, 2))


def moved(steps: int) -> np.ndarray:
    """The displacements at 2 s if the prescribed end follows t³ and is released at 1 s."""
    motion = Motion(Spring(), NoWall(), 0.7, np.array([1]), lambda t: np.array([t**3]), 1.0)
    state = motion.at_rest()
    for n in range(steps):
        state = motion.step(state, 2.0 * (n + 1) / steps)
    return state.u


def test_halved_steps_quarter_the_error():
    coarse, middle, fine = (moved(steps) for steps in (80, 160, 320))
    order = np.log2(np.linalg.norm(coarse - middle) / np.linalg.norm(middle - fine))
    assert order == pytest.approx(2.0, abs=0.25)


def test_reactions_include_the_inertia_of_a_prescribed_spring():
    motion = Motion(Spring(), NoWall(), 0.7, np.array([1]), lambda t: np.array([t**3]), 1.0)
    state = motion.at_rest()
    for n in range(180):
        state = motion.step(state, 0.9 * (n + 1) / 180)
    acceleration, velocity = 6.0 * 0.9, 3.0 * 0.9**2
    expected = acceleration + 0.7 * velocity + Spring().force(state.u)[1]
    assert state.reactions[1] == pytest.approx(expected, rel=1e-3)
    assert state.reactions[0] == 0.0


class FlatSkull:
    """Open above y = 0."""

    def gap(self, points):
        return points[:, 1].copy(), np.tile([0.0, 1.0], (len(points), 1))


def test_contact_force_is_penalty_times_depth_times_area():
    edge = np.array([[[0.0, 0.0], [0.2, 0.0], [0.1, 0.0]]])
    wall = Wall(FlatSkull(), np.array([[0, 1, 2]]), [0.0, 0.5, 1.0], edge, 3, 0.05, 1e4)
    u = np.array([0.0, -1e-3, 0.0, -1e-3, 0.0, -1e-3])
    force = wall.force(u)
    assert force[1::2].sum() == pytest.approx(1e4 * 1e-3 * 0.2 * 0.05)
    assert force[1::2] == pytest.approx(np.array([1, 4, 1]) / 6 * force[1::2].sum())
    step = 1e-7 * np.random.default_rng(1).normal(size=6)
    change = wall.force(u + step) - wall.force(u - step)
    assert -2.0 * wall.stiffness(u) @ step == pytest.approx(change, rel=1e-6, abs=1e-12)
    assert wall.penetration(u) == pytest.approx(1e-3)
