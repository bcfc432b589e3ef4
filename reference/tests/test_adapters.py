"""What the adapters of the solver protocol share."""

import importlib.util
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from mtled_reference.adapters.cases import counts, is_even, read
from mtled_reference.adapters.files import Quick, Refused, from_values
from mtled_reference.adapters.nodal import Nodal
from mtled_reference.shared.case import BodyForce, read_case
from mtled_reference.shared.materials import strain_energy

CASES = Path(__file__).parent.parent / "cases"


def test_nodes_of_an_even_mesh_have_the_wanted_spacing():
    case = read_case(CASES / "uniaxial_bar.toml")
    low, high, linear = counts(case, 0.005, 1)
    assert linear == [20, 4, 4] and counts(case, 0.005, 2)[2] == [10, 2, 2]
    np.testing.assert_allclose(high - low, [0.1, 0.02, 0.02])
    assert counts(case, 1.0, 2)[2] == [1, 1, 1]


def test_boxes_whose_parts_a_grid_can_follow_get_even_meshes():
    even = {path.stem for path in CASES.glob("*.toml") if is_even(read_case(path))}
    assert even >= {"uniaxial_bar", "cube_compression", "brain_cube_shear", "rubber_block"}
    assert not even & {"indented_block", "inflated_tube", "soft_inclusion", "falling_beam", "cook_membrane"}


def test_a_box_with_a_body_force_on_a_part_gets_no_even_mesh():
    case = read_case(CASES / "uniaxial_bar.toml")
    part = {"half_space": {"point": [0.05, 0.0, 0.0], "normal": [1.0, 0.0, 0.0]}}
    force = BodyForce((0.0, 0.0, -9.81), lambda t: 1.0)
    assert is_even(replace(case, body_forces=[force]))
    assert not is_even(replace(case, body_forces=[replace(force, selector=part)]))


@pytest.mark.parametrize("name", ["bonded_block", "inflated_tube"])
def test_pressures_are_refused_but_on_a_quarter_of_a_ring(name):
    job = {"case": name, "problem": tables(name) | {"pressure": [PRESSURE]}}
    if name == "inflated_tube":
        assert read(job, pressures_on_rings=True).pressures
    else:
        with pytest.raises(Refused, match="pressures"):
            read(job, pressures_on_rings=True)
    with pytest.raises(Refused, match="pressures"):
        read(job)


def test_a_race_takes_the_fewest_parts_of_the_load_that_converge_and_tells_the_rest_apart():
    compiled = iter([0.0, 0.0, 5.0])
    quick = Quick((ValueError,), lambda: next(compiled))

    def attempt(parts: int) -> int:
        if parts == 1:
            raise ValueError("too large")
        return parts

    assert quick.solved(attempt) == 2
    # What was compiled meanwhile, 5 s, is not of the solution.
    assert quick.spent_s == pytest.approx(-5.0, abs=0.5)
    assert quick.apart_s() > 5.0

    with pytest.raises(Refused, match="no convergence"):
        Quick((ZeroDivisionError,)).solved(lambda parts: 1 / 0)


def test_values_of_a_reference_file_become_an_answer():
    values = {
        "displacement/line": [[1, 2, 3, 4, 5, 6]],
        "centre/body": [0, 0, 0],
        "force/top": [[1, 0, 0]],
        "strain_energy": [[7]],
    }
    answer = from_values(values, 12, "Q2")
    assert answer["displacements_m"] == {"line": [[[1, 2, 3], [4, 5, 6]]]}
    assert answer["reactions_n"] == {"top": [[1, 0, 0]]} and answer["strain_energy_j"] == [7]
    assert answer["moments_nm"] == {} and answer["unknowns"] == 12


PRESSURE = {"name": "blood", "where": "all", "pressure": 1.0}
NOT_SOLVED = ("pressure", "spring", "cavity", "initial_velocity")


def tables(name: str) -> dict:
    """The problem of a job is what a case file has."""
    return tomllib.loads((CASES / f"{name}.toml").read_text())


def job_of_a_bar(law: str, spacing: float) -> dict:
    """What adapters read of a job: the uniaxial bar of a law."""
    problem = tables("uniaxial_bar")
    for material in problem["material"].values():
        material["law"] = law
    return {
        "case": "uniaxial_bar",
        "spacing_m": spacing,
        "level": 0,
        "threads": 1,
        "time_limit_s": 60.0,
        "instants_s": [1.0],
        "problem": problem,
    }


def stretched(case, stretch: float) -> tuple[float, float]:
    """Stretch across a bar [–] and its strain energy per volume [Pa]."""
    material = case.regions[0].material

    def energy(across: float) -> float:
        squares = np.array([stretch, across, across]) ** 2
        second = 0.5 * (squares.sum() ** 2 - (squares**2).sum())
        J = stretch * across**2
        return float(strain_energy(material, squares.sum(), second, J, np.log))

    found = minimize_scalar(energy, bounds=(0.8, 1.0), method="bounded", options={"xatol": 1e-12})
    return found.x, found.fun


PROGRAMS = [
    ("ngsolve", "ngsolve", "neo_hookean_log_j", 1e-7),
    ("ngsolve", "ngsolve", "neo_hookean_isochoric", 1e-7),
    ("sfepy", "sfepy", "neo_hookean_log_j", 1e-7),
    ("sfepy", "sfepy", "neo_hookean_isochoric", 1e-7),
    ("calculix", "ccx", "neo_hookean_isochoric", 2e-5),
    ("tatva", "tatva", "neo_hookean_log_j", 1e-7),
    ("simulators.mujoco", "mujoco", "st_venant_kirchhoff", 1e-4),
]
"""Adapters, what they need, laws, and errors [–] of what should be exact."""


@pytest.mark.parametrize("adapter, needed, law, error", PROGRAMS)
def test_a_program_stretches_a_bar(adapter, needed, law, error):
    if not (importlib.util.find_spec(needed) or shutil.which(needed)):
        pytest.skip(f"{needed} is not installed")
    job = job_of_a_bar(law, 0.01)
    case = read(job)
    answer = importlib.import_module(f"mtled_reference.adapters.{adapter}").solve(job)
    across, energy = stretched(case, 1.2)
    exact = case.probes[0].positions * [0.2, across - 1.0, across - 1.0]
    (found,) = answer["displacements_m"]["lattice"]
    np.testing.assert_allclose(found, exact, atol=0.02 * error)
    if "strain_energy_j" in answer:
        np.testing.assert_allclose(answer["strain_energy_j"], energy * 4e-5, rtol=10 * error)
    if "reactions_n" in answer:
        left, right = answer["reactions_n"]["left"][0], answer["reactions_n"]["right"][0]
        np.testing.assert_allclose(left[0], -right[0], rtol=10 * error)
        assert right[0] > 0.0


@pytest.mark.parametrize("name", NOT_SOLVED)
def test_a_load_that_adapters_do_not_know_is_refused(name):
    job = job_of_a_bar("neo_hookean_log_j", 0.01)
    job["problem"][name] = [PRESSURE]
    with pytest.raises(Refused, match=name.split("_")[0]):
        read(job)


@pytest.mark.parametrize("key", ["fibres", "sheets", "active_stress", "prony"])
def test_a_material_that_adapters_do_not_know_is_refused(key):
    job = job_of_a_bar("neo_hookean_log_j", 0.01)
    job["problem"]["material"]["tissue"] = job["problem"]["material"].popitem()[1] | {key: {}}
    with pytest.raises(Refused, match=key):
        read(job)


@pytest.mark.parametrize("degree, simplices", [(1, False), (2, False), (1, True)])
def test_even_meshes_interpolate_linear_fields_and_have_the_volume(degree, simplices):
    case = read_case(CASES / "uniaxial_bar.toml")
    model = Nodal(case, 0.005, degree, simplices)
    gradient = np.array([[0.1, 0.2, 0.3], [0.0, 0.1, 0.2], [0.3, 0.0, 0.1]])
    found = model.displacements(model.points @ gradient)["lattice"]
    np.testing.assert_allclose(found, case.probes[0].positions @ gradient, atol=1e-15)
    np.testing.assert_allclose(model.masses().sum(), 0.04, rtol=1e-12)
    area = model.facet.integrals(model.points[model.facets]).sum()
    np.testing.assert_allclose(area, 2 * 0.0004 + 4 * 0.002, rtol=1e-12)


@pytest.mark.parametrize("degree", [1, 2])
def test_meshes_of_netgen_follow_the_cap_of_a_ball(degree):
    pytest.importorskip("netgen.occ")
    model = Nodal(read_case(CASES / "sphere_gravity.toml"), 0.0075, degree)
    volume = model.masses().sum() / 1000.0
    np.testing.assert_allclose(volume, 4 / 3 * np.pi * 0.04**3, rtol=0.02 / degree**4)
    ((_, mine),) = model.owned
    facets = model.facets[mine.all(axis=1)[model.facets].all(axis=1)]
    cap = model.facet.integrals(model.points[facets]).sum()
    np.testing.assert_allclose(cap, 2 * np.pi * 0.04 * 0.01, rtol=0.02 / degree**4)
    np.testing.assert_allclose(model.loads(1.0).sum(axis=0), [0, 0, -9810 * volume], atol=1e-12)


def test_two_simulators_with_one_material_agree_about_a_block():
    newton = pytest.importorskip("mtled_reference.adapters.simulators.newton")
    mujoco = pytest.importorskip("mtled_reference.adapters.simulators.mujoco")
    job = job_of_a_bar("neo_hookean_log_j", 0.025)
    job |= {"case": "cube_compression", "problem": tables("cube_compression")}
    u, other = (program.solve(job)["displacements_m"]["bulge"] for program in (newton, mujoco))
    # Newton stops in single precision: 2e-4 of the 20 mm of the plate.
    np.testing.assert_allclose(u, other, atol=4e-6)
    assert 0.002 < u[0][0][0] < 0.004
