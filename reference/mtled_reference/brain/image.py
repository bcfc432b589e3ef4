"""The label map of the brain slice as smooth signed distances.

The body of the case is not made of voxels but has a smooth outline: the 0/1 image is
smoothed by a Gaussian with a standard deviation of 0.7 voxels, after which no voxel is on
another side, and the distance to its level 1/2 is shifted so that the enclosed area is
that of the voxels.
"""

import gzip
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.ndimage import correlate1d, distance_transform_edt
from scipy.optimize import brentq

SMOOTHING = 0.7
"""Standard deviation of the Gaussian [voxel], which is truncated at three voxels; the largest
of one pass where more smoothing is wanted."""
SIDE = 0.01
"""Distance of the values of voxels from 1/2 after a pass [–]."""
MARGIN = 12
"""Empty space around the image, which contains the skull [voxel]."""
MILLIMETRE = 1e-3


@dataclass(frozen=True)
class Slice:
    """Labels of one layer of voxels, labels[i, j] centred at `corner` + voxel·(i, j) [m],
    x right and y anterior."""

    labels: np.ndarray
    corner: np.ndarray
    voxel: float

    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates of the voxel centres [m]."""
        return tuple(
            self.corner[axis] + self.voxel * np.arange(self.labels.shape[axis]) for axis in (0, 1)
        )


def read_voxels(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Labels[i, j, k] of an NRRD file of gzipped bytes with directions along the axes, the
    centre (3,) [m] of the first voxel and the edges (3,) [m] of a voxel."""
    header, data = path.read_bytes().split(b"\n\n", 1)
    field = dict(line.split(": ", 1) for line in header.decode().splitlines()[1:] if ": " in line)
    if (field["type"], field["encoding"]) != ("unsigned char", "gzip"):
        raise ValueError(f"{path.name}: type or encoding is not supported")
    sizes = [int(size) for size in field["sizes"].split()]
    rows = [np.fromstring(row.strip("()"), sep=",") for row in field["space directions"].split()]
    step, origin = np.array(rows), np.fromstring(field["space origin"].strip("()"), sep=",")
    if field["space"] == "left-posterior-superior":
        flip = np.array([-1.0, -1.0, 1.0])
        step, origin = step * flip, origin * flip
    edges = np.diag(step) * MILLIMETRE
    if np.any(step != np.diag(np.diag(step))) or np.any(edges <= 0.0) or edges[0] != edges[1]:
        raise ValueError(f"{path.name}: voxels must be square and aligned with the axes")
    labels = np.frombuffer(gzip.decompress(data), np.uint8).reshape(sizes[::-1]).T
    return labels, origin * MILLIMETRE, edges


def read_slice(path: Path, z: float) -> Slice:
    """The layer of voxels at height z [m] of an NRRD file."""
    voxels, origin, edges = read_voxels(path)
    layer = int(np.clip(round((z - origin[2]) / edges[2]), 0, voxels.shape[2] - 1))
    labels = np.pad(voxels[:, :, layer], MARGIN)
    return Slice(labels, origin[:2] - MARGIN * edges[0], edges[0])


def signed_distance(image: Slice, labels: list[int]) -> np.ndarray:
    """Signed distance [m] of the voxel centres to the smooth outline of some labels,
    negative inside."""
    chosen = np.isin(image.labels, labels)
    distance = _distance_to_level(0.5 - smoothed(chosen, SMOOTHING)) * image.voxel
    return enclosing(distance, image.voxel, enclosed_area, chosen.sum() * image.voxel**2)


def smoothed(chosen: np.ndarray, smoothing: float) -> np.ndarray:
    """The 0/1 image smoothed with a standard deviation [voxel] without voxels changing sides."""
    passes = int(np.ceil((smoothing / SMOOTHING) ** 2 - 1e-9))
    kernel = np.exp(-0.5 * (np.arange(-3, 4) * np.sqrt(passes) / smoothing) ** 2)
    level = chosen.astype(float)
    for _ in range(passes):
        for axis in range(chosen.ndim):
            level = correlate1d(level, kernel / kernel.sum(), axis=axis, mode="constant")
        level = np.where(chosen, np.maximum(level, 0.5 + SIDE), np.minimum(level, 0.5 - SIDE))
    return level


def enclosing(
    distance: np.ndarray,
    voxel: float,
    enclosed: Callable[[np.ndarray, float], float],
    size: float,
) -> np.ndarray:
    """The distance [m] shifted by a constant, so that it encloses an area or a volume."""
    shift = brentq(lambda s: enclosed(distance - s, voxel) - size, -voxel, voxel, xtol=1e-9)
    return distance - shift


PARTS = 4
"""Samples per voxel along each axis for distances and areas."""


def _finer(values: np.ndarray) -> np.ndarray:
    """Values interpolated bilinearly on a grid PARTS times as fine, with the same ends."""
    for axis in (0, 1):
        n = values.shape[axis]
        at = np.arange((n - 1) * PARTS + 1) / PARTS
        low = np.minimum(at.astype(int), n - 2)
        upper = (at - low).reshape((-1, 1) if axis == 0 else (1, -1))
        values = values.take(low, axis) * (1.0 - upper) + values.take(low + 1, axis) * upper
    return values


def _distance_to_level(values: np.ndarray) -> np.ndarray:
    """Signed distance [voxel] of the samples to the zero level of the field.

    The level lies between samples of the finer grid, on average half a fine step before
    the nearest sample on the other side.
    """
    inside = _finer(values) < 0.0
    outwards, inwards = distance_transform_edt(~inside), distance_transform_edt(inside)
    signed = np.where(inside, 0.5 - inwards, outwards - 0.5) / PARTS
    return signed[::PARTS, ::PARTS]


def enclosed_area(distance: np.ndarray, voxel: float) -> float:
    """Area [m²] where the distance is negative; fine samples at the border count in part."""
    fine = _finer(distance) * PARTS / voxel
    return float(np.clip(0.5 - fine, 0.0, 1.0).sum()) * (voxel / PARTS) ** 2
