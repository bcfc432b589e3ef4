"""Quadrilaterals with nine nodes from the triangles of the brain slice.

Each triangle gives three quadrilaterals, between a corner, the middles of two edges
and the middle of the triangle; edges along curves are bent to follow them.
"""

from dataclasses import dataclass

import numpy as np
from skfem import MeshQuad, MeshQuad2

from .brain_triangles import Triangles


@dataclass(frozen=True)
class Quads:
    """The mesh, the region of each quadrilateral, and the edges along the outline as
    indices (k, 3) of their ends and middle among the nodes, with those held."""

    mesh: MeshQuad2
    region: np.ndarray
    outline: np.ndarray
    held: np.ndarray


def quads_from(triangles: Triangles) -> Quads:
    """The quadrilaterals of a triangulation."""
    points, corners = triangles.points, triangles.corners
    edges = np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, number = np.unique(edges, axis=0, return_inverse=True)
    number = number.reshape(-1, 3)
    middles = points[edges].mean(axis=1)
    curved = _find(edges, triangles.curve_edges)
    middles[curved] = triangles.on_curves(0.5)
    count = len(points)
    middle = count + number
    centre = count + len(edges) + np.arange(len(corners))
    quads = np.vstack(
        [
            np.column_stack([corners[:, n], middle[:, n], centre, middle[:, n - 1]])
            for n in range(3)
        ]
    )
    vertices = np.vstack([points, middles, points[corners].mean(axis=1)])
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
    bends = np.vstack([triangles.on_curves(0.25), triangles.on_curves(0.75)])
    mesh, own = _bent(straight, halves, bends)
    on_outline = np.tile(triangles.on_outline, 2)
    outline = np.column_stack([halves, mesh.nvertices + own])[on_outline]
    held = np.tile(triangles.held, 2)[on_outline]
    return Quads(mesh, np.tile(triangles.region, 3), outline, held)


def _find(edges: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Indices of wanted pairs among sorted pairs."""
    index = {tuple(edge): n for n, edge in enumerate(edges.tolist())}
    return np.array([index[tuple(edge)] for edge in np.sort(wanted, axis=1).tolist()])


def _bent(mesh: MeshQuad2, ends: np.ndarray, bends: np.ndarray) -> tuple[MeshQuad2, np.ndarray]:
    """The mesh with the middles of some edges moved, and the numbers of the edges; the
    middle of a quadrilateral follows by half of what its edges do."""
    positions = mesh.doflocs.copy()
    edges = _find(np.sort(mesh.facets.T, axis=1), ends)
    shift = np.zeros((mesh.facets.shape[1], 2))
    shift[edges] = bends - positions[:, mesh.nvertices + edges].T
    positions[:, mesh.nvertices : mesh.nvertices + len(shift)] += shift.T
    inner = mesh.nvertices + len(shift)
    positions[:, inner:] += 0.5 * shift[mesh.t2f].sum(axis=0).T
    return MeshQuad2(positions, mesh.t), edges
