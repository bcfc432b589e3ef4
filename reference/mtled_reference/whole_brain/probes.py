"""Displacements at points inside a mesh of tetrahedra of second order."""

import numpy as np
from scipy.spatial import cKDTree

from .mesh import Tetrahedra, quadratic

CANDIDATES = 60
"""Cells, nearest by their centres, in which a point is searched."""


class Interpolation:
    """Nodes (p, 10) and shape functions (p, 10) of the cells that contain points (p, 3) [m]; a
    point outside the mesh takes the cell from which it is least far away."""

    def __init__(self, mesh: Tetrahedra, points: np.ndarray):
        points = np.atleast_2d(points)
        centres = mesh.nodes[mesh.cells[:, :4]].mean(axis=1)
        count = min(CANDIDATES, len(centres))
        cells = cKDTree(centres).query(points, count)[1].reshape(len(points), count)
        corner = mesh.nodes[mesh.cells[cells][..., :4]]
        edges = (corner[..., 1:, :] - corner[..., :1, :]).swapaxes(-1, -2)
        arm = points[:, None, :] - corner[..., 0, :]
        at = np.linalg.solve(edges, arm[..., None])[..., 0]
        outside = np.maximum(-at.min(axis=-1), at.sum(axis=-1) - 1.0)
        best = outside.argmin(axis=1)
        rows = np.arange(len(points))
        self.outside = float(outside[rows, best].max())
        self.nodes = mesh.cells[cells[rows, best]]
        reference = at[rows, best]
        for _ in range(8):
            values, slopes = quadratic(reference)
            error = points - np.einsum("pa,pai->pi", values, mesh.nodes[self.nodes])
            jacobian = np.einsum("paj,pai->pij", slopes, mesh.nodes[self.nodes])
            step = np.linalg.solve(jacobian, error[..., None])[..., 0]
            reference = np.clip(reference + step, -0.2, 1.2)
        self.values = quadratic(reference)[0]

    def __call__(self, field: np.ndarray) -> np.ndarray:
        """Values (p, 3) of a field of the nodes (n, 3)."""
        return np.einsum("pa,pai->pi", self.values, field[self.nodes])
