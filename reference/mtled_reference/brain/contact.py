"""Frictionless contact of the outline with the skull by a penalty method.

Pressure p = ε·max(−g, 0) [Pa] on the reference outline, g the gap of the displaced
point, along the gradient of the gap. Plane strain: forces of the whole thickness.
"""

import numpy as np
import scipy.sparse as sp

from .body import Skull

GAUSS = 4
"""Number of quadrature points per edge."""


class Wall:
    """The outline as curved edges on which the displacement is a polynomial.

    `nodes` (k, m) are those of each edge, `places` (m,) their coordinates along it from
    0 to 1, `geometry` (k, 3, 2) its ends and, last, its midpoint [m]; the penalty ε is
    in Pa/m.
    """

    def __init__(self, skull: Skull, nodes, places, geometry, count, thickness, penalty):
        self.skull, self.penalty = skull, penalty
        s, weights = np.polynomial.legendre.leggauss(GAUSS)
        s, weights = 0.5 * (s + 1.0), 0.5 * weights
        shape, slope = quadratic(s)
        tangent = np.einsum("qa,kad->kqd", slope, geometry)
        self.areas = (weights * np.linalg.norm(tangent, axis=2) * thickness).ravel()
        self.position = np.einsum("qa,kad->kqd", shape, geometry).reshape(-1, 2)
        values = lagrange(np.asarray(places), s)
        rows = np.repeat(np.arange(self.areas.size), values.shape[1])
        columns = np.repeat(nodes[:, None, :], GAUSS, axis=1).ravel()
        entries = np.tile(values.ravel(), len(nodes))
        self.values = sp.csr_matrix((entries, (rows, columns)), (self.areas.size, count))

    def _gap(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.skull.gap(self.position + self.values @ u.reshape(-1, 2))

    def closed(self, u: np.ndarray) -> np.ndarray:
        """Whether each quadrature point is in contact."""
        return self._gap(u)[0] < 0.0

    def force(self, u: np.ndarray) -> np.ndarray:
        """Forces on the nodes [N], x and y of each in turn."""
        gap, normal = self._gap(u)
        force = self.penalty * np.maximum(-gap, 0.0) * self.areas
        return (self.values.T @ (force[:, None] * normal)).ravel()

    def stiffness(self, u: np.ndarray) -> sp.csr_matrix:
        """−∂force/∂u [N/m], neglecting the small curvature of the wall."""
        gap, normal = self._gap(u)
        closed = np.nonzero(gap < 0.0)[0]
        values = self.values[closed]
        across = sum(
            sp.kron(sp.diags(normal[closed, axis]) @ values, np.eye(2)[axis : axis + 1])
            for axis in (0, 1)
        ).tocsr()
        return (across.T @ sp.diags(self.penalty * self.areas[closed]) @ across).tocsr()

    def penetration(self, u: np.ndarray) -> float:
        """Largest penetration [m], 0 if the wall is not touched."""
        return float(max(0.0, -self._gap(u)[0].min()))


def quadratic(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and slopes (q, 3) of the quadratic shape functions of the ends 0 and 1 and
    the midpoint."""
    values = np.column_stack([(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)])
    slopes = np.column_stack([4 * s - 3, 4 * s - 1, 4 - 8 * s])
    return values, slopes


def lagrange(places: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Values (q, m) at s of the Lagrange polynomials of the places (m,)."""
    values = np.ones((len(s), len(places)))
    for a, place in enumerate(places):
        for other in np.delete(places, a):
            values[:, a] *= (s - other) / (place - other)
    return values
