"""Meshes of bodies by Netgen: tetrahedra, or triangles in plane strain, whose facets follow the
borders of regions and of selections on the surface.

pip install netgen-mesher, which ngsolve brings along.
"""

import numpy as np

try:
    import netgen.occ as occ
    from pyngcore import SetNumThreads
except ImportError:
    occ = None

from ..shared.case import Case
from ..shared.selection import selected
from .files import Refused

TOLERANCE = 1e-3
"""Of selections without one of their own, over the spacing [–]."""


def mesh(case: Case, edge: float):
    """Netgen's mesh of a body with edges of a length [m]. Each face of the body, or each edge in
    plane strain, has a number and the name `face NUMBER`."""
    if occ is None:
        raise Refused("netgen-mesher is not installed")
    # Idle threads of Netgen wait actively.
    SetNumThreads(1)
    body = _face(case) if case.dimension == 2 else _cut(case)
    for number, face in enumerate(body.edges if case.dimension == 2 else body.faces):
        face.name = f"face {number}"
    return occ.OCCGeometry(body, dim=case.dimension).GenerateMesh(maxh=edge)


class Surface:
    """The facets of a mesh on the surface of the body: `corners` (n, k), from 0, and the
    numbers of their `faces` (n,), from 1. `vertices` (m, 3) are positions [m]."""

    def __init__(self, case: Case, netgen, spacing: float):
        self.tolerance = TOLERANCE * spacing
        # A copy: Netgen frees its own with the mesh.
        self.vertices = case.positions(netgen.Coordinates()[:, : case.dimension].copy())
        elements = (netgen.Elements1D if case.dimension == 2 else netgen.Elements2D)().NumPy()
        width = 2 if case.dimension == 2 else elements["nodes"].shape[1]
        corners, faces = elements["nodes"][:, :width].astype(int) - 1, elements["index"]
        outer = np.ones(len(faces), dtype=bool)
        if case.dimension == 3:
            sides = netgen.FaceDescriptors()
            outer = np.array([not (side.domin and side.domout) for side in sides])[faces - 1]
        self.corners, self.faces = corners[outer], faces[outer]

    def chosen(self, name: str, selector) -> list[int]:
        """Numbers of the faces that are the selection of the surface, which must not end within
        one."""
        hit = selected(selector, self.vertices, self.tolerance)
        whole = hit[self.corners].all(axis=1)
        numbers = [n for n in np.unique(self.faces) if whole[self.faces == n].all()]
        mine = np.isin(self.faces, numbers)
        if not numbers or not np.isin(self.corners[hit[self.corners]], self.corners[mine]).all():
            raise Refused(f"{name}: a selection that is no whole face of the body")
        return [int(number) for number in numbers]


def _cut(case: Case):
    """The body as solids, cut by the shapes that its regions and selections name."""
    rows = (*case.regions, *case.prescriptions, *case.tractions)
    parts = [_solid(case.shape)]
    for tool in (_solid(shape) for row in rows for shape in _shapes(row.selector)):
        halves = [half for part in parts for half in (part * tool, part - tool)]
        parts = [half for half in halves if len(half.solids)]
    return occ.Glue(parts) if len(parts) > 1 else parts[0]


def _shapes(selector) -> list[dict]:
    """The shapes in a selection; planes are taken for faces of the body."""
    if selector == "all":
        return []
    ((kind, content),) = selector.items()
    if kind in ("union", "intersection"):
        return [shape for part in content for shape in _shapes(part)]
    if kind == "not":
        return _shapes(content)
    if kind == "shape":
        return [content]
    return [] if kind == "plane" else [selector]


def _solid(shape: dict):
    ((kind, content),) = shape.items()
    if kind in ("union", "intersection", "difference"):
        first, *others = map(_solid, content)
        for other in others:
            first = {
                "union": first.__add__,
                "intersection": first.__mul__,
                "difference": first.__sub__,
            }[kind](other)
        return first
    if kind == "box":
        return occ.Box(occ.Pnt(*content["min"]), occ.Pnt(*content["max"]))
    if kind == "sphere":
        return occ.Sphere(occ.Pnt(*content["centre"]), content["radius"])
    if kind == "half_space":
        return occ.HalfSpace(occ.Pnt(*content["point"]), occ.Dir(*content["normal"]))
    if kind == "cylinder":
        base, axis = occ.Pnt(*content["base"]), occ.Dir(*content["axis"])
        return occ.Cylinder(base, axis, r=content["radius"], h=content["height"])
    raise Refused(f"the shape {kind}")


def _face(case: Case):
    """A polygon or box in its plane, of one material."""
    if len(case.regions) > 1:
        raise Refused("several regions in plane strain")
    ((kind, content),) = case.shape.items()
    if kind == "box":
        (a, b, _), (c, d, _) = content["min"], content["max"]
        points = [(a, b), (c, b), (c, d), (a, d)]
    elif kind == "polygon":
        points = content["points"]
    else:
        raise Refused(f"the shape {kind} in plane strain")
    pen = occ.WorkPlane().MoveTo(*points[0])
    for point in points[1:]:
        pen.LineTo(*point)
    return pen.Close().Face()
