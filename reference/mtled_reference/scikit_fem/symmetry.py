"""Planes of mirror symmetry: a part of the body is meshed, the rest is its mirror image."""

import numpy as np

from ..shared.measurements import in_space

Plane = tuple[int, float]
"""Axis across the plane, and the coordinate of the plane on it [m]."""


def images(planes: list[Plane], positions, vectors) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) and vectors (n, 3) of the part and of all its mirror images."""
    positions, vectors = in_space(positions), in_space(vectors)
    for axis, coordinate in planes:
        other, mirrored = positions.copy(), vectors.copy()
        other[:, axis] = 2.0 * coordinate - other[:, axis]
        mirrored[:, axis] *= -1.0
        positions = np.concatenate([positions, other])
        vectors = np.concatenate([vectors, mirrored])
    return positions, vectors


def folded(planes: list[Plane], positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, d) mirrored to the side of the planes that is meshed (the higher
    coordinates), and the signs (n, d) that mirror displacements there back."""
    positions, signs = positions.copy(), np.ones_like(positions)
    for axis, coordinate in planes:
        below = positions[:, axis] < coordinate
        positions[below, axis] = 2.0 * coordinate - positions[below, axis]
        signs[below, axis] = -1.0
    return positions, signs


def folded_mean(planes: list[Plane], mean: np.ndarray, is_position: bool) -> np.ndarray:
    """The mean over the whole body of a position or displacement from the `mean` over
    the part: across a plane it is the coordinate of the plane, or zero."""
    mean = mean.copy()
    for axis, coordinate in planes:
        mean[axis] = coordinate if is_position else 0.0
    return mean
