"""Derivatives on the quadrilaterals of the brain slice."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("skfem")

from mtled_reference.brain.body import read_body
from mtled_reference.brain.quad_elements import QuadElements
from mtled_reference.brain.quads import quads_from
from mtled_reference.brain.triangles import Sizes, triangulate
from mtled_reference.shared.case import read_case

CASE = Path(__file__).parents[1] / "cases" / "brain_slice.toml"


@pytest.fixture(scope="module")
def elements():
    case = read_case(CASE)
    triangles = triangulate(read_body(case), Sizes(0.03, 0.012, 0.008, 0.006))
    return QuadElements(case, quads_from(triangles))


def test_forces_and_stiffness_are_derivatives_of_the_energy(elements):
    random = np.random.default_rng(2)
    x, y = elements.positions.T
    bent = np.column_stack([2.0 * x * y + 0.05 * y, 0.2 * x**2 - 0.05 * y])
    u = bent.ravel() + 1e-6 * random.normal(size=2 * len(x))
    direction, step = 1e-4 * random.normal(size=len(u)), 1e-5
    for block in elements.blocks:
        local = direction.reshape(-1, 2)[block.dofs]
        rate = (block.energy(u + step * direction) - block.energy(u - step * direction)) / 2 / step
        assert np.sum(block.force(u) * local) == pytest.approx(rate, rel=1e-5)
        change = block.force(u + step * direction) - block.force(u - step * direction)
        tangent = np.einsum("eaibk,ebk->eai", block.stiffness(u), local)
        assert np.abs(change / 2 / step - tangent).max() < 1e-4 * np.abs(tangent).max()


def test_mass_and_volume_are_those_of_the_body(elements):
    assert elements.mass.sum() / 2 == pytest.approx(0.096835, rel=2e-3)
    assert sum(volumes.sum() for volumes in elements.node_volumes) == pytest.approx(
        9.6835e-5, rel=2e-3
    )


def test_a_rotation_has_no_energy_and_no_force(elements):
    x, y = elements.positions.T
    c, s = np.cos(0.7), np.sin(0.7)
    rotated = np.column_stack([c * x - s * y - x, s * x + c * y - y]).ravel()
    assert abs(elements.energy(rotated)) < 1e-12
    assert np.abs(elements.force(rotated)).max() < 1e-12
