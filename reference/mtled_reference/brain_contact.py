"""Frictionless contact of the outline with the skull by a penalty.

Pressure p = ε·max(−g, 0) [Pa] on the reference outline, g the gap of the displaced
point, along the gradient of the gap. Plane strain: forces of the whole thickness.
"""

import numpy as np
import scipy.sparse as sp

from .brain_body import Skull

GAUSS = 4
"""Points per edge."""


class Wall:
    """The outline as curved edges on which the displacement is a polynomial.

    `nodes` (k, m): nodes of each edge; `places` (m,): where they lie along it, from
    0 to 1; `geometry` (k, 3, 2): its ends and, last, its middle [m]; ε [Pa/m].
    """

    def __init__(self, skull: Skull, nodes, places, geometry, count, thickness, penalty):
        self.skull, self.penalty, self.count = skull, penalty, count
        s, weight = np.polynomial.legendre.leggauss(GAUSS)
        s, weight = 0.5 * (s + 1.0), 0.5 * weight
        shape, slope = quadratic(s)
        tangent = np.einsum("qa,kad->kqd", slope, geometry)
        self.weight = (weight * np.linalg.norm(tangent, axis=2) * thickness).ravel()
        self.position = np.einsum("qa,kad->kqd", shape, geometry).reshape(-1, 2)
        values = lagrange(np.asarray(places), s)
        rows = np.repeat(np.arange(self.weight.size), values.shape[1])
        columns = np.repeat(nodes[:, None, :], GAUSS, axis=1).ravel()
        entries = np.tile(values.ravel(), len(nodes))
        self.values = sp.csr_matrix((entries, (rows, columns)), (self.weight.size, count))

    def _open(self, u: np.ndarray):
        return self.skull.gap(self.position + self.values @ u.reshape(-1, 2))

    def closed(self, u: np.ndarray) -> np.ndarray:
        """Which points are inside the wall."""
        return self._open(u)[0] < 0.0

    def force(self, u: np.ndarray) -> np.ndarray:
        """Forces on the nodes [N], x and y of each in turn."""
        gap, normal = self._open(u)
        pressure = self.penalty * np.maximum(-gap, 0.0) * self.weight
        return (self.values.T @ (pressure[:, None] * normal)).ravel()

    def stiffness(self, u: np.ndarray) -> sp.csr_matrix:
        """−∂force/∂u [N/m] without the curvature of the wall, which is small."""
        gap, normal = self._open(u)
        closed = np.nonzero(gap < 0.0)[0]
        values = self.values[closed]
        across = sum(
            sp.kron(sp.diags(normal[closed, axis]) @ values, np.eye(2)[axis : axis + 1])
            for axis in (0, 1)
        ).tocsr()
        return (across.T @ sp.diags(self.penalty * self.weight[closed]) @ across).tocsr()

    def penetration(self, u: np.ndarray) -> float:
        """Deepest point inside the wall [m]."""
        return float(max(0.0, -self._open(u)[0].min()))


def quadratic(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and slopes (q, 3) of the quadratic shape functions of the ends 0 and 1
    and the middle."""
    values = np.column_stack([(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)])
    slopes = np.column_stack([4 * s - 3, 4 * s - 1, 4 - 8 * s])
    return values, slopes


def lagrange(places: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Values (q, m) at s of the polynomials that are 1 at one place, 0 at the others."""
    values = np.ones((len(s), len(places)))
    for a, place in enumerate(places):
        for other in np.delete(places, a):
            values[:, a] *= (s - other) / (place - other)
    return values
