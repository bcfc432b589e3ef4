"""A case on a mesh with nodes, for programs that are given one: supports, consistent loads and
what an answer has of displacements and forces at nodes."""

from itertools import combinations

import numpy as np
from scipy.spatial import cKDTree

from ..shared.case import Case
from ..shared.selection import selected
from . import bodies, elements
from .cases import counts, is_even
from .files import Refused

CANDIDATES = {False: 2, True: 64}
"""Cells that are searched for a position, of boxes and of simplices."""
NEWTON = 4
"""Iterations for the coordinates of a position in a curved cell."""
CURVED = 0.05
"""How far a position may be outside of its cell, in coordinates of the cell [–]."""


class Nodal:
    """Positions of nodes (n, 3) [m], cells (m, k), facets on the surface (f, j), the element of
    the cells, and for each cell the number of its region."""

    def __init__(self, case: Case, spacing: float, degree: int, simplices: bool = False):
        if case.dimension != 3:
            raise Refused("plane strain")
        self.case, self.spacing = case, spacing
        if is_even(case):
            self._grid(degree, simplices)
        else:
            self._netgen(degree)
        self.facet = elements.FACETS[id(self.element)]
        centres = self.points[self.cells].mean(axis=1)
        hits = [selected(region.selector, centres, 0.0) for region in case.regions]
        if not np.any(hits, axis=0).all():
            raise Refused("parts of the body in no region")
        self.owners = np.argmax(hits, axis=0)
        self._supports()

    def _grid(self, degree: int, simplices: bool) -> None:
        """Even hexahedra of 8 or 20 nodes, or six tetrahedra of each (Kuhn, IBM J. Res. Dev. 4,
        518, 1960)."""
        low, high, self.numbers = counts(self.case, self.spacing, degree)
        ticks = [np.linspace(a, b, n + 1) for a, b, n in zip(low, high, self.numbers)]
        self.points = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 3)
        numbers = np.arange(len(self.points)).reshape([n + 1 for n in self.numbers])
        corners = (np.array(elements.CUBE) + 1) // 2
        first = np.stack(np.meshgrid(*map(np.arange, self.numbers), indexing="ij"), axis=-1)
        at = first.reshape(-1, 1, 3) + corners
        self.cells, self.element = numbers[tuple(np.moveaxis(at, -1, 0))], elements.HEXAHEDRON_8
        sides = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
        if simplices:
            around = (1, 2), (2, 3), (3, 7), (7, 4), (4, 5), (5, 1)
            ways = [[0, a, b, 6] for a, b in around]
            self.cells, self.element = self.cells[:, ways].reshape(-1, 4), elements.TETRAHEDRON_4
            sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
        self.facets = _surface(self.cells, sides)
        if degree == 2 and not simplices:
            self.element = elements.HEXAHEDRON_20
            self._add_middles(elements.EDGES, elements.EDGES[:4])

    def _netgen(self, degree: int) -> None:
        """Tetrahedra of 4 or 10 nodes, the latter with middles of edges on the surface."""
        netgen = bodies.mesh(self.case, degree * self.spacing)
        surface = bodies.Surface(self.case, netgen, self.spacing)
        for row in (*self.case.prescriptions, *self.case.tractions):
            if getattr(row, "of", "surface") == "surface":
                surface.chosen(row.name, row.selector)
        self.cells = netgen.Elements3D().NumPy()["nodes"][:, :4].astype(int) - 1
        self.points, self.facets = surface.vertices, surface.corners
        self.element = elements.TETRAHEDRON_4
        volume = np.linalg.det(self.points[self.cells[:, 1:]] - self.points[self.cells[:, :1]])
        self.cells[volume < 0.0] = self.cells[volume < 0.0][:, [0, 2, 1, 3]]
        if degree == 2:
            corners, facets = self.cells, self.facets
            netgen.SecondOrder()
            nodes, curved = netgen.Elements3D().NumPy()["nodes"].astype(int) - 1, {}
            for column, pair in enumerate(combinations(range(4), 2)):
                ends = np.sort(nodes[:, pair], axis=1)
                curved |= zip(map(tuple, ends.tolist()), nodes[:, 4 + column].tolist())
            self.element = elements.TETRAHEDRON_10
            middle = np.vectorize(lambda a, b: curved[min(a, b), max(a, b)])
            self.points = netgen.Coordinates()[:, :3].copy()
            self.cells = _joined(corners, elements.TETRAHEDRON_EDGES, middle)
            self.facets = _joined(facets, elements.TRIANGLE_EDGES, middle)

    def _add_middles(self, edges: list, of_facet: list) -> None:
        """Nodes in the middles of straight edges."""
        ends = np.sort(self.cells[:, edges].reshape(-1, 2), axis=1)
        unique = np.unique(ends, axis=0)
        count = len(self.points)
        keys = unique[:, 0] * count + unique[:, 1]

        def middle(a, b):
            return count + np.searchsorted(keys, np.minimum(a, b) * count + np.maximum(a, b))

        self.points = np.concatenate([self.points, self.points[unique].mean(axis=1)])
        self.cells = _joined(self.cells, edges, middle)
        self.facets = _joined(self.facets, of_facet, middle)

    def _supports(self) -> None:
        """What is prescribed: `fixed` (n, 3), and by support its nodes and components; where two
        prescribe a component the first counts."""
        self.outer = np.zeros(len(self.points), dtype=bool)
        self.outer[self.facets] = True
        self.fixed, self.owned = np.zeros(self.points.shape, dtype=bool), []
        for row in self.case.prescriptions:
            nodes = selected(row.selector, self.points, bodies.TOLERANCE * self.spacing)
            if row.of == "surface":
                nodes &= self.outer
            mine = nodes[:, None] & np.isin(np.arange(3), row.components(3)) & ~self.fixed
            self.fixed |= mine
            self.owned.append((row, mine))

    def prescribed(self, t: float, scale: float = 1.0) -> np.ndarray:
        """Prescribed displacements (n, 3) [m] at time t [s], 0 where nothing is."""
        full = np.zeros_like(self.points)
        for row, mine in self.owned:
            full[mine] = row.values(self.points, scale * row.amplitude(t))[mine]
        return full

    def masses(self, region: int | None = None) -> np.ndarray:
        """∫ ρ N (n,) [kg], of one region or of all."""
        density = np.array([r.material.density for r in self.case.regions])[self.owners]
        if region is not None:
            density = density * (self.owners == region)
        parts = self.element.integrals(self.points[self.cells]) * density[:, None]
        return np.bincount(self.cells.ravel(), parts.ravel(), len(self.points))

    def loads(self, t: float) -> np.ndarray:
        """Forces (n, 3) [N] of body forces and dead tractions at time t [s]."""
        total = np.zeros_like(self.points)
        for force in self.case.body_forces:
            acceleration = force.amplitude(t) * np.array(force.acceleration)
            total += self.masses()[:, None] * acceleration
        for row in self.case.tractions:
            nodes = selected(row.selector, self.points, bodies.TOLERANCE * self.spacing)
            facets = self.facets[nodes[self.facets].all(axis=1)]
            if not len(facets):
                raise Refused(f"{row.name}: no facets", "resolution")
            parts = self.facet.integrals(self.points[facets])
            areas = np.bincount(facets.ravel(), parts.ravel(), len(self.points))
            total += areas[:, None] * (row.amplitude(t) * np.array(row.traction))
        return total

    def displacements(self, u: np.ndarray) -> dict:
        """Values (places, 3) of the probes, of displacements (n, 3) [m] of the nodes."""
        names = [region.name for region in self.case.regions]
        result = {}
        for probe in self.case.probes:
            if probe.positions is not None:
                nodes, shapes = self.located(probe.positions)
                result[probe.name] = np.einsum("pa,pai->pi", shapes, u[nodes])
                continue
            name = probe.centre_of_mass
            if name not in names and name != "body":
                raise Refused(f"no region {name}")
            masses = self.masses(names.index(name) if name in names else None)
            result[probe.name] = (masses @ u / masses.sum())[None]
        return result

    def located(self, positions: np.ndarray):
        """Nodes (p, k) and shape functions (p, k) of the cells in which positions lie."""
        middles = self.points[self.cells].mean(axis=1)
        count = min(CANDIDATES[self.element.simplex], len(middles))
        _, near = cKDTree(middles).query(positions, k=range(1, count + 1))
        cells, at, outside = self._nearest(positions, near)
        for row in np.flatnonzero(outside > CURVED)[:, None]:
            every = np.arange(len(middles))[None]
            cells[row], at[row], outside[row] = self._nearest(positions[row], every)
        if outside.max() > CURVED:
            raise Refused("a probe outside the mesh", "resolution")
        return self.cells[cells], self.element.shapes(at)

    def _nearest(self, positions: np.ndarray, near: np.ndarray):
        """Of cells (p, c) those that contain positions best, where, and how far outside."""
        nodes = self.points[self.cells[near]]
        at = np.full((*near.shape, 3), 0.25 if self.element.simplex else 0.0)
        for _ in range(NEWTON):
            shapes, slopes = self.element.shapes(at), self.element.gradients(at)
            miss = positions[:, None] - np.einsum("pca,pcai->pci", shapes, nodes)
            jacobian = np.einsum("pcad,pcai->pcid", slopes, nodes)
            at += np.linalg.solve(jacobian, miss[..., None])[..., 0]
        miss = positions[:, None] - np.einsum("pca,pcai->pci", self.element.shapes(at), nodes)
        found = np.linalg.norm(miss, axis=-1) <= bodies.TOLERANCE * self.spacing
        outside = np.where(found, self.element.outside(at), np.inf)
        best, rows = outside.argmin(axis=1), np.arange(len(positions))
        return near[rows, best], at[rows, best], outside[rows, best]

    def answer(self, instants: list) -> dict:
        """What an answer has of displacements and forces of supports (n, 3) at instants; the
        forces may be None."""
        content = {"displacements_m": {}, "reactions_n": {}}
        for u, forces in instants:
            for name, values in self.displacements(u).items():
                content["displacements_m"].setdefault(name, []).append(values.tolist())
            for row, mine in self.owned if forces is not None else ():
                total = (mine * forces).sum(axis=0).tolist()
                content["reactions_n"].setdefault(row.name, []).append(total)
        return content | {"unknowns": int((~self.fixed).sum())}


def _joined(corners: np.ndarray, edges: list, middle) -> np.ndarray:
    """Corners and the nodes in the middles of edges."""
    return np.column_stack([corners, *(middle(corners[:, a], corners[:, b]) for a, b in edges)])


def _surface(cells: np.ndarray, sides: list) -> np.ndarray:
    """Facets that one cell has alone."""
    facets = cells[:, sides].reshape(-1, len(sides[0]))
    _, first, times = np.unique(
        np.sort(facets, axis=1), axis=0, return_index=True, return_counts=True
    )
    return facets[first[times == 1]]
