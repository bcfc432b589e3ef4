"""Triangulated surfaces of the body, the ventricles and the tumour, of a given edge length."""

import numpy as np
import scipy.sparse as sp

from .image import SignedDistance
from .nets import surface_nets, triangles_of

ROUNDS = 20
"""Rounds of smoothing within the surface."""
RING_ROUNDS = 12
"""The same after points were moved on the rim of the craniotomy."""


def triangulated(distance: SignedDistance, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) [m] on the zero level and outward triangles (m, 3), whose edges are about
    `edge` [m] long."""
    size = np.array(distance.samples.shape) - 1
    steps = np.ceil(size * distance.voxel / edge).astype(int) + 1
    axes = [distance.corner[k] + edge * np.arange(steps[k]) for k in range(3)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    values = distance.at(lattice.reshape(-1, 3)).reshape(steps)
    points, quads = surface_nets(values)
    points = distance.projected(distance.corner + edge * points)
    pairs = np.vstack([quads[:, [a, (a + 1) % 4]] for a in range(4)])
    points = _relaxed(points, pairs, distance, ROUNDS, lambda moved: moved)
    return points, triangles_of(points, quads)


def _relaxed(points, pairs, distance, rounds: int, onto) -> np.ndarray:
    """Points moved half-way to the mean of their neighbours and back to the surface; `onto`
    restores other conditions."""
    count = len(points)
    both = np.vstack([pairs, pairs[:, ::-1]])
    graph = sp.csr_matrix((np.ones(len(both)), both.T), (count, count))
    graph.data[:] = 1.0
    degree = np.asarray(graph.sum(axis=1))
    for _ in range(rounds):
        points = onto(distance.projected(0.5 * points + 0.5 * (graph @ points) / degree, 2))
    return distance_and(points, distance, onto)


def distance_and(points, distance: SignedDistance, onto) -> np.ndarray:
    """Points that satisfy both the level and the conditions of `onto`."""
    for _ in range(8):
        points = onto(distance.projected(points, 1))
    return points


class Sphere:
    """The sphere that bounds the craniotomy."""

    def __init__(self, centre: np.ndarray, radius: float):
        self.centre, self.radius = np.asarray(centre, float), float(radius)

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Distances (n,) [m] of points from its centre."""
        return np.linalg.norm(points - self.centre, axis=-1)

    def onto(self, points: np.ndarray) -> np.ndarray:
        """The points moved along rays from the centre to the sphere."""
        arm = points - self.centre
        return self.centre + arm * (self.radius / np.linalg.norm(arm, axis=1))[:, None]


def with_rim(points, triangles, distance: SignedDistance, sphere: Sphere):
    """The surface with edges along the sphere: of each edge across it, the nearer end is
    moved onto it. Returns points and triangles."""
    pairs = np.unique(
        np.sort(np.vstack([triangles[:, [a, (a + 1) % 3]] for a in range(3)])), axis=0
    )
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    reach = sphere.distance(points) - sphere.radius
    rim = np.zeros(len(points), bool)
    across = pairs[(reach[pairs[:, 0]] < 0.0) != (reach[pairs[:, 1]] < 0.0)]
    nearer = np.where(
        np.abs(reach[across[:, 0]]) <= np.abs(reach[across[:, 1]]), across[:, 0], across[:, 1]
    )
    order = np.argsort(np.abs(reach[nearer]), kind="stable")
    for first, second, chosen in np.column_stack([across, nearer])[order]:
        if not (rim[first] or rim[second]):
            rim[chosen] = True

    def onto(moved):
        moved = moved.copy()
        moved[rim] = sphere.onto(moved[rim])
        return moved

    points = _relaxed(onto(points), pairs, distance, RING_ROUNDS, onto)
    return points, triangles
