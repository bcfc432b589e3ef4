"""The left ventricles of Land's benchmark (Proc. R. Soc. A 471:20150641, 2015) by FEniCSx, with the
elements of `fibres.py` on hexahedra whose edges are curved: half an ellipsoid with a thick wall,
held at its base, under a pressure that follows the inner surface. In the second problem a quarter
is enough; in the third the fibres turn across the wall and pull, and the whole body twists. Both
are bodies of revolution, which a mesh of a half section solves too, with an angle of twist. And
strips in plane strain, in quadrilaterals with quadratic displacements."""

import json
import tomllib
from pathlib import Path

import basix
import numpy as np
import ufl
from dolfinx import fem

from .fenicsx import versions
from .fenicsx.conditions import Conditions
from .fenicsx.kinematics import PlaneStrain
from .fenicsx.mesh_blocks import Block, mesh_of_blocks
from .fenicsx.mesh_shapes import box
from .fenicsx.model import Model as PlaneModel
from .fenicsx.model import Recipe
from .fenicsx.newton import Newton, solve_static
from .fibres import (
    QUADRATURE,
    Model,
    answers_of,
    equilibrium,
    seconds_apart_from_compiling,
)
from .shared.case import read_case
from .shared.selection import bounding_box

INNER = np.array([0.007, 0.017])
"""Radius across the axis and along it of the inner surface [m]."""
WALL = 0.003
"""What the outer surface has more of both [m]."""
BASE = 0.005
"""Height of the base [m]."""
CAP = 0.2
"""Half-width of the square of cells around the apex over the arc from apex to base [–]."""
GRADING = 2.0
"""Exponent by which cells shrink towards the base, whose edges are singular [–]."""
BISECTIONS = 50
ARM = 0.01
"""Length [m] by which angles of twist are multiplied to be of the size of displacements."""

THIRD = {"C": 2e3, "b_f": 8.0, "b_t": 2.0, "b_fs": 4.0}
"""Constants of the third problem."""
THIRD_BULK_MODULUS = 1e6
THIRD_PRESSURE = 15e3
THIRD_TENSION = 60e3
"""Second Piola–Kirchhoff stress along the fibres [Pa]."""


def _side(turn: int):
    """The part of the unit disc between a side of the square around its centre and the circle."""
    cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[turn]

    def placed(s):
        out, angle = 1.0 - (1.0 - s[:, 0]) ** GRADING, 0.25 * np.pi * s[:, 1]
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        # A side of the square, bulged half way to a circle.
        side = CAP * (0.5 * np.stack([np.ones_like(angle), np.tan(angle)], axis=1) + 0.5 * circle)
        x, y = ((1 - out[:, None]) * side + out[:, None] * circle).T
        return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)

    return placed


def _square(s):
    """The square around the centre of the disc; s in [−1, 1]."""
    square = np.tan(0.25 * np.pi * s)
    length = np.linalg.norm(square, axis=1, keepdims=True)
    largest = np.abs(square).max(axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        circle = np.where(length > 0.0, square * largest / length, 0.0)
    return CAP * 0.5 * (square + circle)


def _on_wall(disc, t):
    """The point of the wall at the parameter t across it, above a point of the unit disc:
    its centre is the apex, its circle the base."""
    across, along = (INNER[:, None] + WALL * t)[:]
    radius = np.linalg.norm(disc, axis=1)
    angle = radius * (np.pi - np.arccos(BASE / along))
    with np.errstate(invalid="ignore"):
        x, y = np.where(radius > 0.0, disc.T / radius, 0.0) * across * np.sin(angle)
    return np.stack([x, y, -along * np.cos(angle)], axis=1)


def ventricle(wall: int, around: int, up: int, quarter: bool) -> list[Block]:
    """Blocks with `wall` cells across the wall, twice `around` cells along a quarter of the
    circumference, and `up` from the square around the apex to the base."""

    def square(low: float):
        return lambda s: _on_wall(_square(low + (1.0 - low) * s[:, 1:]), s[:, 0])

    def side(turn: int, low: float, high: float):
        def placed(s):
            along = low + (high - low) * s[:, [2]]
            return _on_wall(_side(turn)(np.concatenate([s[:, [1]], along], axis=1)), s[:, 0])

        return placed

    if quarter:
        sides = [Block(side(0, 0.0, 1.0), (wall, up, around))]
        sides.append(Block(side(1, -1.0, 0.0), (wall, up, around)))
        return [Block(square(0.0), (wall, around, around)), *sides]
    sides = [Block(side(turn, -1.0, 1.0), (wall, up, 2 * around)) for turn in range(4)]
    return [Block(square(-1.0), (wall, 2 * around, 2 * around)), *sides]


def wall_parameter(points: np.ndarray) -> np.ndarray:
    """The t (n,) of the ellipsoid through each point (n, 3), by bisection."""
    radius = np.linalg.norm(points[:, :2], axis=1)
    low, high = np.full(len(points), -0.5), np.full(len(points), 1.5)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        across, along = INNER[:, None] + WALL * middle
        outside = (radius / across) ** 2 + (points[:, 2] / along) ** 2 > 1.0
        low, high = np.where(outside, middle, low), np.where(outside, high, middle)
    return 0.5 * (low + high)


def frame_at(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions (n, 3) of the fibres, which turn from 90° to −90° across the wall, and of the
    normals of the wall. With u from −π at the apex, the tangents are e_u upwards, e_v around."""
    t = wall_parameter(points)
    across, along = INNER[:, None] + WALL * t
    radius = np.linalg.norm(points[:, :2], axis=1)
    out = np.stack([*(points[:, :2].T / radius), np.zeros(len(t))], axis=1)
    up = np.array([0.0, 0.0, 1.0])
    around = np.cross(up, out)
    sine, cosine = radius / across, -points[:, 2] / along
    meridian = (across * cosine)[:, None] * out + (along * sine)[:, None] * up
    meridian /= np.linalg.norm(meridian, axis=1, keepdims=True)
    angle = (0.5 * np.pi - np.pi * t)[:, None]
    fibre = np.sin(angle) * meridian + np.cos(angle) * around
    return fibre, np.cross(meridian, around)


def _frame(domain):
    """Fibres, normals of the wall and the third direction at the points of the quadrature."""
    cell, size = domain.ufl_cell().cellname(), domain.topology.dim
    element = ufl.VectorElement("Quadrature", cell, QUADRATURE, dim=3, quad_scheme="default")
    space = fem.FunctionSpace(domain, element)
    points, _ = basix.make_quadrature(getattr(basix.CellType, cell), QUADRATURE)
    cells = np.arange(domain.topology.index_map(size).size_local, dtype=np.int32)
    places = fem.Expression(ufl.SpatialCoordinate(domain), points).eval(cells).reshape(-1, size)
    if size == 2:
        places = np.stack([places[:, 0], np.zeros(len(places)), places[:, 1]], axis=1)
    functions = []
    for directions in frame_at(places):
        function = fem.Function(space)
        function.x.array.reshape(-1, 3)[space.dofmap.list.array] = directions
        functions.append(function)
    fibre, normal = functions
    return fibre, normal, ufl.cross(fibre, normal)


class Turned(Model):
    """A body of revolution on its half section in R and Z: displacements away from the axis, the
    angle of twist times `ARM`, and displacements along the axis."""

    cell = "quadrilateral"

    def gradient(self, u):
        out, twist, along = (ufl.grad(u[i]) for i in range(3))
        turn, R = twist / ARM, ufl.SpatialCoordinate(self.domain)[0]
        r = R + u[0]
        return ufl.as_matrix(
            [
                [1 + out[0], 0, out[1]],
                [r * turn[0], r / R, r * turn[1]],
                [along[0], 0, 1 + along[1]],
            ]
        )

    def volume_factor(self):
        return 2.0 * np.pi * ufl.SpatialCoordinate(self.domain)[0]

    def virtual(self, v, u):
        r = ufl.SpatialCoordinate(self.domain)[0] + u[0]
        return ufl.as_vector([v[0], r * v[1] / ARM, v[2]])

    def normal(self):
        normal = ufl.FacetNormal(self.domain)
        return ufl.as_vector([normal[0], 0.0, normal[1]])

    def positions(self, points: np.ndarray) -> np.ndarray:
        return np.stack([points[:, 0], np.zeros(len(points)), points[:, 1]], axis=1)


def section(wall: int, up: int) -> list[Block]:
    """The half section of the wall in two blocks of half of `up` cells each, which shrink towards
    the apex and towards the base."""

    def part(ends: tuple[float, float]):
        def placed(s):
            way = ends[0] + (ends[1] - ends[0]) * s[:, 1] ** GRADING
            return _on_wall(np.stack([way, 0.0 * way], axis=1), s[:, 0])[:, [0, 2]]

        return placed

    return [Block(part((end, 0.5)), (wall, up // 2)) for end in (0.0, 1.0)]


def _case(problem: str, folder: Path, planes: str) -> dict:
    """The case file of the second problem, for the third with what differs there; planes of
    symmetry, or the axis, stay where they are along x or y."""
    case = tomllib.loads((folder / "land_2" / "case.toml").read_text())
    if problem == "land_3":
        case["material"]["muscle"] |= {"constants": THIRD, "bulk_modulus": THIRD_BULK_MODULUS}
        case["pressure"][0]["pressure"] = THIRD_PRESSURE
    for axis in planes:
        normal = [float(axis == other) for other in "xyz"]
        where = {"plane": {"point": [0.0, 0.0, 0.0], "normal": normal}}
        case["prescribe"].append({"name": axis, "where": where, "displacement": {axis: 0.0}})
    return case


def solve(problem: str, folder: Path, counts: tuple[int, ...]) -> dict:
    """Answers of `land_2` or `land_3` with so many cells as `ventricle` says, or `section` where
    there are two counts."""
    third, turned = problem == "land_3", len(counts) == 2
    if turned:
        blocks, planes, kind = section(*counts), "x", Turned
    else:
        blocks, planes, kind = ventricle(*counts, quarter=not third), "" if third else "xy", Model
    case = _case(problem, folder, planes)
    points, cells = mesh_of_blocks(blocks, kind.cell)
    if turned:
        # On the axis up to round-off.
        points[np.abs(points[:, 0]) < 1e-12, 0] = 0.0
    domain = versions.create_mesh(kind.cell, 2, points, cells)
    model = kind(case, domain, _frame, THIRD_TENSION) if third else kind(case, domain)
    answers = answers_of(model, case, equilibrium(model, case))
    kept = {}
    for probe in case["probe"]:
        moved = answers[f"displacement/{probe['name']}/z"]
        kept[f"displacement/{probe['name']}/z"] = moved
        kept[f"position/{probe['name']}/z"] = probe["point"][2] + moved
    whole = 1.0 if turned or third else 4.0
    kept["strain_energy"] = whole * answers["strain_energy"]
    return {"cells": len(cells), "unknowns": len(model.unknown.x.array), "answers": kept}


def solve_on_meshes(problem: str, folder: Path, meshes: list[tuple[int, ...]], out: Path) -> None:
    """Writes the answers on several meshes, with processor time and packages."""
    solved = []
    for counts in meshes:
        start = seconds_apart_from_compiling()
        mesh = solve(problem, folder, counts)
        cpu = round(seconds_apart_from_compiling() - start, 2)
        names = ("across", "along_eighth", "up") if len(counts) == 3 else ("across", "up")
        named = {f"cells_{name}": count for name, count in zip(names, counts)}
        solved.append({**named, "cpu_s": cpu, **mesh})
        print(json.dumps(solved[-1]), flush=True)
        result = {"problem": problem, "packages": versions.packages(), "meshes": solved}
        out.write_text(json.dumps(result, indent=1) + "\n")


def solve_strip(path: Path, counts: tuple[int, int], steps: int) -> dict[str, float]:
    """Displacements [m] of the probes of a rectangle in plane strain, of so many cells along and
    across, loaded in equal steps. The probes must be nodes."""
    case = read_case(path)
    low, high = (end[:2] for end in bounding_box(case.shape))
    points, cells = mesh_of_blocks(box(low, high, counts), "quadrilateral")
    kinematics = PlaneStrain(case.thickness, case.plane_z)
    size = float(high[0] - low[0]) / counts[0]
    recipe = Recipe("quadrilateral", 2, points, cells, size, "strip", kinematics)
    model = PlaneModel(case, recipe)
    solve_static(model, Conditions(model), Newton(model), steps, lambda *_: None)
    answers = {}
    for probe in tomllib.loads(path.read_text())["probe"]:
        for axis, value in zip("xy", model.displacement(probe["point"])):
            answers[f"displacement/{probe['name']}/{axis}"] = float(value)
    return answers


def time_strip(path: Path, counts: tuple[int, int], steps: int) -> None:
    """Prints the answers of a strip with processor time."""
    start = seconds_apart_from_compiling()
    answers = solve_strip(path, counts, steps)
    cpu = round(seconds_apart_from_compiling() - start, 3)
    print(json.dumps({"case": path.stem, "cells": counts, "cpu_s": cpu, "answers": answers}))
