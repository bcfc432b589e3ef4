"""Points in polygons."""

import numpy as np


def inside_polygon(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Which of the points (n, 2) lie in a closed polygon (m, 2), by the even–odd rule."""
    odd = np.zeros(len(points), dtype=bool)
    for start, end in zip(corners, np.roll(corners, -1, axis=0)):
        crosses = (start[1] > points[:, 1]) != (end[1] > points[:, 1])
        if crosses.any():
            slope = (end[0] - start[0]) / (end[1] - start[1])
            x = start[0] + slope * (points[crosses, 1] - start[1])
            odd[crosses] ^= points[crosses, 0] < x
    return odd
