"""The label map of a whole brain as smooth signed distances.

The 0/1 image of some labels is smoothed in n passes of a separable Gaussian, the fewest of
which none is wider than 0.7 voxels. After each pass voxels of the labels are raised to at
least 0.51 and all others lowered to at most 0.49, so that no voxel changes sides. The
distance to the level 1/2 is shifted until the enclosed volume is that of the voxels.
"""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.ndimage import distance_transform_edt, map_coordinates, spline_filter

from ..brain.image import enclosing, read_voxels, smoothed
from .nets import distance_to_triangles, surface_nets, triangles_of

MARGIN = 10
"""Empty voxels around the image, which contain the skull."""
BAND = 5.0
"""Distance [voxel] up to which distances are measured to the surface; farther voxels count
the voxels to the other side, since only their sign matters."""


@dataclass(frozen=True)
class LabelMap:
    """Labels of cubic voxels, labels[i, j, k] centred at `corner` + voxel·(i, j, k) [m]."""

    labels: np.ndarray
    corner: np.ndarray
    voxel: float


def read_label_map(path: Path) -> LabelMap:
    """The label map of an NRRD file with empty space around it."""
    labels, origin, edges = read_voxels(path)
    if not np.allclose(edges, edges[0]):
        raise ValueError(f"{path.name}: voxels must be cubes")
    return LabelMap(np.pad(labels, MARGIN), origin - MARGIN * edges[0], float(edges[0]))


@dataclass(frozen=True)
class SignedDistance:
    """Signed distance [m], negative inside, sampled at points `corner` + voxel·(i, j, k)."""

    samples: np.ndarray
    corner: np.ndarray
    voxel: float

    @cached_property
    def coefficients(self) -> np.ndarray:
        """Coefficients of the cubic spline through the samples."""
        return spline_filter(self.samples, order=3, mode="nearest")

    def _indices(self, points: np.ndarray) -> np.ndarray:
        return (points - self.corner).T / self.voxel

    def trilinear(self, points: np.ndarray) -> np.ndarray:
        """Distances (n,) [m] at points (n, 3) [m], trilinear between the samples."""
        return map_coordinates(self.samples, self._indices(points), order=1, mode="nearest")

    def at(self, points: np.ndarray) -> np.ndarray:
        """Distances (n,) [m] at points (n, 3) [m] by the cubic spline."""
        at = self._indices(points)
        return map_coordinates(self.coefficients, at, order=3, mode="nearest", prefilter=False)

    def gradient(self, points: np.ndarray) -> np.ndarray:
        """Gradients (n, 3) of the cubic spline [–] at points (n, 3) [m]."""
        return np.stack(spline_gradient(self.coefficients, self._indices(points)), 1) / self.voxel

    def projected(self, points: np.ndarray, rounds: int = 4) -> np.ndarray:
        """Points on the level 0 near the given ones (n, 3) [m], moved along the gradient."""
        for _ in range(rounds):
            slope = self.gradient(points)
            square = np.maximum((slope**2).sum(axis=1), 0.25)
            points = points - (self.at(points) / square)[:, None] * slope
        return points


def spline_gradient(coefficients: np.ndarray, indices: np.ndarray) -> list[np.ndarray]:
    """Derivatives of a cubic spline with respect to the indices (3, n), one by one."""
    base = np.clip(np.floor(indices).astype(int), 1, np.array(coefficients.shape)[:, None] - 3)
    t = indices - base
    values, slopes = cubic_weights(t)
    offsets = np.arange(-1, 3)
    i, j, k = (base[axis][:, None] + offsets for axis in range(3))
    block = coefficients[i[:, :, None, None], j[:, None, :, None], k[:, None, None, :]]

    def sum_with(*weights) -> np.ndarray:
        return np.einsum("nijk,ni,nj,nk->n", block, *weights, optimize=True)

    x, y, z = values
    return [
        sum_with(slopes[0], y, z),
        sum_with(x, slopes[1], z),
        sum_with(x, y, slopes[2]),
    ]


def cubic_weights(t: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Values and slopes (n, 4) of the four cubic B-splines at fractions t (3, n)."""
    values, slopes = [], []
    for s in t:
        r = 1.0 - s
        inner = [2 / 3 - s**2 + s**3 / 2, 2 / 3 - r**2 + r**3 / 2]
        values.append(np.stack([r**3 / 6, *inner, s**3 / 6], axis=1))
        rising = [-2 * s + 1.5 * s**2, 2 * r - 1.5 * r**2]
        slopes.append(np.stack([-(r**2) / 2, *rising, s**2 / 2], axis=1))
    return values, slopes


def signed_distance(image: LabelMap, labels: list[int], smoothing: float) -> SignedDistance:
    """Signed distance to the smooth outline of some labels."""
    chosen = np.isin(image.labels, labels)
    values = 0.5 - smoothed(chosen, smoothing)
    distance = _distance_to_level(values) * image.voxel
    volume = chosen.sum() * image.voxel**3
    samples = enclosing(distance, image.voxel, enclosed_volume, volume)
    return SignedDistance(samples, image.corner, image.voxel)


def _distance_to_level(values: np.ndarray) -> np.ndarray:
    """Signed distance [voxel] of the samples to the zero level of the field."""
    inside = values < 0.0
    distance = np.where(
        inside, 0.5 - distance_transform_edt(inside), distance_transform_edt(~inside) - 0.5
    )
    points, quads = surface_nets(values)
    near = np.nonzero(np.abs(distance) < BAND)
    exact = distance_to_triangles(
        np.stack(near, 1).astype(float), points, triangles_of(points, quads)
    )
    distance[near] = np.where(inside[near], -exact, exact)
    return distance


PARTS = 4
"""Samples per voxel and axis for volumes."""


def enclosed_volume(distance: np.ndarray, voxel: float) -> float:
    """Volume [m³] where the trilinear field of samples (n, m, l) [m] is negative; fine
    samples at the border count in part."""
    lowest = np.minimum.reduce(_corners(distance))
    highest = np.maximum.reduce(_corners(distance))
    cut = np.nonzero((lowest < voxel) & (highest > -voxel))
    full = float(np.count_nonzero(highest <= -voxel))
    corners = np.stack([corner[cut] for corner in _corners(distance)])
    t = (np.arange(PARTS) + 0.5) / PARTS
    for x, y, z in np.stack(np.meshgrid(t, t, t), -1).reshape(-1, 3):
        weights = [a * b * c for a in (1 - x, x) for b in (1 - y, y) for c in (1 - z, z)]
        fine = np.tensordot(weights, corners, 1) * PARTS / voxel
        full += float(np.clip(0.5 - fine, 0.0, 1.0).sum()) / PARTS**3
    return full * voxel**3


def _corners(samples: np.ndarray) -> list[np.ndarray]:
    """The samples at the eight corners of every cell between samples."""
    ends = (slice(None, -1), slice(1, None))
    return [samples[a, b, c] for a in ends for b in ends for c in ends]
