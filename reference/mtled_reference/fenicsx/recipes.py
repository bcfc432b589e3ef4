"""Meshes of the cases: one family each, on three levels of refinement."""

import numpy as np

from ..shared.case import Case
from ..shared.measurements import recorded_times
from ..shared.selection import (
    bounding_box,
    cut_of_ball,
    on_quarter_ring,
    radii_of_quarter_ring,
)
from .kinematics import Axisymmetric, PlaneStrain
from .mesh_blocks import Block, mesh_of_blocks
from .mesh_shapes import (
    bilinear,
    box,
    core_and_shells,
    even,
    extruded,
    half_disc,
    towards_both,
    towards_one,
    towards_zero,
)
from .mesh_triangles import bar_triangles
from .mirror import Mirror
from .model import Recipe

CORNER = 2.0
"""Exponent of the grading towards a clamped corner, where stresses are singular [–]."""


def recipe(case: Case, level: int) -> Recipe:
    """The mesh of the case at a level, 0 the coarsest."""
    if case.name not in RECIPES:
        raise ValueError(f"there is no mesh for FEniCSx of the case {case.name}")
    return RECIPES[case.name](case, level)


def _corners(case: Case) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    low, high = bounding_box(case.shape)
    return low, 0.5 * (low + high), high


def _eighth_of_cube(cell: str, counts, power: float, family: str, steps: int = 4):
    """The octant x, y, z above the centre of a cube between bonded plates."""

    def made(case: Case, level: int) -> Recipe:
        _, centre, high = _corners(case)
        n = counts[level]
        points, cells = mesh_of_blocks(box(centre, high, (n,) * 3, [towards_one(power)] * 3), cell)
        mirrors = (
            Mirror(0, centre[0]),
            Mirror(1, centre[1]),
            Mirror(2, centre[2], between=("bottom", "top")),
        )
        size = (high[0] - centre[0]) / n
        return Recipe(cell, 2, points, cells, size, family, mirrors=mirrors, load_steps=steps)

    return made


def _half_of_cube(cell: str, counts, power: float, family: str, steps: int = 4):
    """The half y above the centre of a cube that is sheared along x.

    Each of `counts` is a pair: cells along x and z, and along the half of y.
    """

    def made(case: Case, level: int) -> Recipe:
        low, centre, high = _corners(case)
        n, half = counts[level]
        gradings = [towards_both(power), towards_one(power), towards_both(power)]
        start = np.array([low[0], centre[1], low[2]])
        points, cells = mesh_of_blocks(box(start, high, (n, half, n), gradings), cell)
        mirrors = (Mirror(1, centre[1]),)
        size = (high[0] - low[0]) / n
        return Recipe(cell, 2, points, cells, size, family, mirrors=mirrors, load_steps=steps)

    return made


def _whole_cube(counts, steps: int = 4):
    """The whole cube, without any symmetry."""

    def made(case: Case, level: int) -> Recipe:
        low, _, high = _corners(case)
        n = counts[level]
        points, cells = mesh_of_blocks(box(low, high, (n,) * 3), "hexahedron")
        size = (high[0] - low[0]) / n
        return Recipe("hexahedron", 2, points, cells, size, "hexahedra, uniform", load_steps=steps)

    return made


def quarter_ring(radii, counts, cell: str) -> tuple[np.ndarray, np.ndarray]:
    """Points [m] and cells of order 2 of a quarter of a ring with so many cells across and around."""
    block = Block(lambda s: on_quarter_ring(radii, s), counts)
    return mesh_of_blocks([block], cell)


def _inflated_tube(case: Case, level: int) -> Recipe:
    n = (4, 8, 16)[level]
    radii = radii_of_quarter_ring(case.shape)
    points, cells = quarter_ring(radii, (n, 2 * n), "quadrilateral")
    size, family = (radii[1] - radii[0]) / n, "quadrilaterals, even"
    kinematics = _plane_strain(case)
    return Recipe(
        "quadrilateral", 2, points, cells, size, family, kinematics=kinematics, load_steps=8
    )


def _uniaxial_bar(case: Case, level: int) -> Recipe:
    low, _, high = _corners(case)
    n = (1, 2, 4)[level]
    points, cells = mesh_of_blocks(box(low, high, (3 * n, n, n)), "tetrahedron")
    family = "tetrahedra, six to a brick, uniform"
    return Recipe("tetrahedron", 2, points, cells, (high[1] - low[1]) / n, family)


def _falling_beam(case: Case, level: int) -> Recipe:
    """The half y above the middle of the beam, which bends in x and z."""
    low, centre, high = _corners(case)
    n = (1, 2, 4)[level]
    start = np.array([low[0], centre[1], low[2]])
    points, cells = mesh_of_blocks(box(start, high, (6 * n, n, n)), "tetrahedron")
    step = recorded_times(case)[0] / n
    return Recipe(
        "tetrahedron",
        2,
        points,
        cells,
        (high[2] - low[2]) / n,
        "tetrahedra, six to a brick, uniform; half of the beam",
        mirrors=(Mirror(1, centre[1]),),
        time_step=step,
    )


def _indented_block(case: Case, level: int) -> Recipe:
    """A quarter of the block; the edge of the disc and the circle through the probe
    beside it are lines of the mesh."""
    _, _, high = _corners(case)
    disc = case.prescriptions[1].selector["intersection"][1]["sphere"]
    n = (1, 2, 4)[level]
    (beside,) = [p.positions[0] for p in case.probes if len(p.positions) == 1]
    radii = disc["radius"], float(np.hypot(*beside[:2]))
    gradings = towards_one(1.3), towards_zero(1.3), even
    plane = core_and_shells(2, 0.4, radii, high[0], (n,) * 4, gradings)
    blocks = extruded(plane, 0.0, high[2], 2 * n, towards_one(1.3))
    points, cells = mesh_of_blocks(blocks, "hexahedron")
    family = "hexahedra graded towards the disc's edge; a quarter of the block"
    mirrors = (Mirror(0, 0.0), Mirror(1, 0.0))
    size = disc["radius"] / (2 * n)
    return Recipe("hexahedron", 2, points, cells, size, family, mirrors=mirrors, load_steps=5)


def _soft_inclusion(case: Case, level: int) -> Recipe:
    """An eighth of the cube; the surface of the ball is a surface of the mesh."""
    _, centre, high = _corners(case)
    radius = case.regions[0].selector["sphere"]["radius"]
    n = (1, 2, 4)[level]
    counts, gradings = (2 * n, n, 2 * n), (even, even)
    blocks = core_and_shells(3, 0.5, (radius,), high[0] - centre[0], counts, gradings)
    points, cells = mesh_of_blocks(blocks, "tetrahedron")
    mirrors = (
        Mirror(0, centre[0]),
        Mirror(1, centre[1]),
        Mirror(2, centre[2], between=("bottom", "top")),
    )
    return Recipe(
        "tetrahedron",
        2,
        centre + points,
        cells,
        0.5 * radius / n,
        "curved tetrahedra around the ball; an eighth of the cube",
        mirrors=mirrors,
        load_steps=2,
    )


def _sphere_gravity(case: Case, level: int) -> Recipe:
    """A meridian section; the edge of the fixed cap is a node of the mesh.

    Above that edge the free surface folds over the fixed one, deeper where the cells
    are finer. The cells are not graded: with finer ones there it does not converge.
    """
    radius = case.shape["sphere"]["radius"]
    height = case.prescriptions[0].selector["half_space"]["point"][2]
    n = (4, 8, 16)[level]
    blocks = half_disc(radius, np.arcsin(height / radius), (n, n), 1.0)
    points, cells = mesh_of_blocks(blocks, "quadrilateral")
    family = "curved quadrilaterals of a meridian section, even along the fixed cap"
    return Recipe(
        "quadrilateral", 2, points, cells, radius / (2 * n), family, Axisymmetric(), load_steps=5
    )


def _cut_ball(case: Case, level: int) -> Recipe:
    """A meridian section; the rim of the cut is a node of the mesh."""
    radius, height = cut_of_ball(case.shape)
    n = (4, 8, 16)[level]
    blocks = half_disc(radius, -np.arcsin(height / radius), (n, n), 1.0, cut=True)
    points, cells = mesh_of_blocks(blocks, "quadrilateral")
    family = "curved quadrilaterals of a meridian section, even along the cut"
    return Recipe(
        "quadrilateral", 2, points, cells, radius / (2 * n), family, Axisymmetric(), load_steps=5
    )


def _parted_arms(case: Case, level: int) -> Recipe:
    """The half y above the middle: boxes around the slot, graded towards its end."""
    body, slot = case.shape["difference"]
    low, high = bounding_box(body)
    slot_low, slot_high = bounding_box(slot)
    middle = 0.5 * (low[1] + high[1])
    n = (1, 2, 4)[level]
    power = 1.3
    x = [(low[0], slot_low[0], 2 * n, towards_one(power))]
    x += [(slot_low[0], high[0], 6 * n, towards_zero(power))]
    z = [(low[2], slot_low[2], 2 * n, towards_one(power))]
    z += [(slot_low[2], slot_high[2], n, even)]
    z += [(slot_high[2], high[2], 2 * n, towards_zero(power))]
    blocks = []
    for i, along in enumerate(x):
        for j, up in enumerate(z):
            if (i, j) != (1, 1):
                start, end = (along[0], middle, up[0]), (along[1], high[1], up[1])
                gradings = [along[3], even, up[3]]
                blocks += box(start, end, (along[2], 2 * n, up[2]), gradings)
    points, cells = mesh_of_blocks(blocks, "tetrahedron")
    family = "tetrahedra, six to a brick, graded towards the slot; half of the body"
    size = (high[2] - low[2]) / (5 * n)
    mirrors = (Mirror(1, middle),)
    return Recipe("tetrahedron", 2, points, cells, size, family, mirrors=mirrors, load_steps=8)


def _twisted_cylinder(case: Case, level: int) -> Recipe:
    """A meridian section, graded towards the rims of both ends."""
    shape = case.shape["cylinder"]
    n = (6, 12, 24)[level]
    blocks = box(
        (0.0, 0.0),
        (shape["radius"], shape["height"]),
        (n, 3 * n),
        [towards_one(1.5), towards_both(1.5)],
    )
    points, cells = mesh_of_blocks(blocks, "quadrilateral")
    family = "quadrilaterals of a meridian section, graded towards the rims"
    return Recipe(
        "quadrilateral", 2, points, cells, shape["radius"] / n, family, Axisymmetric(), load_steps=6
    )


def _plane_strain(case: Case) -> PlaneStrain:
    return PlaneStrain(case.thickness, case.plane_z)


def _cook_membrane(case: Case, level: int) -> Recipe:
    corners = np.array(case.shape["polygon"]["points"])[[0, 1, 3, 2]]
    n = (12, 24, 48)[level]
    gradings = [towards_zero(CORNER), towards_both(CORNER)]
    points, cells = mesh_of_blocks(bilinear(corners, (n, n), gradings), "triangle")
    size = (corners[1, 0] - corners[0, 0]) / n
    family = "triangles, two to a quadrilateral, graded towards the clamped corners"
    return Recipe("triangle", 2, points, cells, size, family, _plane_strain(case))


def _turek_hron(case: Case, level: int) -> Recipe:
    corners = np.array(case.shape["polygon"]["points"])
    refinements = level + 1 if case.is_static else level
    points, cells = bar_triangles(corners, refinements)
    size = 0.5 * (corners[1, 1] - corners[0, 1]) / 2**refinements
    step = 0.0 if case.is_static else recorded_times(case)[0] / (6 * 2**level)
    family = "triangles, each cut into four, finer at the arc"
    kinematics = _plane_strain(case)
    return Recipe("triangle", 1, points, cells, size, family, kinematics, time_step=step)


TETRAHEDRA = "tetrahedra, six to a brick, graded towards the bonded edges"
RECIPES = {
    "bonded_block": _eighth_of_cube(
        "hexahedron", (2, 4, 8, 12), 1.0, "hexahedra, uniform; an eighth of the cube"
    ),
    "brain_cube_compression": _eighth_of_cube(
        "hexahedron", (2, 4, 8), 1.0, "hexahedra, uniform; an eighth of the cube"
    ),
    "brain_cube_shear": _half_of_cube(
        "hexahedron",
        ((4, 4), (6, 6), (9, 9)),
        1.3,
        "hexahedra, graded towards the bonded edges; half of the cube",
    ),
    "cook_membrane": _cook_membrane,
    "cut_ball": _cut_ball,
    "parted_arms": _parted_arms,
    "cube_compression": _eighth_of_cube(
        "tetrahedron", (4, 6, 9), 1.3, TETRAHEDRA + "; an eighth of the cube", steps=2
    ),
    "cube_shear": _half_of_cube(
        "tetrahedron", ((4, 2), (8, 4), (16, 8)), 1.3, TETRAHEDRA + "; half of the cube", steps=2
    ),
    "falling_beam": _falling_beam,
    "indented_block": _indented_block,
    "inflated_tube": _inflated_tube,
    "rubber_block": _whole_cube((4, 8, 12), steps=8),
    "smooth_compressible": _whole_cube((4, 8, 16)),
    "smooth_nearly_incompressible": _whole_cube((4, 8, 16)),
    "soft_inclusion": _soft_inclusion,
    "sphere_gravity": _sphere_gravity,
    "turek_hron_csm1": _turek_hron,
    "turek_hron_csm2": _turek_hron,
    "turek_hron_csm3": _turek_hron,
    "twisted_cylinder": _twisted_cylinder,
    "uniaxial_bar": _uniaxial_bar,
}
