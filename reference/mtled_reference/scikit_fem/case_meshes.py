"""Meshes of the cases: block-structured, refined by a constant ratio."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..shared.case import Case
from ..shared.selection import (
    bounding_box,
    cut_of_ball,
    on_quarter_ring,
    radii_of_quarter_ring,
)
from .hexahedra import (
    between,
    beyond_patch,
    both_ways,
    box_block,
    cube_face,
    equal_angles,
    evenly,
    extruded,
    mirrored,
    moved,
    on_sphere,
    quadrilateral,
    quarter_disc,
    towards_both_ends,
    towards_end,
    towards_start,
    whole,
)
from .mesh import Block
from .symmetry import Plane


@dataclass(frozen=True)
class CaseMesh:
    """The mesh of a case at one level."""

    blocks: list[Block]
    size: float
    """Nominal edge length of an element [m]."""
    family: str
    symmetry: list[Plane]
    load_steps: int = 2
    time_steps: int = 0
    """Number of time steps of a dynamic case."""
    from_coarser: bool = True
    """Whether Newton's method starts from the solution of the level below. At bonded
    edges under pressure that solution inverts the finer elements."""


def case_mesh(case: Case, level: int) -> CaseMesh:
    """The mesh of a case at level 0, 1 or 2."""
    if case.name not in MESHES:
        raise ValueError(f"there is no mesh of hexahedra for the case {case.name}")
    return MESHES[case.name](case, level)


def _whole_cube(counts, steps: int = 4) -> Callable:
    """The whole cube, without any symmetry."""

    def mesh(case: Case, level: int) -> CaseMesh:
        low, high = bounding_box(case.shape)
        n = counts[level]
        block = box_block(low, high, (n,) * 3)
        return CaseMesh([block], (high[0] - low[0]) / n, "hexahedra, uniform", [], steps)

    return mesh


def quarter_ring(radii: tuple[float, float], counts: tuple[int, int]) -> Block:
    """A quarter of a ring with so many cells across and around."""
    return Block(lambda r: on_quarter_ring(radii, r), counts)


def _inflated_tube(case: Case, level: int) -> CaseMesh:
    radii = radii_of_quarter_ring(case.shape)
    n = (3, 6, 12)[level]
    block = quarter_ring(radii, (n, 2 * n))
    return CaseMesh([block], (radii[1] - radii[0]) / n, "quadrilaterals, even", [], 8)


def _uniaxial_bar(case: Case, level: int) -> CaseMesh:
    low, high = bounding_box(case.shape)
    n = (1, 2, 3)[level]
    block = box_block(low, high, (5 * n, n, n))
    return CaseMesh([block], (high[1] - low[1]) / n, "hexahedra, even", [])


def _bonded_cube(planes: str) -> Callable:
    """A cube between two bonded plates, halved across the axes named in `planes`.

    Near ν = 0.5 the free sides fold over the edges of the plates and invert small
    elements there, so that the grading is weaker.
    """

    def mesh(case: Case, level: int) -> CaseMesh:
        low, high = bounding_box(case.shape)
        soft = case.regions[0].material.is_nearly_incompressible
        half, strength = ((2, 4, 8) if soft else (4, 6, 9))[level], 0.2 if soft else 0.4
        middle = 0.5 * (low + high)
        counts, divisions = [], []
        for axis, name in enumerate("xyz"):
            if name in planes:
                low[axis] = middle[axis]
                counts.append(half)
                divisions.append(towards_end(strength))
            else:
                counts.append(2 * half)
                divisions.append(towards_both_ends(strength))
        block = box_block(low, high, counts, divisions)
        size = (high[2] - low[2]) / (2 * half)
        family = "hexahedra, mildly graded towards the edges"
        symmetry = [(axis, middle[axis]) for axis, name in enumerate("xyz") if name in planes]
        steps = 5 if soft else 2
        return CaseMesh([block], size, family, symmetry, steps, from_coarser=not soft)

    return mesh


def _falling_beam(case: Case, level: int) -> CaseMesh:
    low, high = bounding_box(case.shape)
    n = (1, 2, 4)[level]
    low[1] = 0.5 * (low[1] + high[1])
    block = box_block(low, high, (6 * n, n, n))
    size = (high[2] - low[2]) / n
    return CaseMesh(
        [block], size, "hexahedra, even", [(1, low[1])], time_steps=(80, 160, 320)[level]
    )


def _twisted_cylinder(case: Case, level: int) -> CaseMesh:
    cylinder = case.shape["cylinder"]
    n = (1, 2, 4)[level]
    x, y, z = cylinder["base"]
    patches = whole(quarter_disc(n, n))
    heights = (z, z + cylinder["height"])
    blocks = extruded(patches, cylinder["radius"], heights, 4 * n, towards_both_ends(0.4))
    blocks = [moved(block, (x, y, 0.0)) for block in blocks]
    size = 0.5 * cylinder["radius"] / n
    return CaseMesh(blocks, size, "hexahedra, O-grid, mildly graded towards the ends", [], 6)


def _indented_block(case: Case, level: int) -> CaseMesh:
    low, high = bounding_box(case.shape)
    (sphere,) = [
        part["sphere"]
        for part in case.prescriptions[1].selector["intersection"]
        if "sphere" in part
    ]
    radius = sphere["radius"]
    n = (1, 2, 4)[level]
    beyond = beyond_patch(high[0] / radius, towards_start(0.4))
    patches = quarter_disc(n, n) + [(beyond, (2 * n, n)), (mirrored(beyond), (2 * n, n))]
    blocks = extruded(patches, radius, (low[2], high[2]), 3 * n, towards_end(0.4))
    family = "hexahedra, O-grid in the disc and around it, mildly graded towards the top"
    symmetry = [(0, 0.0), (1, 0.0)]
    return CaseMesh(blocks, 0.5 * radius / n, family, symmetry, from_coarser=False)


def _soft_inclusion(case: Case, level: int) -> CaseMesh:
    """A cube inside the ball, a layer between it and the surface of the ball, and a layer
    between that and the sides of the body."""
    low, high = bounding_box(case.shape)
    sphere = case.regions[0].selector["sphere"]
    half, radius = 0.5 * (high[2] - low[2]), sphere["radius"]
    n = (1, 2, 4)[level]
    faces = [(0, 1), (1, 1), (2, 1), (2, -1)]
    core = 0.5 * radius * np.ones(3)
    divisions = [equal_angles, equal_angles, both_ways(equal_angles)]
    blocks = [box_block(core * (0.0, 0.0, -1.0), core, (n, n, 2 * n), divisions)]
    outward, finer = on_sphere(radius), towards_end(0.4)
    for axis, sign in faces:
        inner = cube_face(core[0], n, axis, sign, equal_angles)
        outer = cube_face(half, n, axis, sign, finer)
        middle = Block(lambda r, face=inner: outward(face.map(r)), inner.counts)
        blocks += [between(inner, middle.map, n), between(middle, outer.map, 2 * n, finer)]
    blocks = [moved(block, sphere["centre"]) for block in blocks]
    family = "hexahedra in blocks around the ball, mildly graded towards the sides"
    symmetry = [(0, sphere["centre"][0]), (1, sphere["centre"][1])]
    return CaseMesh(blocks, half / (3 * n), family, symmetry)


def _sphere_gravity(case: Case, level: int) -> CaseMesh:
    """A cylinder inside the ball and a layer between it and the sphere. The rims of the
    cylinder project on the edge of the cap and on its mirror image."""
    radius = case.shape["sphere"]["radius"]
    height = -case.prescriptions[0].selector["half_space"]["point"][2]
    rim, core = np.sqrt(radius**2 - height**2), 0.5
    n = (1, 2, 4)[level]
    patches = quarter_disc(n, n)
    blocks = extruded(patches, core * rim, (-core * height, core * height), 2 * n)
    outward = on_sphere(radius)
    surfaces = [
        _end(patch, counts, core * rim, sign * core * height)
        for sign in (-1.0, 1.0)
        for patch, counts in patches
    ]
    surfaces += [_wall(core * rim, core * height, n, swap) for swap in (False, True)]
    for surface in surfaces:
        sphere = Block(lambda r, inner=surface: outward(inner.map(r)), surface.counts)
        blocks.append(between(surface, sphere.map, 2 * n, towards_end(0.4)))
    family = "hexahedra, O-grid in a cylinder and a layer around it, cap's edge a mesh line"
    return CaseMesh(blocks, radius / (3 * n), family, [(0, 0.0), (1, 0.0)], 3)


def _cut_ball(case: Case, level: int) -> CaseMesh:
    """A cylinder inside the ball and a layer between it and the sphere; its lower end
    projects on the cut along the axis, its wall on the sphere from the rim of the cut up."""
    radius, height = cut_of_ball(case.shape)
    rim, core = np.sqrt(radius**2 - height**2), 0.5
    n = (1, 2, 4)[level]
    patches = quarter_disc(n, n)
    blocks = extruded(patches, core * rim, (-core * height, core * height), 2 * n)
    outward = on_sphere(radius)
    finer = towards_end(0.4)
    for patch, counts in patches:
        inner, cut = (_end(patch, counts, k * rim, -k * height) for k in (core, 1.0))
        blocks.append(between(inner, cut.map, 2 * n, finer))
    surfaces = [_end(patch, counts, core * rim, core * height) for patch, counts in patches]
    surfaces += [_wall(core * rim, core * height, n, swap) for swap in (False, True)]
    for surface in surfaces:
        sphere = Block(lambda r, inner=surface: outward(inner.map(r)), surface.counts)
        blocks.append(between(surface, sphere.map, 2 * n, finer))
    family = "hexahedra, O-grid in a cylinder and a layer around it, rim of the cut a mesh line"
    return CaseMesh(blocks, radius / (3 * n), family, [(0, 0.0), (1, 0.0)], 3)


def _parted_arms(case: Case, level: int) -> CaseMesh:
    """Boxes around the slot, halved across y, finer towards its end and its faces."""
    whole_box, slot = case.shape["difference"]
    low, high = bounding_box(whole_box)
    slot_low, slot_high = bounding_box(slot)
    middle = 0.5 * (low[1] + high[1])
    n = (1, 2, 4)[level]
    strength = 0.4
    x = [
        (low[0], slot_low[0], 2 * n, towards_end(strength)),
        (slot_low[0], high[0], 6 * n, towards_start(strength)),
    ]
    z = [
        (low[2], slot_low[2], 2 * n, towards_end(strength)),
        (slot_low[2], slot_high[2], n, evenly),
        (slot_high[2], high[2], 2 * n, towards_start(strength)),
    ]
    blocks = [
        box_block(
            (along[0], middle, up[0]),
            (along[1], high[1], up[1]),
            (along[2], 2 * n, up[2]),
            (along[3], evenly, up[3]),
        )
        for i, along in enumerate(x)
        for j, up in enumerate(z)
        if (i, j) != (1, 1)
    ]
    family = "hexahedra in boxes around the slot, graded towards it; half of the body"
    return CaseMesh(blocks, (high[2] - low[2]) / (5 * n), family, [(1, middle)], 6)


def _end(patch, counts, scale: float, z: float) -> Block:
    """An end of the inner cylinder as a surface."""
    return Block(lambda r: np.column_stack([scale * patch(r), np.full(len(r), z)]), counts)


def _wall(radius: float, half: float, n: int, swap: bool) -> Block:
    """An eighth of the wall of the inner cylinder as a surface, over angles 0 to 45°
    or, swapped, 90° to 45°."""

    def place(r: np.ndarray) -> np.ndarray:
        angle = 0.25 * np.pi * r[:, 0]
        x, y = radius * np.cos(angle), radius * np.sin(angle)
        z = half * (2.0 * r[:, 1] - 1.0)
        return np.column_stack([y, x, z] if swap else [x, y, z])

    return Block(place, (n, 2 * n))


def _cook_membrane(case: Case, level: int) -> CaseMesh:
    a, b, c, d = case.shape["polygon"]["points"]
    n = (16, 32, 64)[level]
    block = quadrilateral((a, b, c, d), (n, n), (towards_both_ends(0.4), towards_both_ends(0.4)))
    return CaseMesh([block], 0.048 / n, "quadrilaterals, mildly graded towards the sides", [])


def _turek_hron(n_of, time_steps=(0, 0, 0)) -> Callable:
    """The bar: a strip of quadrilaterals from each segment of the clamped polyline."""

    def mesh(case: Case, level: int) -> CaseMesh:
        points = np.array(case.shape["polygon"]["points"])
        n = n_of[level]
        arc = points[2:][::-1]
        end = points[0, 0]
        near = 0.27
        blocks = []
        for low, high in zip(arc[:-1], arc[1:]):
            a, b = (near, low[1]), (near, high[1])
            blocks.append(quadrilateral((low, a, b, high), (2 * n, n)))
            corners = (a, (end, low[1]), (end, high[1]), b)
            blocks.append(quadrilateral(corners, (8 * n, n), (towards_start(0.7), evenly)))
        size = (points[1, 1] - points[0, 1]) / (8 * n)
        family = "quadrilaterals, graded towards the clamp"
        return CaseMesh(blocks, size, family, [], 8, time_steps[level])

    return mesh


MESHES: dict[str, Callable[[Case, int], CaseMesh]] = {
    "uniaxial_bar": _uniaxial_bar,
    "cube_compression": _bonded_cube("xy"),
    "cube_shear": _bonded_cube("y"),
    "bonded_block": _bonded_cube("xy"),
    "brain_cube_compression": _bonded_cube("xy"),
    "brain_cube_shear": _bonded_cube("y"),
    "falling_beam": _falling_beam,
    "twisted_cylinder": _twisted_cylinder,
    "indented_block": _indented_block,
    "inflated_tube": _inflated_tube,
    "rubber_block": _whole_cube((2, 4, 8), steps=8),
    "smooth_compressible": _whole_cube((3, 6, 12)),
    "smooth_nearly_incompressible": _whole_cube((3, 6, 12)),
    "soft_inclusion": _soft_inclusion,
    "sphere_gravity": _sphere_gravity,
    "cut_ball": _cut_ball,
    "parted_arms": _parted_arms,
    "cook_membrane": _cook_membrane,
    "turek_hron_csm1": _turek_hron((2, 4, 8)),
    "turek_hron_csm2": _turek_hron((2, 4, 8)),
    "turek_hron_csm3": _turek_hron((1, 2, 4), (200, 400, 800)),
}
"""The mesh of each case, by its name."""
