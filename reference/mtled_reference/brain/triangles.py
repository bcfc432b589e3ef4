"""Triangles whose edges follow the outline and the borders of the brain slice.

Nodes are first placed along every curve and fixed there. Inner nodes start on a lattice
and are moved by the forces of bars along the edges between Delaunay triangulations,
after Persson and Strang, SIAM Review 46, 329, 2004.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import Delaunay, cKDTree

from ..shared.polygon import inside_polygon
from .body import Body
from .outline import Curve

ROUNDS = 60
"""Number of triangulations while the inner nodes move."""


@dataclass(frozen=True)
class Sizes:
    """Target edge lengths [m] far away, on the outline, on inner borders and at the ends
    of the craniotomy, and their growth with the distance from the latter three [–]."""

    far: float
    outline: float
    border: float
    end: float
    growth: float = 0.3

    def scaled(self, factor: float) -> "Sizes":
        """All sizes and their growth times `factor`."""
        parts = (self.far, self.outline, self.border, self.end, self.growth)
        return Sizes(*(factor * part for part in parts))


@dataclass(frozen=True)
class Triangles:
    """Points (n, 2) [m], anticlockwise corners (m, 3) and regions (m,); the edges (k, 2)
    along curves, the curve of each with its start and end [m], and which of the edges (k,)
    lie on the outline and in the craniotomy."""

    points: np.ndarray
    corners: np.ndarray
    region: np.ndarray
    curve_edges: np.ndarray
    arcs: list
    on_outline: np.ndarray
    constrained: np.ndarray

    def on_curves(self, fraction: float) -> np.ndarray:
        """Points (k, 2) [m] of the curves at a fraction of each edge in `curve_edges`."""
        return np.vstack([curve.at(s + fraction * (end - s)) for curve, s, end in self.arcs])

    def midpoints(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Midpoints (k, 2) [m] of all edges, on the curves where there are curves; the
        numbers (m, 3) of the edges of each triangle, from corner 0 to 1, 1 to 2, 2 to 0; and
        those of `curve_edges`."""
        edges, numbers = np.unique(_edges(self.corners), axis=0, return_inverse=True)
        midpoints = self.points[edges].mean(axis=1)
        curved = edge_numbers(edges, self.curve_edges)
        midpoints[curved] = self.on_curves(0.5)
        return midpoints, numbers.reshape(-1, 3), curved


def _edges(corners: np.ndarray) -> np.ndarray:
    """The edges (3 m, 2) of triangles (m, 3) in turn, each from the lower number."""
    return np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)


def edge_numbers(edges: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """The rows of the pairs, in either order, among sorted edges (n, 2)."""
    index = {tuple(edge): n for n, edge in enumerate(edges.tolist())}
    return np.array([index[tuple(pair)] for pair in np.sort(pairs, axis=1).tolist()])


class SizeField:
    """Target size [m] at points: the least over all features, growing with the distance."""

    def __init__(self, body: Body, sizes: Sizes):
        borders = np.vstack([curve.polygon(0.001) for curve, _ in body.borders])
        self.sizes = sizes
        self.features = [
            (cKDTree(body.outline.polygon(0.001)), sizes.outline),
            (cKDTree(borders), sizes.border),
            (cKDTree(body.outline.at(np.array(body.craniotomy))), sizes.end),
        ]

    def __call__(self, points: np.ndarray) -> np.ndarray:
        size = np.full(len(points), self.sizes.far)
        for tree, smallest in self.features:
            size = np.minimum(size, smallest + self.sizes.growth * tree.query(points)[0])
        return size


def triangulate(body: Body, sizes: Sizes) -> Triangles:
    """A triangulation of the slice with edges of about the target sizes."""
    size = SizeField(body, sizes)
    stops = np.array(body.craniotomy)
    chains = [_chain(body.outline, size, stops)]
    chains += [_chain(curve, size, np.array([0.0])) for curve, _ in body.borders]
    curves = [body.outline] + [curve for curve, _ in body.borders]
    fixed = np.vstack([curve.at(s) for curve, s in zip(curves, chains)])
    arcs = [(c, s, np.append(s[1:], s[0] + c.length)) for c, s in zip(curves, chains)]
    edges = _curve_edges(chains)
    inner = _lattice(body, size, fixed)
    points, corners = _relaxed(body, size, fixed, inner)
    _check_edges(corners, edges)
    centroids = points[corners].mean(axis=1)
    region = np.full(len(corners), body.outer_region)
    for curve, index in body.borders:
        region[inside_polygon(centroids, curve.polygon(1e-3))] = index
    on_outline = np.arange(len(edges)) < len(chains[0])
    constrained = np.zeros(len(edges), bool)
    constrained[on_outline] = _inside_arc(arcs[0], body.craniotomy)
    return Triangles(points, corners, region, edges, arcs, on_outline, constrained)


def _chain(curve: Curve, size: SizeField, stops: np.ndarray) -> np.ndarray:
    """Parameters [m] of nodes along a closed curve, which include the stops."""
    stops = np.sort(stops)
    chain = []
    for start, end in zip(stops, np.append(stops[1:], stops[0] + curve.length)):
        s = np.linspace(start, end, 4001)
        density = 1.0 / size(curve.at(s))
        count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))])
        steps = max(3, int(np.ceil(count[-1])))
        chain.append(np.interp(np.arange(steps) * count[-1] / steps, count, s))
    return np.concatenate(chain)


def _curve_edges(chains) -> np.ndarray:
    edges, first = [], 0
    for s in chains:
        own = first + np.arange(len(s))
        edges.append(np.column_stack([own, np.roll(own, -1)]))
        first += len(s)
    return np.vstack(edges)


def _inside_arc(edges, arc: tuple[float, float]) -> np.ndarray:
    """Which edges of the outline lie in an arc of it."""
    curve, start, end = edges
    return np.mod(0.5 * (start + end) - arc[0], curve.length) < arc[1] - arc[0]


def _lattice(body: Body, size: SizeField, fixed: np.ndarray) -> np.ndarray:
    """Inner nodes: those of a triangular lattice of the smallest size, chosen at random
    with the probability of the target density, and none close to a curve."""
    sizes = size.sizes
    step = min(sizes.far, sizes.outline, sizes.border, sizes.end)
    low, high = fixed.min(axis=0), fixed.max(axis=0)
    rows = np.arange(low[1], high[1], step * np.sqrt(0.75))
    points = np.vstack(
        [
            np.column_stack([x, np.full(len(x), y)])
            for n, y in enumerate(rows)
            for x in [np.arange(low[0] + 0.5 * step * (n % 2), high[0], step)]
        ]
    )
    random = np.random.default_rng(7).random(len(points))
    points = points[random < (step / size(points)) ** 2]
    points = points[inside_polygon(points, body.outline.polygon(1e-3))]
    return _off_curves(points, size, fixed)


def _off_curves(points, size, fixed) -> np.ndarray:
    """The points that are not too close to the fixed nodes."""
    return points[cKDTree(fixed).query(points)[0] > 0.6 * size(points)]


def _relaxed(body, size, fixed, inner):
    """Moves inner nodes by the forces of bars that push where they are too short; returns
    points and corners."""
    outline = body.outline.polygon(1e-3)
    points = np.vstack([fixed, inner])
    for step in range(ROUNDS):
        corners = _delaunay(points, outline)
        bars = np.unique(_edges(corners), axis=0)
        vector = points[bars[:, 0]] - points[bars[:, 1]]
        length = np.linalg.norm(vector, axis=1)
        target = size(points[bars].mean(axis=1))
        target *= 1.15 * np.sqrt(np.sum(length**2) / np.sum(target**2))
        push = (np.maximum(target - length, 0.0) / length)[:, None] * vector
        force = np.zeros_like(points)
        np.add.at(force, bars[:, 0], push)
        np.subtract.at(force, bars[:, 1], push)
        force[: len(fixed)] = 0.0
        points = points + 0.2 * force
        if step in (10, 25, 40):
            keep = _off_curves(points[len(fixed) :], size, fixed)
            keep = keep[inside_polygon(keep, outline)]
            points = np.vstack([fixed, keep])
    for _ in range(4):
        points = _smoothed(points, _delaunay(points, outline), len(fixed))
    return points, _delaunay(points, outline)


def _smoothed(points, corners, fixed: int) -> np.ndarray:
    """Inner nodes moved half-way to the area-weighted centre of the triangles around."""
    areas = np.abs(signed_areas(points, corners))
    total, moment = np.zeros(len(points)), np.zeros_like(points)
    for n in range(3):
        np.add.at(total, corners[:, n], areas)
        np.add.at(moment, corners[:, n], areas[:, None] * points[corners].mean(axis=1))
    moved = points.copy()
    moved[fixed:] = 0.5 * (points[fixed:] + moment[fixed:] / total[fixed:, None])
    return moved


def _delaunay(points: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Anticlockwise triangles with their centres in the body."""
    corners = Delaunay(points).simplices
    clockwise = signed_areas(points, corners) < 0.0
    corners[clockwise] = corners[clockwise][:, ::-1]
    return corners[inside_polygon(points[corners].mean(axis=1), outline)]


def signed_areas(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Areas (m,) [m²] of triangles, positive where they are anticlockwise."""
    first, second, third = points[corners].transpose(1, 0, 2)
    a, b = second - first, third - first
    return 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _check_edges(corners: np.ndarray, edges: np.ndarray) -> None:
    """Refuses a triangulation without one of the edges along curves."""
    present = {tuple(edge) for edge in _edges(corners).tolist()}
    missing = [edge for edge in np.sort(edges, axis=1).tolist() if tuple(edge) not in present]
    if missing:
        raise ValueError(f"{len(missing)} edges along curves are missing in the triangulation")
