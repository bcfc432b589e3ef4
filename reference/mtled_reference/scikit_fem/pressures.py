"""Pressures that follow the boundary of a plane body.

With N_a at the nodes x_b of a curve whose unit tangent is t, outward normals of the deformed curve
are R ∂x/∂t with the rotation R by −90°: ∫ p N_a n ds = Σ_b p ∫ N_a ∂N_b/∂t ds R x_b is linear in x.
It has the sign of internal forces, and its matrix is symmetric where the ends of the curve stay on
axes.
"""

from dataclasses import dataclass

import numpy as np
import skfem

ROTATION = np.array([[0.0, 1.0], [-1.0, 0.0]])


@dataclass(frozen=True)
class Following:
    """Nodes (m, a) of the elements under pressure, and the matrices (m, ad, ad) [N/m] that take their
    positions to forces under the full load."""

    nodes: np.ndarray
    matrices: np.ndarray

    def forces(self, matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        """What matrices make of nodal vectors (n, d): (m, a, d)."""
        own = vectors[self.nodes]
        return np.matmul(matrices, own.reshape(len(own), -1, 1)).reshape(own.shape)


def following(model) -> Following | None:
    """The pressures of a case on a model; None if there are none."""
    case, parts = model.case, []
    if not case.pressures:
        return None
    if model.d != 2 or not case.is_static:
        raise ValueError("pressures are solved in equilibria in plane strain only")
    for row in case.pressures:
        facets, _ = model.facets_in(row.selector)
        if not len(facets):
            raise ValueError(f"the pressure {row.name} acts on no facet")
        curve = skfem.FacetBasis(model.mesh, model.basis.elem, facets=facets, intorder=6)
        values = np.stack([np.broadcast_to(b[0].value, curve.dx.shape) for b in curve.basis])
        gradients = np.stack([b[0].grad for b in curve.basis])
        tangents = np.stack([-curve.normals[1], curve.normals[0]])
        slopes = np.einsum("bkfq,kfq->bfq", gradients, tangents)
        pressure = row.pressure * row.amplitude(case.time.load_end) * case.thickness
        couplings = pressure * np.einsum("afq,bfq,fq->fab", values, slopes, curve.dx)
        size = 2 * len(values)
        matrices = np.einsum("fab,ij->faibj", couplings, ROTATION).reshape(-1, size, size)
        parts.append(Following(model.basis.element_dofs[:, curve.tind].T, matrices))
    nodes = np.concatenate([part.nodes for part in parts])
    return Following(nodes, np.concatenate([part.matrices for part in parts]))
