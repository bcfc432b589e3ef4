"""Surfaces, contact, loads and tetrahedra of the whole brain."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mtled_reference.shared.case import Amplitude, BodyForce, Obstacle, read_case
from mtled_reference.whole_brain.contact import Wall, quadratic_triangle, triangle_rule
from mtled_reference.whole_brain.image import SignedDistance
from mtled_reference.whole_brain.loads import body_forces
from mtled_reference.whole_brain.mesh import Tetrahedra, qualities, tetrahedra, volumes
from mtled_reference.whole_brain.surfaces import triangulated

CASES = Path(__file__).parents[1] / "cases"
UNIT = BodyForce((1.0, 0.0, 0.0), Amplitude())
RADIUS, GAP, PENALTY = 0.05, 0.0005, 1e6


@pytest.fixture(scope="module")
def ball():
    """The facets of a ball, without its inside, and the exact signed distance."""
    axis = np.arange(-35, 36) * 0.002
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    samples = np.sqrt(x**2 + y**2 + z**2) - RADIUS
    distance = SignedDistance(samples, np.array([axis[0]] * 3), 0.002)
    points, triangles = triangulated(distance, 0.01)
    pairs, number = np.unique(
        np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0, return_inverse=True
    )
    middles = distance.projected(points[pairs].mean(axis=1))
    facets = np.hstack([triangles, number.reshape(-1, 3) + len(points)])
    empty = np.zeros((0, 10), int)
    nodes = np.vstack([points, middles])
    return Tetrahedra(nodes, empty, empty, facets, np.zeros(0, bool), distance, 0.01)


@pytest.fixture(scope="module")
def wall(ball):
    obstacle = Obstacle("skull", {"any": {}}, GAP, "inside", "frictionless")
    return Wall(SimpleNamespace(obstacles=[obstacle], shape={"any": {}}), ball, PENALTY)


def test_the_rule_and_the_shape_functions_of_triangles():
    points, weights = triangle_rule()
    assert weights.sum() == pytest.approx(0.5)
    assert weights @ points[:, 0] ** 6 == pytest.approx(2 * 720 / 40320 * 0.5, rel=1e-9)
    values, slopes = quadratic_triangle(points)
    assert values.sum(axis=1) == pytest.approx(1.0)
    assert np.abs(slopes.sum(axis=2)).max() < 1e-12
    corners = np.array([[0.0, 0.0], [2.0, 0.5], [0.3, 1.0]])
    nodes = np.vstack([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))])
    assert np.einsum("qa,ai->qi", values, nodes) == pytest.approx(points @ corners)
    assert np.einsum("qa,ai->qi", slopes[0], nodes)[0] == pytest.approx(corners[1] - corners[0])


def test_the_facets_of_a_ball_have_its_area(ball, wall):
    assert wall.areas.sum() == pytest.approx(4 * np.pi * RADIUS**2, rel=2e-3)
    assert wall.gap(np.zeros(ball.nodes.size)) == pytest.approx(GAP, abs=1e-7)


def test_the_force_on_a_ball_that_is_moved_into_a_ball(ball, wall):
    """Penetration δ cos θ − g to first order in δ/R, so that
    F = 2π R² ε (δ (1 − c³)/3 − g (1 − c²)/2) with c = g/δ."""
    move = 0.001
    direction = np.array([1.0, -2.0, 2.0]) / 3.0
    u = np.tile(move * direction, (len(ball.nodes), 1)).ravel()
    c = GAP / move
    expected = 2 * np.pi * RADIUS**2 * PENALTY * (move * (1 - c**3) / 3 - GAP * (1 - c**2) / 2)
    assert wall.resultant(u) == pytest.approx(-expected * direction, abs=0.015 * expected)
    assert wall.penetration(u) == pytest.approx(move - GAP, rel=0.01)
    assert wall.resultant(0.4 * u) == pytest.approx(0.0)


def test_the_stiffness_is_the_derivative_of_the_force(ball, wall):
    random = np.random.default_rng(3)
    u = np.tile([0.0, 0.001, 0.0], len(ball.nodes)) + 1e-5 * random.normal(size=ball.nodes.size)
    change = 1e-8 * random.normal(size=u.size)
    difference = wall.force(u + change) - wall.force(u - change)
    expected = -2.0 * wall.stiffness(u) @ change
    assert np.linalg.norm(difference - expected) < 0.03 * np.linalg.norm(expected)


def test_augmentation_keeps_the_pressure_without_penetration(ball, wall):
    u = np.tile([0.0, 0.001, 0.0], len(ball.nodes))
    pressed = Wall.__new__(Wall)
    pressed.__dict__.update(wall.__dict__)
    pressed.augment(u)
    there = np.tile([0.0, 0.0005, 0.0], len(ball.nodes))
    force = pressed.resultant(there)
    assert np.linalg.norm(force) > 0.5 * np.linalg.norm(wall.resultant(u))


@pytest.fixture(scope="module")
def case():
    return read_case(CASES / "brain_shift.toml")


@pytest.fixture(scope="module")
def mesh(case):
    pytest.importorskip("tetgen")
    return tetrahedra(case, 0.025)


def test_tetrahedra_fill_the_body(case, mesh):
    straight = volumes(mesh.nodes, mesh.cells[:, :4])
    assert straight.min() > 0.0
    assert qualities(mesh.nodes, mesh.cells[:, :4]).min() > 0.1
    # Flat facets cut the corners of the body; curved ones restore its volume.
    curved = body_forces(replace(case, body_forces=[UNIT]), mesh).sum() / 1000.0
    assert straight.sum() < curved
    assert curved == pytest.approx(1.846e-3, rel=0.02)
    for index, volume in ((0, 20.8e-6), (1, 6.63e-6)):
        assert straight[mesh.region == index].sum() == pytest.approx(volume, rel=0.25)


def test_the_craniotomy_ends_on_facets(case, mesh):
    sphere = case.prescriptions[0].selector["sphere"]
    reach = np.linalg.norm(mesh.nodes - np.array(sphere["centre"]), axis=1)
    assert reach[mesh.constrained].max() < sphere["radius"] * (1 + 1e-3)
    assert np.count_nonzero(np.abs(reach[mesh.constrained] / sphere["radius"] - 1) < 1e-3) > 10
    moved = case.prescriptions[0].values(mesh.nodes[mesh.constrained], 1.0)
    assert np.linalg.norm(moved, axis=1).max() == pytest.approx(0.01, rel=0.2)


def test_the_weight_above_a_level(case, mesh):
    down = (0.0, 0.0, -9.81)
    whole = BodyForce(down, case.prescriptions[0].amplitude)
    above = {"half_space": {"point": [0.0, 0.0, 0.04], "normal": [0.0, 0.0, -1.0]}}
    part = BodyForce(down, case.prescriptions[0].amplitude, selector=above)

    def weight(force):
        total = body_forces(replace(case, body_forces=[force]), mesh).reshape(-1, 3)
        return total.sum(axis=0)

    assert weight(whole) == pytest.approx([0.0, 0.0, -1000 * 9.81 * 1.846e-3], rel=0.02)
    image = mesh.distance
    i, j, k = np.indices(image.samples.shape)
    voxels = (image.samples < 0.0) & (image.corner[2] + image.voxel * k >= 0.04)
    expected = -9810.0 * voxels.sum() * image.voxel**3
    assert weight(part)[2] == pytest.approx(expected, rel=0.04)
