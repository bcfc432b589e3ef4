"""Elements with nodes, as polynomials that are 1 at one node and 0 at the others."""

from dataclasses import dataclass, field
from itertools import product

import numpy as np


def _gauss(count: int, dimension: int):
    """Points and weights on [-1, 1]^dimension."""
    x, w = np.polynomial.legendre.leggauss(count)
    points = np.array(list(product(x, repeat=dimension)))
    return points, np.array(list(product(w, repeat=dimension))).prod(axis=1)


def _simplex(count: int, dimension: int):
    """Points and weights on the simplex with corners 0 and the unit vectors: those of a cube,
    collapsed (Stroud, Approximate Calculation of Multiple Integrals, 1971)."""
    points, weights = _gauss(count, dimension)
    cube, weights = 0.5 * (points + 1.0), weights / 2.0**dimension
    result, left = np.empty_like(cube), np.ones(len(cube))
    for k in range(dimension):
        result[:, k] = cube[:, k] * left
        weights = weights * left
        left = left * (1.0 - cube[:, k])
    return result, weights


@dataclass
class Element:
    """Nodes (n, d) in coordinates of the element, exponents (n, d) of the monomials, and points
    and weights of quadrature. A simplex has its corners at 0 and the unit vectors, the others
    fill [-1, 1]^d."""

    nodes: np.ndarray
    exponents: np.ndarray
    simplex: bool
    points: np.ndarray = field(init=False)
    weights: np.ndarray = field(init=False)

    def __post_init__(self):
        self.nodes, self.exponents = np.array(self.nodes, float), np.array(self.exponents)
        self.coefficients = np.linalg.inv(self._monomials(self.nodes))
        rule = _simplex if self.simplex else _gauss
        self.points, self.weights = rule(3, self.nodes.shape[1])

    def _monomials(self, at: np.ndarray) -> np.ndarray:
        return (at[..., None, :] ** self.exponents).prod(axis=-1)

    def shapes(self, at: np.ndarray) -> np.ndarray:
        """Shape functions (..., n) at points (..., d)."""
        return self._monomials(at) @ self.coefficients

    def gradients(self, at: np.ndarray) -> np.ndarray:
        """Their derivatives (..., n, d)."""
        columns = []
        for k in range(at.shape[-1]):
            lower = self.exponents.copy()
            lower[:, k] = np.maximum(0, lower[:, k] - 1)
            columns.append((at[..., None, :] ** lower).prod(axis=-1) * self.exponents[:, k])
        return np.stack([column @ self.coefficients for column in columns], axis=-1)

    def integrals(self, positions: np.ndarray) -> np.ndarray:
        """∫ N_a over elements with nodes at positions (m, n, 3): (m, n), of volumes or facets."""
        shapes, gradients = self.shapes(self.points), self.gradients(self.points)
        jacobians = np.einsum("qad,mai->mqid", gradients, positions)
        squares = np.einsum("mqid,mqie->mqde", jacobians, jacobians)
        measure = np.sqrt(np.linalg.det(squares)) * self.weights
        return np.einsum("mq,qa->ma", measure, shapes)

    def outside(self, at: np.ndarray) -> np.ndarray:
        """How far points (..., d) lie outside of the element; negative within."""
        if self.simplex:
            return np.maximum(-at.min(axis=-1), at.sum(axis=-1) - 1.0)
        return np.abs(at).max(axis=-1) - 1.0


CUBE = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1)]
CUBE += [(x, y, 1) for x, y, _ in CUBE]
SQUARE = [corner[:2] for corner in CUBE[:4]]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
EDGES += [(0, 4), (1, 5), (2, 6), (3, 7)]
"""Of a hexahedron in the order of VTK; those of a square are the first four."""
TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TETRAHEDRON_EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
TRIANGLE, TRIANGLE_EDGES = [(0, 0), (1, 0), (0, 1)], [(0, 1), (1, 2), (0, 2)]


def _with_middles(corners: list, edges: list) -> np.ndarray:
    corners = np.array(corners, float)
    return np.concatenate([corners, [corners[list(edge)].mean(axis=0) for edge in edges]])


def _powers(highest: int, dimension: int, total: int) -> list:
    """Exponents up to `highest` whose sum is at most `total`."""
    return [p for p in product(range(highest + 1), repeat=dimension) if sum(p) <= total]


def _serendipity(dimension: int) -> list:
    """Exponents up to 2 with at most one 2."""
    return [p for p in product(range(3), repeat=dimension) if p.count(2) <= 1]


HEXAHEDRON_8 = Element(CUBE, _powers(1, 3, 3), False)
HEXAHEDRON_20 = Element(_with_middles(CUBE, EDGES), _serendipity(3), False)
TETRAHEDRON_4 = Element(TETRAHEDRON, _powers(1, 3, 1), True)
TETRAHEDRON_10 = Element(_with_middles(TETRAHEDRON, TETRAHEDRON_EDGES), _powers(2, 3, 2), True)
QUADRILATERAL_4 = Element(SQUARE, _powers(1, 2, 2), False)
QUADRILATERAL_8 = Element(_with_middles(SQUARE, EDGES[:4]), _serendipity(2), False)
TRIANGLE_3 = Element(TRIANGLE, _powers(1, 2, 1), True)
TRIANGLE_6 = Element(_with_middles(TRIANGLE, TRIANGLE_EDGES), _powers(2, 2, 2), True)
FACETS = {
    id(HEXAHEDRON_8): QUADRILATERAL_4,
    id(HEXAHEDRON_20): QUADRILATERAL_8,
    id(TETRAHEDRON_4): TRIANGLE_3,
    id(TETRAHEDRON_10): TRIANGLE_6,
}
