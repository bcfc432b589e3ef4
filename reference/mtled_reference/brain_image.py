"""The label map of the brain slice as smooth signed distances.

The body of the case is not the voxels but a smooth outline around them: the 0/1
image is smoothed by a Gaussian of 0.7 voxels, the distance to its 1/2 level is
shifted so that the enclosed area is that of the voxels. Positions in metres,
areas in square metres.
"""

import gzip
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.ndimage import correlate1d, distance_transform_edt
from scipy.optimize import brentq

SMOOTHING = 0.7
"""Standard deviation of the Gaussian [voxel], cut off after three voxels."""
MARGIN = 12
"""Voxels of empty space around the image; the skull lies in it."""
MILLIMETRE = 1e-3


@dataclass(frozen=True)
class Slice:
    """Labels of one layer of voxels, labels[i, j] centred at `corner` + voxel·(i, j),
    x right and y anterior."""

    labels: np.ndarray
    corner: np.ndarray
    voxel: float

    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates of the voxel centres [m]."""
        return tuple(
            self.corner[axis] + self.voxel * np.arange(self.labels.shape[axis]) for axis in (0, 1)
        )

    def label_at(self, points: np.ndarray) -> np.ndarray:
        """Label of the voxel that contains each point (n, 2), 0 outside."""
        index = np.floor((points - self.corner) / self.voxel + 0.5).astype(int)
        within = np.all((index >= 0) & (index < self.labels.shape), axis=1)
        index[~within] = 0
        return np.where(within, self.labels[index[:, 0], index[:, 1]], 0)


def read_slice(path: Path, z: float) -> Slice:
    """The layer of voxels at height z [m] of an NRRD file with bytes in gzip whose
    directions run along the axes."""
    header, data = path.read_bytes().split(b"\n\n", 1)
    field = dict(
        line.split(": ", 1) for line in header.decode().splitlines()[1:] if ": " in line
    )
    if (field["type"], field["encoding"]) != ("unsigned char", "gzip"):
        raise ValueError(f"{path.name}: the type or the encoding is not read here")
    sizes = [int(size) for size in field["sizes"].split()]
    rows = [np.fromstring(row.strip("()"), sep=",") for row in field["space directions"].split()]
    step, origin = np.array(rows), np.fromstring(field["space origin"].strip("()"), sep=",")
    if field["space"] == "left-posterior-superior":
        flip = np.array([-1.0, -1.0, 1.0])
        step, origin = step * flip, origin * flip
    edges = np.diag(step) * MILLIMETRE
    if np.any(step != np.diag(np.diag(step))) or np.any(edges <= 0.0) or edges[0] != edges[1]:
        raise ValueError(f"{path.name}: the voxels are not square and along the axes")
    origin = origin * MILLIMETRE
    layer = int(np.clip(round((z - origin[2]) / edges[2]), 0, sizes[2] - 1))
    voxels = np.frombuffer(gzip.decompress(data), np.uint8).reshape(sizes[::-1])
    labels = np.pad(voxels[layer].T, MARGIN)
    return Slice(labels, origin[:2] - MARGIN * edges[0], edges[0])


def signed_distance(image: Slice, labels: list[int]) -> np.ndarray:
    """Signed distance [m] on the voxel centres to the smooth outline of some labels,
    negative inside."""
    chosen = np.isin(image.labels, labels)
    kernel = np.exp(-0.5 * (np.arange(-3, 4) / SMOOTHING) ** 2)
    level = chosen.astype(float)
    for axis in (0, 1):
        level = correlate1d(level, kernel / kernel.sum(), axis=axis, mode="constant")
    distance = _distance_to_level(0.5 - level) * image.voxel
    area = chosen.sum() * image.voxel**2
    shift = brentq(
        lambda s: enclosed_area(distance - s, image.voxel) - area,
        -image.voxel,
        image.voxel,
        xtol=1e-9,
    )
    return distance - shift


PARTS = 4
"""Finer samples per voxel for distances and areas."""


def _finer(values: np.ndarray) -> np.ndarray:
    """Bilinear values on a grid PARTS times as fine, with the same ends."""
    for axis in (0, 1):
        n = values.shape[axis]
        at = np.arange((n - 1) * PARTS + 1) / PARTS
        low = np.minimum(at.astype(int), n - 2)
        share = (at - low).reshape((-1, 1) if axis == 0 else (1, -1))
        values = values.take(low, axis) * (1.0 - share) + values.take(low + 1, axis) * share
    return values


def _distance_to_level(values: np.ndarray) -> np.ndarray:
    """Signed distance [voxel] on the samples to the zero level of the field.

    The level is crossed between samples of the finer grid; the nearest sample on
    the other side is half a fine step beyond it, so that the mean of the two
    one-sided distances is used.
    """
    inside = _finer(values) < 0.0
    outwards, inwards = distance_transform_edt(~inside), distance_transform_edt(inside)
    signed = np.where(inside, 0.5 - inwards, outwards - 0.5) / PARTS
    return signed[::PARTS, ::PARTS]


def enclosed_area(distance: np.ndarray, voxel: float) -> float:
    """Area [m²] below zero; the border of fine samples counts in part."""
    fine = _finer(distance) * PARTS / voxel
    return float(np.clip(0.5 - fine, 0.0, 1.0).sum()) * (voxel / PARTS) ** 2
