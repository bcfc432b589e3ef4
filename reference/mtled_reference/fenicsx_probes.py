"""Values of a solution at points: the cell that holds a point, and u there."""

import basix
import numpy as np

from . import fenicsx_versions as versions
from .fenicsx_mirror import folded, folded_back

OUTSIDE = 1e-3
"""How far outside its cell a point may lie, in the cell's own coordinates: on a
curved surface the mesh runs slightly inside the body."""


class Locator:
    """Finds cells by bounding boxes and by inverting the map from the reference cell."""

    def __init__(self, domain, cell: str, order: int):
        kind = getattr(basix.CellType, cell)
        self.is_simplex = cell in ("triangle", "tetrahedron")
        self.element = basix.create_element(
            basix.ElementFamily.P, kind, order, basix.LagrangeVariant.gll_warped
        )
        size = domain.topology.dim
        self.centre = basix.geometry(kind).mean(axis=0)
        self.nodes = domain.geometry.x[versions.geometry_nodes(domain)][:, :, :size]
        reach = 0.1 * np.ptp(self.nodes, axis=1).max(axis=1, keepdims=True)
        self.low = self.nodes.min(axis=1) - reach
        self.high = self.nodes.max(axis=1) + reach

    def cells(self, points: np.ndarray) -> np.ndarray:
        """The cell that holds each of the points (n, 3) [m], or that it lies next to."""
        points = points[:, : self.nodes.shape[2]]
        pairs = [
            np.flatnonzero(np.all((point >= self.low) & (point <= self.high), axis=1))
            for point in points
        ]
        owners = np.repeat(np.arange(len(points)), [len(found) for found in pairs])
        candidates = np.concatenate(pairs)
        outside = self._outside(self._reference_coordinates(points[owners], candidates))
        best = np.full(len(points), -1)
        for place in np.argsort(outside, kind="stable")[::-1]:
            best[owners[place]] = place
        if np.any(best < 0) or outside[best].max() > OUTSIDE:
            raise ValueError("a probe lies outside the mesh")
        return candidates[best].astype(np.int32)

    def _reference_coordinates(self, points: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """Coordinates in the reference cell by Newton's method, all points at once."""
        nodes = self.nodes[cells]
        reference = np.tile(self.centre, (len(points), 1))
        for _ in range(12):
            table = self.element.tabulate(1, reference)[..., 0]
            place = np.einsum("na,nai->ni", table[0], nodes)
            slope = np.einsum("jna,nai->nij", table[1:], nodes)
            step = np.linalg.solve(slope, (points - place)[:, :, None])[:, :, 0]
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
    """u at given positions, for a model that may stand for a part of its body."""

    def __init__(self, model, positions: np.ndarray):
        self.model, self.positions = model, positions
        self.folded, self.moved = folded(model.recipe.mirrors, positions)
        self.points = model.kinematics.mesh_points(self.folded)
        self.cells = model.locator.cells(self.points)

    def displacements(self, u_function, shifts) -> np.ndarray:
        """Displacements (n, 3) [m] at the positions."""
        unknowns = u_function.eval(self.points, self.cells)
        unknowns = np.reshape(unknowns, (len(self.points), -1))
        here = self.model.kinematics.displacements(self.folded, unknowns)
        return folded_back(self.model.recipe.mirrors, shifts, self.moved, here)
