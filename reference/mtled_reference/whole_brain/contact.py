"""Frictionless contact of the surface with the skull by an augmented Lagrangian method.

Pressure p = max(λ − ε g, 0) [Pa] per reference area at the quadrature points of the facets,
along the gradient of the gap g(x) = offset − d(x) [m], with the signed distance d of which
the body is the level 0. The multipliers λ are zero at first, then the last pressures.

Facets of a coarse mesh bulge over hollows by up to millimetres; so a point of a facet stands
for the nearest point of the level, x = X* + u(X), and the gap is the offset at first.
"""

import numpy as np
import scipy.sparse as sp

from ..shared.case import Case
from .mesh import Tetrahedra

RULE = (
    (0.063089014491502, 0.063089014491502, 0.0254224531851035),
    (0.249286745170910, 0.249286745170910, 0.0583931378631895),
    (0.053145049844817, 0.310352451033785, 0.0414255378091870),
)
"""Barycentric coordinates and weights of the rule of degree 6 with 12 points (Dunavant 1985)."""


def triangle_rule() -> tuple[np.ndarray, np.ndarray]:
    """Barycentric coordinates (12, 3) and weights (12,), whose sum is 1/2."""
    points, weights = [], []
    for first, second, weight in RULE:
        triple = (first, second, 1.0 - first - second)
        orders = {
            (triple[a], triple[b], triple[3 - a - b]) for a in range(3) for b in range(3) if a != b
        }
        points += sorted(orders)
        weights += [weight] * len(orders)
    return np.array(points), np.array(weights)


class Wall:
    """The skull against the facets of a mesh, with a penalty ε [Pa/m]."""

    def __init__(self, case: Case, mesh: Tetrahedra, penalty: float):
        (obstacle,) = case.obstacles
        if obstacle.shape != case.shape or obstacle.side != "inside":
            raise ValueError("the skull must lie around the surface of the body")
        if obstacle.friction != "frictionless":
            raise ValueError("the skull must be without friction")
        self.name, self.offset, self.penalty = obstacle.name, obstacle.offset, penalty
        self.distance = mesh.distance
        points, weights = triangle_rule()
        shape, slope = quadratic_triangle(points)
        corners = mesh.nodes[mesh.facets]
        tangents = np.einsum("jqa,fai->jfqi", slope, corners, optimize=True)
        area = np.linalg.norm(np.cross(tangents[0], tangents[1]), axis=-1)
        self.areas = (weights * area).ravel()
        on_facets = np.einsum("qa,fai->fqi", shape, corners, optimize=True).reshape(-1, 3)
        self.position = mesh.distance.projected(on_facets, 8)
        self.multipliers = np.zeros(self.areas.size)
        self.moved = float(np.linalg.norm(self.position - on_facets, axis=1).max())
        rows = np.repeat(np.arange(self.areas.size), 6)
        columns = np.repeat(mesh.facets[:, None, :], len(weights), axis=1).ravel()
        entries = np.tile(shape.ravel(), len(mesh.facets))
        self.values = sp.csr_matrix((entries, (rows, columns)), (self.areas.size, len(mesh.nodes)))

    def _places(self, u: np.ndarray) -> np.ndarray:
        return self.position + self.values @ u.reshape(-1, 3)

    def gap(self, u: np.ndarray) -> np.ndarray:
        """Gaps [m] of the quadrature points, open if positive."""
        return self.offset - self.distance.at(self._places(u))

    def pressures(self, u: np.ndarray) -> np.ndarray:
        """Pressures [Pa] at the quadrature points."""
        return np.maximum(self.multipliers - self.penalty * self.gap(u), 0.0)

    def augment(self, u: np.ndarray) -> None:
        """Takes the pressures as the multipliers."""
        self.multipliers = self.pressures(u)

    def force(self, u: np.ndarray) -> np.ndarray:
        """Forces of the skull on the nodes (3 n,) [N]."""
        pressure = self.pressures(u) * self.areas
        closed = np.flatnonzero(pressure)
        slope = self.distance.gradient(self._places(u)[closed])
        return -(self.values[closed].T @ (pressure[closed, None] * slope)).ravel()

    def stiffness(self, u: np.ndarray) -> sp.csr_matrix:
        """−∂force/∂u [N/m], without the small curvature of the wall."""
        closed = np.flatnonzero(self.pressures(u))
        slope = self.distance.gradient(self._places(u)[closed])
        values = self.values[closed]
        identity = np.eye(3)
        across = sum(
            sp.kron(sp.diags(slope[:, k]) @ values, identity[k : k + 1]) for k in range(3)
        ).tocsr()
        return (across.T @ sp.diags(self.penalty * self.areas[closed]) @ across).tocsr()

    def resultant(self, u: np.ndarray) -> np.ndarray:
        """Force (3,) [N] of the skull on the body."""
        return self.force(u).reshape(-1, 3).sum(axis=0)

    def penetration(self, u: np.ndarray) -> float:
        """Largest penetration [m], 0 if the skull is not touched."""
        return float(max(0.0, -self.gap(u).min()))


def quadratic_triangle(L: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values (q, 6) and slopes (2, q, 6) of the shape functions of corners and midpoints of the
    edges 01, 12 and 20 at barycentric coordinates (q, 3); slopes by the second and third."""
    a, b = np.array([0, 1, 2]), np.array([1, 2, 0])
    values = np.hstack([L * (2.0 * L - 1.0), 4.0 * L[:, a] * L[:, b]])
    by = np.concatenate(
        [
            np.eye(3)[:, None, :] * (4.0 * L - 1.0)[None],
            4.0 * (np.eye(3)[:, None, a] * L[None, :, b] + np.eye(3)[:, None, b] * L[None, :, a]),
        ],
        axis=2,
    )
    return values, by[1:] - by[:1]
