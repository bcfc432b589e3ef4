"""Triangles whose edges follow the outline and the borders of the brain slice.

Nodes are laid along every curve first and stay there; nodes inside start on a
lattice and are moved to the middle of their neighbours between Delaunay
triangulations (Persson and Strang, SIAM Review 46, 329, 2004, in spirit).
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import Delaunay, cKDTree

from .brain_body import Body
from .brain_outline import Curve

ROUNDS = 60
"""Triangulations while the inner nodes move."""


@dataclass(frozen=True)
class Sizes:
    """Wanted edge lengths [m]: far away, on the outline, on inner borders, at the
    craniotomy's ends; their growth with the distance from the latter three [–]."""

    far: float
    outline: float
    border: float
    end: float
    growth: float = 0.3

    def scaled(self, factor: float) -> "Sizes":
        """The same pattern of sizes, everywhere `factor` times as large."""
        parts = (self.far, self.outline, self.border, self.end, self.growth)
        return Sizes(*(factor * part for part in parts))


@dataclass(frozen=True)
class Triangles:
    """points (n, 2) [m], corners (m, 3) anticlockwise, region (m,); the edges (k, 2)
    that follow curves, of those the ones on the outline, and of these the ones that
    the craniotomy holds."""

    points: np.ndarray
    corners: np.ndarray
    region: np.ndarray
    curve_edges: np.ndarray
    arcs: list
    on_outline: np.ndarray
    held: np.ndarray

    def on_curves(self, share: float) -> np.ndarray:
        """Points (k, 2) of the curves at a share of each edge in `curve_edges`."""
        return np.vstack([curve.at(s + share * (end - s)) for curve, s, end in self.arcs])


class SizeField:
    """The size wanted at a point: that of the nearest feature, growing away from it."""

    def __init__(self, body: Body, sizes: Sizes):
        borders = np.vstack([curve.polygon(0.001) for curve, _ in body.borders])
        self.sizes = sizes
        self.features = [
            (cKDTree(body.outline.polygon(0.001)), sizes.outline),
            (cKDTree(borders), sizes.border),
            (cKDTree(body.outline.at(np.array(body.held))), sizes.end),
        ]

    def __call__(self, points: np.ndarray) -> np.ndarray:
        size = np.full(len(points), self.sizes.far)
        for tree, smallest in self.features:
            size = np.minimum(size, smallest + self.sizes.growth * tree.query(points)[0])
        return size


def triangulate(body: Body, sizes: Sizes) -> Triangles:
    """A triangulation of the slice with edges of about the wanted sizes."""
    size = SizeField(body, sizes)
    stops = np.array(body.held)
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
    held = np.zeros(len(edges), bool)
    held[on_outline] = _held(arcs[0], body.held)
    return Triangles(points, corners, region, edges, arcs, on_outline, held)


def _chain(curve: Curve, size: SizeField, stops: np.ndarray) -> np.ndarray:
    """Parameters of nodes along a closed curve, the stops among them."""
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


def _held(arcs, stretch: tuple[float, float]) -> np.ndarray:
    """Which arcs of the outline lie in the stretch that is held."""
    curve, start, end = arcs
    return np.mod(0.5 * (start + end) - stretch[0], curve.length) < stretch[1] - stretch[0]


def _lattice(body: Body, size: SizeField, fixed: np.ndarray) -> np.ndarray:
    """Inner nodes: of a triangular lattice of the smallest size, taken at random in
    proportion to the density wanted, none close to a curve."""
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
    wanted = size(points)
    chance = np.random.default_rng(7).random(len(points))
    points = points[chance < (step / wanted) ** 2]
    points = points[inside_polygon(points, body.outline.polygon(1e-3))]
    return _off_curves(points, size, fixed)


def _off_curves(points, size, fixed) -> np.ndarray:
    return points[cKDTree(fixed).query(points)[0] > 0.6 * size(points)]


def _relaxed(body, size, fixed, inner):
    """Moves inner nodes by the forces of bars that push if they are too short."""
    outline = body.outline.polygon(1e-3)
    points = np.vstack([fixed, inner])
    for step in range(ROUNDS):
        corners = _delaunay(points, outline)
        bars = np.unique(np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
        vector = points[bars[:, 0]] - points[bars[:, 1]]
        length = np.linalg.norm(vector, axis=1)
        wanted = size(points[bars].mean(axis=1))
        wanted *= 1.15 * np.sqrt(np.sum(length**2) / np.sum(wanted**2))
        push = (np.maximum(wanted - length, 0.0) / length)[:, None] * vector
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
        points = _middled(points, _delaunay(points, outline), len(fixed))
    return points, _delaunay(points, outline)


def _middled(points, corners, fixed: int) -> np.ndarray:
    """Inner nodes half-way to the area-weighted middle of the triangles around them."""
    triangle = points[corners]
    a, b = triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
    weight = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    total, moment = np.zeros(len(points)), np.zeros_like(points)
    for n in range(3):
        np.add.at(total, corners[:, n], weight)
        np.add.at(moment, corners[:, n], weight[:, None] * triangle.mean(axis=1))
    moved = points.copy()
    moved[fixed:] = 0.5 * (points[fixed:] + moment[fixed:] / total[fixed:, None])
    return moved


def _delaunay(points: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Anticlockwise triangles whose middle lies in the body."""
    corners = Delaunay(points).simplices
    first, second, third = points[corners].transpose(1, 0, 2)
    a, b = second - first, third - first
    turned = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0.0
    corners[turned] = corners[turned][:, ::-1]
    return corners[inside_polygon(points[corners].mean(axis=1), outline)]


def _check_edges(corners: np.ndarray, edges: np.ndarray) -> None:
    """Every edge laid along a curve must be an edge of triangles."""
    present = np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    known = {tuple(edge) for edge in present.tolist()}
    missing = [edge for edge in np.sort(edges, axis=1).tolist() if tuple(edge) not in known]
    if missing:
        raise ValueError(f"{len(missing)} edges along curves are no edges of triangles")


def inside_polygon(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Even–odd rule for points (n, 2) and a closed polygon (m, 2)."""
    odd = np.zeros(len(points), dtype=bool)
    for start, end in zip(corners, np.roll(corners, -1, axis=0)):
        crosses = (start[1] > points[:, 1]) != (end[1] > points[:, 1])
        if crosses.any():
            slope = (end[0] - start[0]) / (end[1] - start[1])
            x = start[0] + slope * (points[crosses, 1] - start[1])
            odd[crosses] ^= points[crosses, 0] < x
    return odd
