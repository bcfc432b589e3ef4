"""Triangles of the bar of Turek and Hron, fine at the arc and coarse along the bar."""

import numpy as np


def bar_triangles(corners: np.ndarray, refinements: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) [m] and triangles of order 1 in the polygon `corners` (11, 2), which
    starts with the two corners of the free end and has the arc from top to bottom.

    The unrefined mesh has the eight sides of the arc and two rows along the bar; each
    refinement divides every triangle into four.
    """
    arc = corners[2:][::-1]
    low, high, end = corners[0, 1], corners[1, 1], corners[0, 0]
    start = arc[:, 0].max()
    side = (high - low) / (len(arc) - 1)
    columns = [arc]
    near = [(start + side, 8), (start + 3.0 * side, 4), (start + 7.0 * side, 2)]
    rest = np.linspace(near[-1][0], end, 1 + round((end - near[-1][0]) / (4.0 * side)))
    for x, rows in near + [(x, 2) for x in rest[1:]]:
        y = np.linspace(low, high, rows + 1)
        columns.append(np.stack([np.full_like(y, x), y], axis=1))
    points, triangles, offset = np.concatenate(columns), [], 0
    for left, right in zip(columns, columns[1:]):
        triangles += _strip(len(left), len(right), offset)
        offset += len(left)
    triangles = np.array(triangles)
    for _ in range(refinements):
        points, triangles = _refined(points, triangles)
    return points, triangles


def _strip(left: int, right: int, offset: int) -> list[tuple[int, int, int]]:
    """Triangles between two columns of points, each from bottom to top."""
    triangles, i, j = [], 0, 0
    while i < left - 1 or j < right - 1:
        behind = (i + 1) / (left - 1) if i < left - 1 else 2.0
        ahead = (j + 1) / (right - 1) if j < right - 1 else 2.0
        a, b = offset + i, offset + left + j
        if behind <= ahead:
            triangles.append((a, b, a + 1))
            i += 1
        else:
            triangles.append((a, b, b + 1))
            j += 1
    return triangles


def _refined(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each triangle divided into four at the midpoints of its sides."""
    sides = np.sort(triangles[:, [[1, 2], [0, 2], [0, 1]]].reshape(-1, 2), axis=1)
    sides, numbers = np.unique(sides, axis=0, return_inverse=True)
    a, b, c = triangles.T
    opposite_a, opposite_b, opposite_c = (np.ravel(numbers).reshape(-1, 3) + len(points)).T
    new = [
        (a, opposite_c, opposite_b),
        (b, opposite_a, opposite_c),
        (c, opposite_b, opposite_a),
        (opposite_a, opposite_b, opposite_c),
    ]
    cells = np.concatenate([np.stack(part, axis=1) for part in new])
    return np.concatenate([points, points[sides].mean(axis=1)]), cells
