"""The template of an adapter (adapters/template.py) keeps to the protocol and converges."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

TEMPLATE = Path(__file__).parent.parent / "adapters" / "template.py"
YOUNG, NU, LENGTH, PULL = 3000.0, 0.3, 0.1, 0.01


def plane(axis: int, at: float) -> dict:
    point, normal = np.zeros(3), np.zeros(3)
    point[axis], normal[axis] = at, 1.0
    return {"plane": {"point": [*point], "normal": [*normal]}}


def support(name: str, where: dict, **components) -> dict:
    return {"name": name, "of": "surface", "where": where, "displacement": components}


def job(spacing: float) -> dict:
    """A bar that is pulled along x and free to contract, a quarter of it."""
    in_numbers = {
        "shear_modulus_pa": YOUNG / (2 * (1 + NU)),
        "lame_modulus_pa": YOUNG * NU / ((1 + NU) * (1 - 2 * NU)),
    }
    return {
        "protocol": 1,
        "spacing_m": spacing,
        "probes": [{"kind": "positions", "name": "end", "positions_m": [[LENGTH, 0.02, 0.02]]}],
        "selection_tolerance_m": 1e-6,
        "materials": {"tissue": in_numbers},
        "factors": {"prescribe": [[1.0]] * 4},
        "problem": {
            "dimension": "3d",
            "geometry": {"shape": {"box": {"min": [0, 0, 0], "max": [LENGTH, 0.02, 0.02]}}},
            "region": [{"name": "body", "where": "all", "material": "tissue"}],
            "material": {"tissue": {"law": "neo_hookean_log_j"}},
            "prescribe": [
                support("left", plane(0, 0.0), x=0.0),
                support("front", plane(1, 0.0), y=0.0),
                support("bottom", plane(2, 0.0), z=0.0),
                support("right", plane(0, LENGTH), x=PULL),
            ],
            "obstacle": [],
            "time": {"method": "static"},
        },
    }


@pytest.fixture
def answer(tmp_path):
    def run(content: dict) -> dict:
        (tmp_path / "job.json").write_text(json.dumps(content))
        files = [tmp_path / "job.json", tmp_path / "answer.json"]
        subprocess.run([sys.executable, TEMPLATE, *files], check=True)
        return json.loads(files[1].read_text())

    return run


def free_contraction(stretch: float) -> tuple[float, float]:
    """Lateral stretch and first Piola–Kirchhoff stress [Pa] of a bar that is free to contract."""
    material = job(1.0)["materials"]["tissue"]
    mu, lam = material["shear_modulus_pa"], material["lame_modulus_pa"]
    low, high = 0.5, 1.5
    for _ in range(80):
        side = 0.5 * (low + high)
        residual = mu * (side**2 - 1) + lam * np.log(stretch * side**2)
        low, high = (side, high) if residual < 0 else (low, side)
    J = stretch * side**2
    return side, (mu * (stretch**2 - 1) + lam * np.log(J)) / stretch


def test_a_pulled_bar_has_the_displacement_and_the_force_of_the_closed_form(answer):
    content = answer(job(0.02))
    side, stress = free_contraction(1.0 + PULL / LENGTH)
    np.testing.assert_allclose(
        content["displacements_m"]["end"], [[[PULL, 0.02 * (side - 1), 0.02 * (side - 1)]]], rtol=1e-6
    )
    np.testing.assert_allclose(content["reactions_n"]["right"][0][0], stress * 0.02**2, rtol=1e-6)
    assert content["unknowns"] > 0 and content["strain_energy_j"][0] > 0.0


def test_what_is_not_solved_is_refused_by_name(answer):
    content = job(0.02)
    content["problem"]["obstacle"] = [{"name": "floor"}]
    refused = answer(content)["refused"]
    assert refused["reason"] == "unsupported" and "obstacle" in refused["what"]
