"""Closed curves around the body, the ventricles and the tumour.

Marching squares on the signed distance give polygons. A Gaussian along the arc removes
the traces of the voxels, a shift along the normal restores the area, and periodic
splines interpolate the points.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

KNOT_SPACING = 0.001
"""Distance of the interpolation points of a spline [m]."""


@dataclass(frozen=True)
class Curve:
    """A closed curve over the arc length (approximately), with the inside to its left."""

    length: float
    spline: CubicSpline

    def at(self, s) -> np.ndarray:
        """Points (n, 2) [m] at parameters s [m]."""
        return self.spline(np.mod(s, self.length))

    def polygon(self, spacing: float) -> np.ndarray:
        """Points (n, 2) [m] that are about `spacing` [m] apart."""
        count = int(np.ceil(self.length / spacing))
        return self.at(self.length * np.arange(count) / count)


def area(points: np.ndarray) -> float:
    """Signed area [m²] of a polygon (n, 2) [m], positive if it is anticlockwise."""
    following = np.roll(points, -1, axis=0)
    return 0.5 * float(np.sum(points[:, 0] * following[:, 1] - following[:, 0] * points[:, 1]))


SMALLEST = 1e-5
"""Parts with a smaller area [m²] are ignored."""


def curves_around(distance: np.ndarray, axes, smoothing: float) -> list[Curve]:
    """Curves around the parts with a negative distance, smoothed along the arc with a
    standard deviation of `smoothing` [m]."""
    polygons = [p for p in level_polygons(distance, axes) if abs(area(p)) > SMALLEST]
    return [smooth_curve(polygon, smoothing) for polygon in polygons]


def level_polygons(values: np.ndarray, axes) -> list[np.ndarray]:
    """Polygons along the zero level of samples values[i, j], which are negative on the left."""
    following = {}
    crossing = {}
    corners = ((0, 0), (1, 0), (1, 1), (0, 1))
    inside = values < 0.0
    mixed = inside[:-1, :-1].astype(int) + inside[1:, :-1] + inside[1:, 1:] + inside[:-1, 1:]
    for i, j in zip(*np.nonzero((mixed > 0) & (mixed < 4))):
        square = [(i + a, j + b) for a, b in corners]
        edges = [(square[n], square[(n + 1) % 4]) for n in range(4)]
        leaves = [n for n in range(4) if inside[edges[n][0]] and not inside[edges[n][1]]]
        joined = sum(values[c] for c in square) < 0.0
        for n in leaves:
            order = [(n + k if joined else n - k) % 4 for k in (1, 2, 3)]
            back = next(m for m in order if inside[edges[m][1]] and not inside[edges[m][0]])
            keys = [tuple(sorted(edges[m])) for m in (n, back)]
            following[keys[0]] = keys[1]
            for key in keys:
                crossing[key] = _crossing(values, axes, *key)
    return _chains(following, crossing)


def _crossing(values, axes, a, b) -> np.ndarray:
    fraction = values[a] / (values[a] - values[b])
    start, end = (np.array([axes[0][c[0]], axes[1][c[1]]]) for c in (a, b))
    return start + fraction * (end - start)


def _chains(following: dict, crossing: dict) -> list[np.ndarray]:
    polygons = []
    while following:
        at = min(following)
        points = []
        while at in following:
            points.append(crossing[at])
            at = following.pop(at)
        polygons.append(np.array(points))
    return polygons


def smooth_curve(polygon: np.ndarray, smoothing: float) -> Curve:
    """A smooth spline near the polygon that encloses the same area."""
    points, spacing = _evenly(polygon, KNOT_SPACING)
    frequency = 2.0 * np.pi * np.fft.fftfreq(len(points), spacing)
    damping = np.exp(-0.5 * (frequency * smoothing) ** 2)[:, None]
    smooth = np.fft.ifft(np.fft.fft(points, axis=0) * damping, axis=0).real
    for _ in range(3):
        tangent = np.roll(smooth, -1, axis=0) - np.roll(smooth, 1, axis=0)
        lengths = np.linalg.norm(tangent, axis=1, keepdims=True)
        outward = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / lengths
        smooth = smooth + outward * (area(points) - area(smooth)) / (0.5 * lengths.sum())
    knots, spacing = _evenly(smooth, KNOT_SPACING)
    length = spacing * len(knots)
    closed = np.vstack([knots, knots[:1]])
    spline = CubicSpline(spacing * np.arange(len(closed)), closed, bc_type="periodic")
    return Curve(length, spline)


def _evenly(polygon: np.ndarray, spacing: float) -> tuple[np.ndarray, float]:
    """Points on the polygon at equal distances of about `spacing` [m], and that distance."""
    closed = np.vstack([polygon, polygon[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    count = max(8, round(arc[-1] / spacing))
    at = arc[-1] * np.arange(count) / count
    return np.column_stack([np.interp(at, arc, closed[:, k]) for k in (0, 1)]), arc[-1] / count
