"""The label map of the whole brain and signed distances."""

import json
from pathlib import Path

import numpy as np
import pytest

from mtled_reference.whole_brain.image import (
    LabelMap,
    enclosed_volume,
    read_label_map,
    signed_distance,
    smoothed,
)

BRAIN = Path(__file__).parents[1] / "brain"
RADIUS = 11.0


@pytest.fixture(scope="module")
def ball():
    """A ball of voxels of 2 mm around the voxel (20, 20, 20), with empty space around."""
    i, j, k = np.indices((41, 41, 41)) - 20
    labels = (i**2 + j**2 + k**2 <= RADIUS**2).astype(np.uint8)
    return LabelMap(labels, np.array([-0.04, -0.04, -0.04]), 0.002)


def test_the_label_map_is_that_of_its_description():
    description = json.loads((BRAIN / "brain.json").read_text())
    image = read_label_map(BRAIN / "brain.nrrd")
    assert image.voxel == pytest.approx(0.002)
    names = {1: "brain", 2: "ventricles", 3: "tumour"}
    for label, name in names.items():
        chosen = image.labels == label
        volume = chosen.sum() * image.voxel**3 * 1e6
        assert volume == pytest.approx(description["volume_ml"][name], abs=1e-3)
        centroid = image.corner + image.voxel * np.argwhere(chosen).mean(axis=0)
        expected = description["centroid_mm"][name]["ras"]
        assert 1e3 * centroid == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("smoothing", [0.5, 0.7, 1.4])
def test_no_voxel_changes_sides(ball, smoothing):
    level = smoothed(ball.labels == 1, smoothing)
    assert np.array_equal(level > 0.5, ball.labels == 1)


@pytest.mark.parametrize("smoothing", [0.7, 1.4])
def test_the_signed_distance_of_a_ball(ball, smoothing):
    distance = signed_distance(ball, [1], smoothing)
    volume = np.count_nonzero(ball.labels) * ball.voxel**3
    radius = np.cbrt(0.75 / np.pi * volume)
    direction = np.random.default_rng(1).normal(size=(400, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    for height in (-0.002, 0.0, 0.002):
        # The staircase of the voxels, whose sides are kept, remains in part.
        error = distance.at((radius + height) * direction) - height
        assert np.sqrt(np.mean(error**2)) < 0.1 * ball.voxel
        assert abs(error.mean()) < 0.02 * ball.voxel
    slope = distance.gradient(radius * direction)
    assert np.sqrt(np.mean((slope - direction) ** 2)) < 0.1
    assert enclosed_volume(distance.samples, ball.voxel) == pytest.approx(volume, rel=1e-6)


def test_the_gradient_is_that_of_the_spline(ball):
    distance = signed_distance(ball, [1], 1.4)
    points = np.random.default_rng(2).uniform(-0.025, 0.025, (50, 3))
    step = 1e-6
    for axis in range(3):
        ahead, behind = points.copy(), points.copy()
        ahead[:, axis] += step
        behind[:, axis] -= step
        slope = (distance.at(ahead) - distance.at(behind)) / (2 * step)
        assert distance.gradient(points)[:, axis] == pytest.approx(slope, abs=1e-6)
    surface = distance.projected(0.022 * points / np.linalg.norm(points, axis=1, keepdims=True))
    assert np.abs(distance.at(surface)).max() < 1e-9
