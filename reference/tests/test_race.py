"""The manufactured fields of the race against SymPy, and its runs against these fields."""

import json
from pathlib import Path

import numpy as np
import pytest

from mtled_reference.race.manufactured import Manufactured
from mtled_reference.race.problems import problem
from mtled_reference.race.run import Clock
from mtled_reference.shared.materials import material_from_table

REFERENCE = Path(__file__).parent.parent
LAWS = ("neo_hookean_log_j", "neo_hookean_isochoric")


def derived() -> dict:
    return json.loads((REFERENCE / "manufactured" / "body_force.json").read_text())


@pytest.mark.parametrize("row", [row for row in derived()["rows"] if row["law"] in LAWS])
def test_body_forces_are_those_that_sympy_derives(row):
    table = {
        "law": row["law"],
        "density": derived()["density"],
        "young_modulus": derived()["young_modulus"],
        "poisson_ratio": row["poisson_ratio"],
    }
    material = material_from_table("solid", table)
    field = "general" if row["field"] == "general" else "nearly_isochoric"
    solution = Manufactured(field, material)
    X = np.array([row["position"]])
    assert np.allclose(solution.displacement(X)[0], row["displacement"], rtol=0, atol=1e-15)
    F = solution.deformation_gradient(X)[0]
    assert np.allclose(F, row["deformation_gradient"], rtol=0, atol=1e-14)
    round_off = 1e-13 * material.bulk_modulus / material.shear_modulus
    b = np.array(row["body_force"])
    assert np.linalg.norm(solution.body_force(X)[0] - b) < round_off * max(1, np.linalg.norm(b))


@pytest.mark.parametrize("name", ["smooth_compressible", "smooth_nearly_incompressible"])
def test_a_finer_mesh_is_closer_to_the_manufactured_field(name):
    pytest.importorskip("skfem")
    from mtled_reference.race.scikit_fem import run

    chosen = problem(name, REFERENCE / "cases")
    exact = chosen.solution.displacement(chosen.case.probes[0].positions)
    element = "Q2" if name == "smooth_compressible" else "Q2/P1"
    errors = []
    for cells in (2, 4):
        solved = run(chosen, element, cells, 1, Clock())
        errors.append(np.linalg.norm(solved.displacement - exact) / np.linalg.norm(exact))
    assert errors[1] < 0.2 * errors[0] < 0.01
