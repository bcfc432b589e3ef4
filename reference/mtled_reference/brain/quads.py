"""Quadrilaterals with nine nodes from the triangles of the brain slice.

Each triangle gives three quadrilaterals, between a corner, the midpoints of two edges
and the centre of the triangle. Edges along curves are curved.
"""

from dataclasses import dataclass

import numpy as np
from skfem import MeshQuad, MeshQuad2

from .triangles import Triangles, edge_numbers


@dataclass(frozen=True)
class Quads:
    """The mesh, the region of each quadrilateral, the edges along the outline as indices
    (k, 3) of their ends and midpoints among the nodes, and which of them (k,) lie in the
    craniotomy."""

    mesh: MeshQuad2
    region: np.ndarray
    outline: np.ndarray
    constrained: np.ndarray


def quads_from(triangles: Triangles) -> Quads:
    """The quadrilaterals of a triangulation."""
    points, corners = triangles.points, triangles.corners
    midpoints, numbers, curved = triangles.midpoints()
    count = len(points)
    middle = count + numbers
    centre = count + len(midpoints) + np.arange(len(corners))
    quads = np.vstack(
        [np.column_stack([corners[:, n], middle[:, n], centre, middle[:, n - 1]]) for n in range(3)]
    )
    vertices = np.vstack([points, midpoints, points[corners].mean(axis=1)])
    straight = MeshQuad2.from_mesh(
        MeshQuad(np.ascontiguousarray(vertices.T), np.ascontiguousarray(quads.T))
    )
    ends = triangles.curve_edges
    halves = np.vstack(
        [
            np.column_stack([ends[:, 0], count + curved]),
            np.column_stack([count + curved, ends[:, 1]]),
        ]
    )
    targets = np.vstack([triangles.on_curves(0.25), triangles.on_curves(0.75)])
    mesh, edges = _curved(straight, halves, targets)
    on_outline = np.tile(triangles.on_outline, 2)
    outline = np.column_stack([halves, mesh.nvertices + edges])[on_outline]
    constrained = np.tile(triangles.constrained, 2)[on_outline]
    return Quads(mesh, np.tile(triangles.region, 3), outline, constrained)


def _curved(mesh: MeshQuad2, ends: np.ndarray, targets: np.ndarray) -> tuple[MeshQuad2, np.ndarray]:
    """The mesh with the midpoints of some edges moved to targets (k, 2), and the numbers
    of these edges; the centre of a quadrilateral moves by half the sum of its edges'."""
    positions = mesh.doflocs.copy()
    edges = edge_numbers(np.sort(mesh.facets.T, axis=1), ends)
    shift = np.zeros((mesh.facets.shape[1], 2))
    shift[edges] = targets - positions[:, mesh.nvertices + edges].T
    positions[:, mesh.nvertices : mesh.nvertices + len(shift)] += shift.T
    inner = mesh.nvertices + len(shift)
    positions[:, inner:] += 0.5 * shift[mesh.t2f].sum(axis=0).T
    return MeshQuad2(positions, mesh.t), edges
