"""Surfaces of quadrilaterals around the negative part of a sampled field.

Surface nets: one point in each cell of the lattice through which the zero level runs,
one quadrilateral for each edge of the lattice that it crosses.
"""

import numpy as np
from scipy.spatial import cKDTree

EDGES = [(a, axis) for axis in range(3) for a in range(4)]


def surface_nets(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) in units of the lattice and outward quadrilaterals (m, 4) around the
    negative part of values[i, j, k]. Each point is the mean of the crossings of its cell."""
    inside = values < 0.0
    cells = np.array(values.shape) - 1
    total, count = np.zeros((*cells, 3)), np.zeros(cells)
    quads = []
    for axis in range(3):
        first, second = [np.take(values, range(*r), axis) for r in _ends(values.shape[axis])]
        crossing = np.argwhere((first < 0.0) != (second < 0.0))
        others = [k for k in range(3) if k != axis]
        within = np.all((crossing[:, others] > 0) & (crossing[:, others] < cells[others]), axis=1)
        crossing = crossing[within]
        low, high = first[tuple(crossing.T)], second[tuple(crossing.T)]
        point = crossing.astype(float)
        point[:, axis] += low / (low - high)
        around = _cells_around(crossing, axis)
        for cell in around:
            np.add.at(total, tuple(cell.T), point)
            np.add.at(count, tuple(cell.T), 1.0)
        order = np.stack([np.ravel_multi_index(tuple(cell.T), cells) for cell in around], 1)
        leaving = inside[tuple(crossing.T)]
        order[~leaving] = order[~leaving][:, ::-1]
        quads.append(order)
    used, quads = np.unique(np.vstack(quads), return_inverse=True)
    total, count = total.reshape(-1, 3)[used], count.reshape(-1)[used]
    return total / count[:, None], quads.reshape(-1, 4)


def _ends(size: int) -> tuple:
    return (0, size - 1), (1, size)


def _cells_around(edges: np.ndarray, axis: int) -> list[np.ndarray]:
    """The four cells around lattice edges along an axis, anticlockwise about it."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    cells = []
    for back_a, back_b in ((1, 1), (0, 1), (0, 0), (1, 0)):
        cell = edges.copy()
        cell[:, a] -= back_a
        cell[:, b] -= back_b
        cells.append(cell)
    return cells


def triangles_of(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Two triangles (2 m, 3) for each quadrilateral, along its shorter diagonal."""

    def diagonal(a, b):
        return np.linalg.norm(points[quads[:, a]] - points[quads[:, b]], axis=1)

    first = diagonal(0, 2) <= diagonal(1, 3)
    p, q = quads[first], quads[~first]
    return np.vstack([p[:, [0, 1, 2]], p[:, [0, 2, 3]], q[:, [0, 1, 3]], q[:, [1, 2, 3]]])


def distance_to_triangles(at: np.ndarray, points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Distances (n,) of positions (n, 3) to the nearest of the triangles whose centres are
    nearest."""
    nearest = 24
    tree = cKDTree(points[triangles].mean(axis=1))
    best = np.empty(len(at))
    for start in range(0, len(at), 20000):
        some = at[start : start + 20000]
        candidates = tree.query(some, nearest)[1]
        corners = points[triangles[candidates]]
        best[start : start + 20000] = _to_triangle(some[:, None, :], corners).min(axis=1)
    return best


def _to_triangle(at: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Distances (n, k) of positions (n, 1, 3) to triangles (n, k, 3, 3)."""
    distance = np.full(corners.shape[:2], np.inf)
    for n in range(3):
        start, edge = corners[..., n, :], corners[..., (n + 1) % 3, :] - corners[..., n, :]
        length = np.maximum((edge**2).sum(-1), 1e-30)
        along = np.clip(((at - start) * edge).sum(-1) / length, 0.0, 1.0)
        distance = np.minimum(
            distance, np.linalg.norm(at - start - along[..., None] * edge, axis=-1)
        )
    a, b, c = (corners[..., n, :] for n in range(3))
    normal = np.cross(b - a, c - a)
    square = np.maximum((normal**2).sum(-1), 1e-30)
    arm = at - a
    second = (np.cross(arm, c - a) * normal).sum(-1) / square
    third = (np.cross(b - a, arm) * normal).sum(-1) / square
    within = (second >= 0.0) & (third >= 0.0) & (second + third <= 1.0)
    height = np.abs((arm * normal).sum(-1)) / np.sqrt(square)
    return np.where(within, np.minimum(distance, height), distance)
