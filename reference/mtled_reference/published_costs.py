"""What finite elements with quadratic displacements cost on published problems: quadrilaterals in
plane strain, hexahedra in space, and under pressure hexahedra with a linear pressure in each
(`fibres.py`). A mesh is a block whose map makes the body.

    python -m mtled_reference.published_costs cook_membrane --cells 8 8 --steps 1

prints the answers, the largest difference from the numbers of the problem over their scales, and
the processor time without that of compiling."""

import argparse
import json
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .fenicsx import versions
from .fenicsx.conditions import Conditions
from .fenicsx.kinematics import PlaneStrain, Solid
from .fenicsx.mesh_blocks import Block, mesh_of_blocks
from .fenicsx.mesh_shapes import towards_both, towards_zero
from .fenicsx.model import Model, Recipe
from .fenicsx.newton import Newton, solve_static
from .fibres import Model as ModelUnderPressure
from .fibres import equilibrium, seconds_apart_from_compiling
from .shared.case import read_case

ROOT = Path(__file__).parents[1]
RESIDUAL = 1e-8
"""Residual at which Newton's method ends over the acting forces [–]; in slender bodies
round-off is above the tolerance of the references."""
INNER, OUTER = 0.01, 0.02
"""Radii of the thick walls [m]."""
LENGTH, WIDE, THIN = 12.0, 1.1, 0.32
"""Length, width and thickness of the twisted beam [m]."""


def _membrane(s):
    """The tapered panel, its cells smaller towards the clamped corners."""
    x, y = towards_zero(2.0)(s[:, 0]), towards_both(2.0)(s[:, 1])
    low, high = 0.044 * x, 0.044 + 0.016 * x
    return np.stack([0.048 * x, low + y * (high - low)], axis=1)


def _flag(s):
    """The bar behind the circle, whose arc is a polygon of eight sides."""
    sides = np.linspace(-0.01, 0.01, 9)
    y = 0.02 * s[:, 1] - 0.01
    start = 0.2 + np.interp(y, sides, np.sqrt(0.05**2 - sides**2))
    return np.stack([start + s[:, 0] * (0.6 - start), 0.2 + y], axis=1)


def _strip(s):
    return np.stack([10.0 * s[:, 0], 0.1 * s[:, 1]], axis=1)


def _column(s):
    return np.stack([s[:, 0], 0.02 * s[:, 1]], axis=1)


def _arc(s):
    angle, radius = 0.25 * np.pi * s[:, 0], 99.5 + s[:, 1]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), s[:, 2] - 0.5], axis=1)


def _twisted(s):
    """The width is along y at the clamped end and along z at the other."""
    angle = 0.5 * np.pi * s[:, 0]
    wide, thin = WIDE * (s[:, 1] - 0.5), THIN * (s[:, 2] - 0.5)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([LENGTH * s[:, 0], cosine * wide - sine * thin, sine * wide + cosine * thin], 1)


def _quarter(s):
    """A quarter of the tube; s across the wall, around it and along it."""
    angle, radius = 0.5 * np.pi * s[:, 1], INNER + (OUTER - INNER) * s[:, 0]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.01 * (s[:, 2] - 0.5)], 1)


def _side_of_eighth(axis: int) -> Callable:
    """A third of an eighth of the hollow ball, around an axis; s across the wall and along it."""

    def placed(s):
        across = np.tan(0.25 * np.pi * s[:, 1:])
        far = np.roll(np.insert(across, 0, 1.0, axis=1), axis, axis=1)
        radius = INNER + (OUTER - INNER) * s[:, [0]]
        return radius * far / np.linalg.norm(far, axis=1, keepdims=True)

    return placed


@dataclass(frozen=True)
class Body:
    """Maps of its blocks, and whether a pressure acts on it."""

    maps: tuple[Callable, ...]
    pressure: bool = False


BODIES = {
    "cook_membrane": Body((_membrane,)),
    "turek_hron": Body((_flag,)),
    "plate_strip": Body((_strip,)),
    "euler_column": Body((_column,)),
    "curved_cantilever": Body((_arc,)),
    "twisted_beam": Body((_twisted,)),
    "thick_cylinder": Body((_quarter,), pressure=True),
    "thick_sphere": Body(tuple(_side_of_eighth(axis) for axis in range(3)), pressure=True),
}


def _case_file(problem: str, name: str) -> Path:
    own = ROOT / "published" / problem / f"{name}.toml"
    return own if own.exists() else ROOT / "cases" / f"{name}.toml"


def _under_loads(body: Body, path: Path, counts: tuple[int, ...], steps: int) -> Callable:
    """Displacements [m] at a reference position, under tractions and body forces."""
    case = read_case(path)
    # The linear law has no energy here; strains of 1e-4 are the same by this one.
    linear = case.regions[0].material.law == "linear_elastic"
    if linear:
        material = replace(case.regions[0].material, law="st_venant_kirchhoff")
        case = replace(case, regions=[replace(case.regions[0], material=material)])
    plane = case.dimension == 2
    cell = "quadrilateral" if plane else "hexahedron"
    points, cells = mesh_of_blocks([Block(placed, counts) for placed in body.maps], cell)
    kinematics = PlaneStrain(case.thickness, case.plane_z) if plane else Solid()
    size = float(np.ptp(points, axis=0).max()) / max(counts)
    model = Model(case, Recipe(cell, 2, points, cells, size, "mapped block", kinematics))
    solve_static(model, Conditions(model), Newton(model, RESIDUAL), steps, lambda *_: None)

    return lambda point: np.append(model.displacement(point, 1e-6), 0.0)


def _under_pressure(body: Body, path: Path, counts: tuple[int, ...], steps: int) -> Callable:
    """The same under a pressure that follows the inner surface."""
    case = tomllib.loads(path.read_text())
    if case.get("dimension") == "plane_strain":
        case["prescribe"].append({"name": "plane", "where": "all", "displacement": {"z": 0.0}})
    cell = ModelUnderPressure.cell
    points, cells = mesh_of_blocks([Block(placed, counts) for placed in body.maps], cell)
    # On the planes of symmetry up to round-off.
    points[np.abs(points) < 1e-12] = 0.0
    model = ModelUnderPressure(case, versions.create_mesh(cell, 2, points, cells))
    equilibrium(model, case, steps)

    def displacement(point) -> np.ndarray:
        distances = np.linalg.norm(model.points - point, axis=1)
        if distances.min() > 1e-6:
            raise ValueError(f"no node lies at {point}")
        return model.unknown.x.array[model.fields[int(np.argmin(distances))]]

    return displacement


def solve(problem: str, name: str, counts: tuple[int, ...], steps: int) -> dict:
    """Answers to the numbers of a case, the largest difference over its scale, and the time."""
    path, body = _case_file(problem, name), BODIES[problem]
    numbers = tomllib.loads((ROOT / "published" / problem / "numbers.toml").read_text())["number"]
    probes = {row["name"]: row["point"] for row in tomllib.loads(path.read_text())["probe"]}
    start = seconds_apart_from_compiling()
    solved = _under_pressure if body.pressure else _under_loads
    displacement = solved(body, path, counts, steps)
    cpu = round(seconds_apart_from_compiling() - start, 3)
    answers, worst = {}, 0.0
    for row in numbers:
        if row["case"] != name:
            continue
        _, probe, part = row["answer"].split("/")
        u = displacement(np.asarray(probes[probe]))
        answer = float(np.linalg.norm(u) if part == "size" else u["xyz".index(part)])
        answers[row["name"]] = answer
        worst = max(worst, abs(answer - row["value"]) / abs(row.get("scale", row["value"])))
    return {"case": name, "cells": counts, "difference": worst, "cpu_s": cpu, "answers": answers}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("problem", choices=tuple(BODIES))
    parser.add_argument("case", nargs="?", help="left out where there is one alone")
    parser.add_argument("--cells", type=int, nargs="+", required=True, help="of each block")
    parser.add_argument("--steps", type=int, default=1, help="parts of the load")
    options = parser.parse_args()
    single = "case" if _case_file(options.problem, "case").exists() else options.problem
    name, counts = options.case or single, tuple(options.cells)
    print(json.dumps(solve(options.problem, name, counts, options.steps)))


if __name__ == "__main__":
    main()
