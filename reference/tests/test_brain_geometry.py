"""The outline of the brain slice, its triangles and the skull."""

from pathlib import Path

import numpy as np
import pytest

from mtled_reference.brain.body import Skull, read_body
from mtled_reference.brain.image import signed_distance
from mtled_reference.brain.outline import area, level_polygons, smooth_curve
from mtled_reference.brain.triangles import Sizes, signed_areas, triangulate
from mtled_reference.shared.case import read_case

CASE = Path(__file__).parents[1] / "cases" / "brain_slice.toml"


@pytest.fixture(scope="module")
def case():
    return read_case(CASE)


@pytest.fixture(scope="module")
def body(case):
    return read_body(case)


def test_a_circle_is_followed_by_its_curve():
    axis = np.arange(-20, 21) * 1e-3
    x, y = np.meshgrid(axis, axis, indexing="ij")
    (polygon,) = level_polygons(np.hypot(x, y) - 0.015, (axis, axis))
    curve = smooth_curve(polygon, 0.0015)
    points = curve.polygon(2e-4)
    assert area(points) == pytest.approx(np.pi * 0.015**2, rel=2e-3)
    assert np.abs(np.hypot(*points.T) - 0.015).max() < 1e-4


def test_the_outline_encloses_the_area_of_the_voxels(body):
    voxels = np.count_nonzero(body.image.labels) * body.image.voxel**2
    assert area(body.outline.polygon(1e-4)) == pytest.approx(voxels, rel=1e-3)


def test_signed_distance_is_measured_to_the_outline(body):
    distance = signed_distance(body.image, [1, 2, 3])
    x, y = body.image.axes()
    far = np.array([[x[i], y[j]] for i, j in [(20, 60), (40, 150), (90, 20)]])
    nearest = [np.linalg.norm(body.outline.polygon(1e-4) - p, axis=1).min() for p in far]
    there = [abs(distance[i, j]) for i, j in [(20, 60), (40, 150), (90, 20)]]
    assert there == pytest.approx(nearest, abs=3e-4)


def test_the_craniotomy_ends_on_its_sphere(case, body):
    sphere = case.prescriptions[0].selector["sphere"]
    ends = body.outline.at(np.array(body.craniotomy))
    distance = np.linalg.norm(ends - np.array(sphere["centre"])[:2], axis=1)
    assert distance == pytest.approx([sphere["radius"]] * 2, abs=1e-9)
    middle = body.outline.at(np.mean(body.craniotomy))
    assert np.linalg.norm(middle - np.array(sphere["centre"])[:2]) < sphere["radius"]


def test_the_skull_is_three_millimetres_away(case, body):
    gap, normal = Skull(case, body).gap(body.outline.polygon(1e-3))
    assert np.median(gap) == pytest.approx(0.003, abs=2e-5)
    assert gap.min() > 0.0025 and gap.max() < 0.0032
    outward, _ = Skull(case, body).gap(body.outline.polygon(1e-3) - 0.001 * normal)
    assert np.median(outward) == pytest.approx(0.002, abs=5e-5)


def test_triangles_fill_the_regions(case, body):
    triangles = triangulate(body, Sizes(0.02, 0.008, 0.006, 0.004))
    areas = signed_areas(triangles.points, triangles.corners)
    assert areas.min() > 0.0
    for index, label in ((0, 2), (1, 3)):
        voxels = np.count_nonzero(body.image.labels == label) * body.image.voxel**2
        assert areas[triangles.region == index].sum() == pytest.approx(voxels, rel=0.08)
    ends = triangles.points[triangles.curve_edges[triangles.constrained]]
    sphere = case.prescriptions[0].selector["sphere"]
    reach = np.linalg.norm(ends - np.array(sphere["centre"])[:2], axis=-1)
    assert reach.max() == pytest.approx(sphere["radius"], abs=1e-9)
