"""Tetrahedra of second order that follow the surfaces of the body, ventricles and tumour."""

from dataclasses import dataclass

import numpy as np

from ..shared.case import Case
from .image import SignedDistance, read_label_map, signed_distance
from .surfaces import Sphere, distance_and, triangulated, with_rim

EDGES = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)])
"""Corners at the ends of the edges of a tetrahedron; its nodes are corners, then midpoints."""
FACES = np.array([(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)])
"""Corners of the faces, outward."""
INNER = 0.45
"""Edges along the ventricles and the tumour over those of the surface [–]."""
REGION_SMOOTHING = 0.7
"""Standard deviation [voxel] for the surfaces of the ventricles and the tumour."""
STRAIGHT = 0.5
"""Smallest Jacobian of a cell with curved edges over that of the straight one [–]."""
GOOD = 0.2
"""Quality below which the free corners of a cell are moved [–]."""
FILL = 0.12
"""Largest volume of a tetrahedron over the cube of the edge of the surface [–]."""


@dataclass(frozen=True)
class Tetrahedra:
    """Nodes (n, 3) [m], cells (m, 10), the region of each cell by its place in the case, and
    facets of the surface (k, 6): corners, then midpoints of the edges 01, 12 and 20. The nodes
    in the craniotomy are `constrained`; `distance` is that to the surface."""

    nodes: np.ndarray
    cells: np.ndarray
    region: np.ndarray
    facets: np.ndarray
    constrained: np.ndarray
    distance: SignedDistance
    edge: float


def body_distance(case: Case) -> SignedDistance:
    """Signed distance to the surface of the body."""
    shape = case.shape["label_map"]
    image = read_label_map(case.folder / shape["file"])
    return signed_distance(image, shape["labels"], shape.get("smoothing", 0.7))


def tetrahedra(case: Case, edge: float) -> Tetrahedra:
    """A mesh whose facets on the surface have edges of about `edge` [m]."""
    shape = case.shape["label_map"]
    image = read_label_map(case.folder / shape["file"])
    distance = body_distance(case)
    points, triangles = triangulated(distance, edge)
    sphere = None
    if case.prescriptions:
        (prescription,) = case.prescriptions
        content = prescription.selector["sphere"]
        sphere = Sphere(content["centre"], content["radius"])
        points, triangles = with_rim(points, triangles, distance, sphere)
    nodes, corners = _filled(points, triangles, edge)
    region = np.full(len(corners), [r.selector for r in case.regions].index("all"))
    fixed = np.unique(_outer_facets(corners))
    for index, row in enumerate(case.regions):
        if row.selector != "all":
            border = signed_distance(image, [row.selector["label"]["value"]], REGION_SMOOTHING)
            nodes, corners, region = _refined(nodes, corners, region, border, INNER * edge)
            nodes = _warped(nodes, corners, border, fixed)
            middles = nodes[corners].mean(axis=1)
            region[border.at(middles) < 0.0] = index
    nodes = _improved(nodes, corners, fixed)
    return _second_order(nodes, corners, region, distance, sphere, edge)


def _filled(points, triangles, edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the mesh [m] and tetrahedra by TetGen."""
    import tetgen  # only here: nothing else needs it

    generator = tetgen.TetGen(points / edge, triangles.astype(np.int32))
    generator.tetrahedralize(
        order=1,
        mindihedral=12.0,
        minratio=1.4,
        fixedvolume=True,
        maxvolume=FILL,
        nobisect=True,
    )
    nodes, corners = np.asarray(generator.node) * edge, np.asarray(generator.elem)[:, :4]
    used, corners = np.unique(corners, return_inverse=True)
    nodes, corners = nodes[used], corners.reshape(-1, 4).astype(np.int64)
    corners[volumes(nodes, corners) < 0.0] = corners[volumes(nodes, corners) < 0.0][:, [1, 0, 2, 3]]
    return nodes, corners


def volumes(nodes: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Signed volumes (e,) [m³] of tetrahedra with straight edges."""
    a, b, c, d = (nodes[corners[:, k]] for k in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6.0


def _refined(nodes, corners, region, border: SignedDistance, size: float):
    """The mesh with the longest edges of cells halved near the border of a region, until they
    are below 1.5 `size`. Edges of the surface stay whole."""
    for _ in range(40):
        pairs, number = _edges(corners)
        length = np.linalg.norm(nodes[pairs[:, 0]] - nodes[pairs[:, 1]], axis=1)
        middle = nodes[pairs].mean(axis=1)
        near = np.abs(border.at(middle)) < 0.5 * length + 0.5 * size
        longest = number[np.arange(len(number)), length[number].argmax(axis=1)]
        # An edge is halved when it is the longest of all cells around it.
        blocked = np.zeros(len(pairs), bool)
        blocked[number[number != longest[:, None]]] = True
        chosen = near & (length > 1.5 * size) & ~blocked
        if not chosen.any():
            wanted = near & (length > 1.5 * size)
            if not wanted.any():
                break
            # Otherwise the longest edge of a neighbour goes first.
            cells = np.any(wanted[number], axis=1)
            chosen = np.zeros(len(pairs), bool)
            chosen[longest[cells]] = True
            chosen &= ~blocked
            if not chosen.any():
                break
        new = np.full(len(pairs), -1)
        new[chosen] = len(nodes) + np.arange(chosen.sum())
        nodes = np.vstack([nodes, middle[chosen]])
        cut = np.flatnonzero(new[longest] >= 0)
        a, b = _ends_in(corners[cut], pairs[longest[cut]])
        first, second = corners[cut].copy(), corners[cut].copy()
        first[np.arange(len(cut)), a] = new[longest[cut]]
        second[np.arange(len(cut)), b] = new[longest[cut]]
        keep = np.setdiff1d(np.arange(len(corners)), cut)
        corners = np.vstack([corners[keep], first, second])
        region = np.concatenate([region[keep], region[cut], region[cut]])
    return nodes, corners, region


def _edges(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All edges (k, 2), and those of each cell in the order of EDGES."""
    ends = np.sort(corners[:, EDGES].reshape(-1, 2))
    keys = ends[:, 0] * (corners.max() + 1) + ends[:, 1]
    _, first, number = np.unique(keys, return_index=True, return_inverse=True)
    return ends[first], number.reshape(-1, 6)


def _ends_in(cells: np.ndarray, pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The places of the ends of an edge among the corners of its cell."""
    return tuple((cells == pairs[:, end, None]).argmax(axis=1) for end in (0, 1))


def _warped(nodes, corners, border: SignedDistance, fixed) -> np.ndarray:
    """Nodes within 0.3 of their shortest edge of the border moved onto it, where no cell
    becomes flat."""
    pairs, _ = _edges(corners)
    length = np.linalg.norm(nodes[pairs[:, 0]] - nodes[pairs[:, 1]], axis=1)
    shortest = np.full(len(nodes), np.inf)
    np.minimum.at(shortest, pairs[:, 0], length)
    np.minimum.at(shortest, pairs[:, 1], length)
    move = np.abs(border.at(nodes)) < 0.3 * shortest
    move[fixed] = False
    before = volumes(nodes, corners)
    for _ in range(10):
        moved = nodes.copy()
        moved[move] = border.projected(nodes[move])
        bad = volumes(moved, corners) < 0.5 * before
        if not bad.any():
            return moved
        move[np.unique(corners[bad])] = False
    return nodes


def qualities(nodes: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """6√2 V over the mean cube of the edges (e,): 1 of a regular tetrahedron, 0 of a flat one."""
    edges = nodes[corners[:, EDGES[:, 0]]] - nodes[corners[:, EDGES[:, 1]]]
    cubes = np.linalg.norm(edges, axis=2) ** 3
    return 6.0 * np.sqrt(2.0) * volumes(nodes, corners) / cubes.mean(axis=1)


def _improved(nodes, corners, fixed) -> np.ndarray:
    """The corners of flat cells that are not fixed moved at random, by less and less, as long
    as the worst cell around each becomes better."""
    random = np.random.default_rng(5)
    nodes, free = nodes.copy(), np.setdiff1d(np.arange(len(nodes)), fixed)
    for _ in range(4):
        flat = corners[qualities(nodes, corners) < GOOD]
        for node in np.intersect1d(np.unique(flat), free):
            around = corners[np.any(corners == node, axis=1)]
            worst = qualities(nodes, around).min()
            reach = np.linalg.norm(np.ptp(nodes[around[:, :4].ravel()], axis=0)) / 4.0
            for trial in range(60):
                last = nodes[node].copy()
                nodes[node] = last + reach * 0.95**trial * random.uniform(-1.0, 1.0, 3)
                better = qualities(nodes, around).min()
                if better > worst:
                    worst = better
                else:
                    nodes[node] = last
    return nodes


def _outer_facets(corners: np.ndarray) -> np.ndarray:
    """Faces (k, 3) that belong to one tetrahedron only, outward."""
    faces = corners[:, FACES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, 1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def _second_order(nodes, corners, region, distance, sphere, edge) -> Tetrahedra:
    """The mesh with midpoints, those of edges of facets on the surface."""
    facets = _outer_facets(corners)
    pairs, number = _edges(corners)
    middles = nodes[pairs].mean(axis=1)
    cells = np.hstack([corners, number + len(nodes)])
    lookup = {tuple(pair): n for n, pair in enumerate(pairs.tolist())}

    def edges_of(faces):
        ends = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
        return np.array([lookup[tuple(pair)] for pair in ends.tolist()]).reshape(-1, 3)

    on_facets = edges_of(facets)
    outside = np.unique(on_facets)
    middles[outside] = distance.projected(middles[outside])
    constrained = np.zeros(len(nodes) + len(pairs), bool)
    facets = np.hstack([facets, on_facets + len(nodes)])
    if sphere is not None:
        reach = sphere.distance(nodes)
        inside = np.all(reach[facets[:, :3]] <= sphere.radius * (1.0 + 1e-6), axis=1)
        on_rim = np.abs(reach[pairs] - sphere.radius) < 1e-6 * sphere.radius
        rim = np.intersect1d(np.flatnonzero(on_rim.all(axis=1)), outside)
        middles[rim] = distance_and(middles[rim], distance, sphere.onto)
        constrained[facets[inside]] = True
    everything = _valid(np.vstack([nodes, middles]), cells, pairs)
    return Tetrahedra(everything, cells, region, facets, constrained, distance, edge)


def _valid(nodes, cells, pairs) -> np.ndarray:
    """The nodes with midpoints moved back to the middle of straight edges in cells that
    would have a Jacobian below STRAIGHT of their straight one at a corner or the centre."""
    first = len(nodes) - len(pairs)
    for fraction in (0.5, 0.5, 0.5, 1.0, 1.0, 1.0):
        bad = jacobian_ratio(nodes, cells) < STRAIGHT
        if not bad.any():
            break
        middle = np.unique(cells[bad][:, 4:])
        straight = nodes[pairs[middle - first]].mean(axis=1)
        nodes = nodes.copy()
        nodes[middle] += fraction * (straight - nodes[middle])
    return nodes


def quadratic(reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values (q, 10) and slopes (q, 10, 3) of the shape functions at points (q, 3)."""
    L = np.column_stack([1.0 - reference.sum(axis=1), reference])
    slope = np.array([[-1.0, -1.0, -1.0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    a, b = EDGES.T
    values = np.hstack([L * (2.0 * L - 1.0), 4.0 * L[:, a] * L[:, b]])
    corners = (4.0 * L - 1.0)[..., None] * slope
    middles = 4.0 * (L[:, a, None] * slope[b] + L[:, b, None] * slope[a])
    return values, np.concatenate([corners, middles], axis=1)


def smallest_determinant(mesh: Tetrahedra, field: np.ndarray) -> float:
    """Smallest det F at the corners and centres of the cells for displacements (n, 3) [m]."""
    moved = _determinants(mesh.nodes + field, mesh.cells)
    return float((moved / _determinants(mesh.nodes, mesh.cells)).min())


def _determinants(nodes: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Jacobians (e, 5) of cells at their corners and centres."""
    _, slopes = quadratic(np.vstack([np.zeros(3), np.eye(3), np.full(3, 0.25)]))
    return np.linalg.det(np.einsum("qaj,eai->eqij", slopes, nodes[cells], optimize=True))


def jacobian_ratio(nodes: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Smallest Jacobian of each cell at its corners and centre over that of its corners alone."""
    curved = _determinants(nodes, cells)
    corner = nodes[cells[:, :4]]
    straight = np.linalg.det((corner[:, 1:] - corner[:, :1]).swapaxes(1, 2))
    return curved.min(axis=1) / straight
