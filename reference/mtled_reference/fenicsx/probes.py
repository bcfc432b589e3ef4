"""Displacements at points: the cell that contains a point, and u there."""

import basix
import numpy as np

from . import versions
from .mirror import folded, folded_back

OUTSIDE = 1e-3
"""How far outside its cell a point may lie, in reference coordinates [–]: near a curved
surface the mesh runs slightly inside the body."""


class Locator:
    """Finds cells by their bounding boxes and by inverting the map of the reference cell."""

    def __init__(self, model):
        domain, recipe = model.domain, model.recipe
        kind = getattr(basix.CellType, recipe.cell)
        self.is_simplex = recipe.cell in ("triangle", "tetrahedron")
        self.element = basix.create_element(
            basix.ElementFamily.P, kind, recipe.order, basix.LagrangeVariant.gll_warped
        )
        size = domain.topology.dim
        self.centre = basix.geometry(kind).mean(axis=0)
        self.nodes = domain.geometry.x[versions.geometry_nodes(domain)][:, :, :size]
        reach = 0.1 * np.ptp(self.nodes, axis=1).max(axis=1, keepdims=True)
        self.low = self.nodes.min(axis=1) - reach
        self.high = self.nodes.max(axis=1) + reach

    def cells(self, points: np.ndarray) -> np.ndarray:
        """The cell that contains each of the points (n, 3) [m], or lies next to it."""
        points = points[:, : self.nodes.shape[2]]
        pairs = [
            np.flatnonzero(np.all((point >= self.low) & (point <= self.high), axis=1))
            for point in points
        ]
        owners = np.repeat(np.arange(len(points)), [len(cells) for cells in pairs])
        candidates = np.concatenate(pairs)
        outside = self._outside(self._reference_coordinates(points[owners], candidates))
        best = np.full(len(points), -1)
        for n in np.argsort(outside, kind="stable")[::-1]:
            best[owners[n]] = n
        if np.any(best < 0) or outside[best].max() > OUTSIDE:
            raise ValueError("a probe lies outside the mesh")
        return candidates[best].astype(np.int32)

    def _reference_coordinates(self, points: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """Reference coordinates of the points by Newton's method, all at once."""
        nodes = self.nodes[cells]
        reference = np.tile(self.centre, (len(points), 1))
        for _ in range(12):
            table = self.element.tabulate(1, reference)[..., 0]
            position = np.einsum("na,nai->ni", table[0], nodes)
            jacobian = np.einsum("jna,nai->nij", table[1:], nodes)
            step = np.linalg.solve(jacobian, (points - position)[:, :, None])[:, :, 0]
            reference = np.clip(reference + step, -0.5, 1.5)
        return reference

    def _outside(self, reference: np.ndarray) -> np.ndarray:
        """How far the coordinates lie outside the reference cell; negative inside."""
        beyond = [-reference.min(axis=1)]
        if self.is_simplex:
            beyond.append(reference.sum(axis=1) - 1.0)
        else:
            beyond.append(reference.max(axis=1) - 1.0)
        return np.max(beyond, axis=0)


class PointValues:
    """u at given positions of the body, of which a part may be meshed."""

    def __init__(self, model, locator: Locator, positions: np.ndarray):
        self.model = model
        self.folded, self.moved = folded(model.recipe.mirrors, positions)
        self.points = model.kinematics.mesh_points(self.folded)
        self.cells = locator.cells(self.points)

    def displacements(self, u, shifts) -> np.ndarray:
        """Displacements (n, 3) [m] at the positions."""
        unknowns = u.eval(self.points, self.cells)
        unknowns = np.reshape(unknowns, (len(self.points), -1))
        here = self.model.kinematics.displacements(self.folded, unknowns)
        return folded_back(self.model.recipe.mirrors, shifts, self.moved, here)
