"""The block on a sphere of `published/block_on_sphere` by FEniCSx: hexahedra with quadratic
displacements, and contact by the energy ∫ ε/2 max(0, R − |X + u − c|)² dA of the surface.

    python -m mtled_reference.block_on_sphere --cells 10 20 --penalties 1e7 4e7 --out FILE

The error of the penalty is of first order in 1/ε; `limit` has the answers without it."""

import argparse
import json
import tomllib
from pathlib import Path

import numpy as np
import ufl
from dolfinx import fem

from .fenicsx import versions
from .fenicsx.conditions import Conditions
from .fenicsx.mesh_blocks import mesh_of_blocks
from .fenicsx.mesh_shapes import box
from .fenicsx.model import Model, Recipe
from .fenicsx.newton import Newton, solve_static
from .fibres import seconds_apart_from_compiling
from .shared.case import read_case
from .shared.selection import bounding_box

PATH = Path(__file__).parents[1] / "published" / "block_on_sphere" / "case.toml"
CELLS_UP = 0.8
"""Cells over the height over those along an edge of the bottom [–]."""
STEPS = 12
"""Equal parts of the way."""
DEGREE = 8
"""Degree to which the energy of contact is integrated [–]."""
RESIDUAL = 1e-8
"""Residual at which Newton's method ends over the acting forces [–]."""


class OnSphere(Model):
    """A model that a rigid sphere pushes back with `penalty` [Pa/m] of the depth, 0 at first."""

    def __init__(self, case, recipe: Recipe, sphere: dict):
        self.sphere = sphere
        super().__init__(case, recipe)

    def _energy_of_contact(self):
        u, x = self.unknown, ufl.SpatialCoordinate(self.domain)
        away = x + u - ufl.as_vector(self.sphere["centre"])
        depth = self.sphere["radius"] - ufl.sqrt(ufl.inner(away, away))
        self.penalty = fem.Constant(self.domain, 0.0)
        ds = ufl.Measure("ds", self.domain, metadata={"quadrature_degree": DEGREE})
        return 0.5 * self.penalty * ufl.conditional(ufl.gt(depth, 0.0), depth**2, 0.0) * ds


def solve(cells: int, penalties: list[float]) -> dict:
    """Answers on a mesh for growing penalties [Pa/m], each from the equilibrium before it."""
    table = tomllib.loads(PATH.read_text())
    (obstacle,) = table.pop("obstacle")
    case = read_case(PATH)
    low, high = bounding_box(case.shape)
    counts = (cells, cells, round(CELLS_UP * cells))
    points, hexahedra = mesh_of_blocks(box(low, high, counts), "hexahedron")
    size = float(high[0] - low[0]) / cells
    recipe = Recipe("hexahedron", 2, points, hexahedra, size, "box", three_fields=False)
    start = seconds_apart_from_compiling()
    model = OnSphere(case, recipe, obstacle["shape"]["sphere"])
    conditions, newton = Conditions(model), Newton(model, RESIDUAL)
    solved = []
    for n, penalty in enumerate(penalties):
        model.penalty.value = penalty
        reactions = solve_static(model, conditions, newton, 1 if n else STEPS, lambda *_: None)
        kept = answers(table, model, conditions, reactions)
        solved.append({"penalty_pa_per_m": penalty, "answers": kept})
        print(json.dumps({"cells": counts, **solved[-1]}), flush=True)
    cpu = round(seconds_apart_from_compiling() - start, 2)
    return {"cells": counts, "unknowns": model.unknown.x.array.size, "cpu_s": cpu, "solved": solved}


def answers(table: dict, model: Model, conditions: Conditions, reactions: np.ndarray) -> dict:
    """Force of the top on the body [N], displacements of probes [m], strain energy [J]."""
    kept = {"force/top/z": float(reactions[conditions.nodes["top"], 2].sum())}
    for probe in table["probe"]:
        for axis, value in zip("xyz", model.displacement(probe["point"])):
            kept[f"displacement/{probe['name']}/{axis}"] = float(value)
    return kept | {"strain_energy": model.strain_energy()}


def without_penalty(solved: list[dict]) -> dict:
    """The answers of the last two penalties, extrapolated to none of the body inside the sphere."""
    before, last = solved[-2:]
    ratio = last["penalty_pa_per_m"] / before["penalty_pa_per_m"]
    return {
        name: value + (value - before["answers"][name]) / (ratio - 1.0)
        for name, value in last["answers"].items()
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, nargs="+", required=True, help="along an edge")
    parser.add_argument("--penalties", type=float, nargs="+", required=True, help="Pa/m, growing")
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    meshes = []
    for cells in options.cells:
        mesh = solve(cells, options.penalties)
        meshes.append({**mesh, "limit": without_penalty(mesh["solved"])})
        print(json.dumps(meshes[-1]["limit"]), flush=True)
        result = {"problem": "block_on_sphere", "packages": versions.packages(), "meshes": meshes}
        options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
