"""Meshes of the cases, and cases with known solutions."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse

skfem = pytest.importorskip("skfem")

from mtled_reference.scikit_fem.case_meshes import MESHES, CaseMesh, case_mesh
from mtled_reference.scikit_fem.dynamics import solve_dynamic
from mtled_reference.scikit_fem.factorisation import Factorisation
from mtled_reference.scikit_fem.hexahedra import box_block
from mtled_reference.scikit_fem.mesh import Block, interpolated, mesh_of_blocks
from mtled_reference.scikit_fem.model import Model
from mtled_reference.scikit_fem.newton import solve_static
from mtled_reference.scikit_fem.record import Recorder
from mtled_reference.scikit_fem.solve import solve_mesh
from mtled_reference.shared.case import BodyForce, read_case
from mtled_reference.shared.selection import bounding_box, cut_of_ball, radii_of_quarter_ring

CASES = Path(__file__).parent.parent / "cases"


def silent(fraction: float, message: str) -> None:
    """No report."""


def volume(shape: dict, dimension: int) -> float:
    """Volume of a body [m³], or area of a plane one [m²]."""
    ((kind, content),) = shape.items()
    if kind == "box":
        return float(np.prod(np.subtract(content["max"], content["min"])[:dimension]))
    if kind == "sphere":
        return 4.0 / 3.0 * np.pi * content["radius"] ** 3
    if kind == "cylinder":
        return np.pi * content["radius"] ** 2 * content["height"]
    if radii := radii_of_quarter_ring(shape):
        return 0.25 * np.pi * (radii[1] ** 2 - radii[0] ** 2)
    if kind == "intersection":  # of a ball and a half-space
        radius, depth = cut_of_ball(shape)
        return np.pi / 3.0 * (radius + depth) ** 2 * (2.0 * radius - depth)
    if kind == "difference":  # of two boxes
        whole, cut = map(bounding_box, content)
        common = np.minimum(whole[1], cut[1]) - np.maximum(whole[0], cut[0])
        return float(np.prod(whole[1] - whole[0]) - np.prod(common))
    x, y = np.array(content["points"]).T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


@pytest.mark.parametrize("name", MESHES)
def test_a_mesh_fills_the_body_with_positive_volumes(name):
    case = read_case(CASES / f"{name}.toml")
    division = case_mesh(case, 1)
    mesh = mesh_of_blocks(division.blocks)
    points = skfem.CellBasis(mesh, mesh.elem(), intorder=4)
    measured = points.dx.sum() * 2 ** len(division.symmetry)
    assert measured == pytest.approx(volume(case.shape, case.dimension), rel=1e-3)
    assert points.dx.min() > 0.0
    low, high = bounding_box(case.shape)
    inside = (mesh.doflocs.T >= low[: mesh.dim()] - 1e-9) & (
        mesh.doflocs.T <= high[: mesh.dim()] + 1e-9
    )
    assert inside.all()


@pytest.mark.parametrize("name", MESHES)
def test_meshes_are_refined_by_a_constant_ratio(name):
    case = read_case(CASES / f"{name}.toml")
    elements = [mesh_of_blocks(case_mesh(case, n).blocks).nelements for n in (0, 1, 2)]
    if name != "uniaxial_bar":  # exact on any mesh
        assert elements[1] ** 2 == elements[0] * elements[2]


def test_the_fixed_cap_has_the_exact_area():
    case = read_case(CASES / "sphere_gravity.toml")
    division = case_mesh(case, 1)
    model = Model(case, mesh_of_blocks(division.blocks), division.symmetry)
    facets, _ = model.facets_in(case.prescriptions[0].selector)
    surface = skfem.FacetBasis(model.mesh, model.basis.elem, facets=facets, intorder=6)
    assert 4.0 * surface.dx.sum() == pytest.approx(2.0 * np.pi * 0.04 * 0.01, rel=1e-3)


def test_a_uniaxial_stretch_is_exact():
    case = read_case(CASES / "uniaxial_bar.toml")
    values = solve_mesh(case, 0, silent)["mesh"]["values"]
    mu, lame = case.regions[0].material.shear_modulus, case.regions[0].material.lame_modulus
    stretch, lateral = 1.2, 1.0
    for _ in range(50):  # Newton's method for a lateral stress of zero
        J = stretch * lateral**2
        stress = mu * lateral + (lame * np.log(J) - mu) / lateral
        slope = mu - (lame * np.log(J) - mu) / lateral**2 + 2.0 * lame / lateral**2
        lateral -= stress / slope
    pull = mu * stretch + (lame * np.log(stretch * lateral**2) - mu) / stretch
    force = np.array(values["force/right"][0])
    assert force == pytest.approx([pull * 4e-4, 0.0, 0.0], abs=1e-9)
    lattice = np.array(values["displacement/lattice"][0]).reshape(-1, 3)
    assert lattice == pytest.approx(
        case.probes[0].positions * [0.2, lateral - 1.0, lateral - 1.0], abs=1e-9
    )


def test_a_body_force_on_a_part_of_the_body_is_refused():
    case = read_case(CASES / "uniaxial_bar.toml")
    part = {"half_space": {"point": [0.05, 0.0, 0.0], "normal": [1.0, 0.0, 0.0]}}
    force = BodyForce((0.0, 0.0, -9.81), lambda t: 1.0, selector=part)
    case = replace(case, body_forces=[force])
    division = case_mesh(case, 0)
    model = Model(case, mesh_of_blocks(division.blocks), division.symmetry)
    with pytest.raises(ValueError, match="a body force on a part of the body is not solved"):
        model.loads(lambda amplitude: 1.0)


def values_of(name: str, division: CaseMesh) -> dict:
    """Values of a static case on a mesh."""
    case = read_case(CASES / f"{name}.toml")
    model = Model(case, mesh_of_blocks(division.blocks), division.symmetry)
    solved = solve_static(model, 4, silent, Factorisation())
    recorder = Recorder(model)
    recorder.record(solved.displacements, solved.reactions, solved.strain_energy)
    return recorder.measurements.values


def test_a_quadratic_field_is_interpolated_exactly_on_a_finer_mesh():
    stretch = np.array([[1.0, 0.3, 0.0], [0.0, 0.8, 0.1], [0.2, 0.0, -1.2]])  # left-handed

    def blocks(n: int) -> list[Block]:
        return [
            Block(lambda r: r @ stretch.T, (n, 2 * n, n)),
            Block(lambda r: (r * [-1.0, 1.0, 1.0]) @ stretch.T, (n, 2 * n, n)),
        ]

    coarse, fine = blocks(2), blocks(3)
    bases = [
        skfem.CellBasis(mesh, mesh.elem(), intorder=2)
        for mesh in (mesh_of_blocks(coarse), mesh_of_blocks(fine))
    ]
    places = [basis.doflocs for basis in bases]
    fields = [np.stack([x**2 + y * z, x - 3.0 * z * y], axis=1) for x, y, z in places]
    values = interpolated(coarse, fine, tuple(bases), fields[0])
    assert values == pytest.approx(fields[1], abs=1e-12)


def test_both_direct_solvers_give_the_same(monkeypatch):
    case = read_case(CASES / "uniaxial_bar.toml")
    fast = solve_mesh(case, 0, silent)["mesh"]["values"]
    monkeypatch.setattr("mtled_reference.scikit_fem.factorisation.pypardiso", None)
    slow = solve_mesh(case, 0, silent)["mesh"]["values"]
    for key, value in fast.items():
        assert np.array(slow[key]) == pytest.approx(np.array(value), abs=1e-10), key


@pytest.mark.parametrize("name", ["cube_compression", "bonded_block"])
def test_a_quarter_with_symmetry_gives_the_values_of_the_whole(name):
    edge = 0.1
    quarter = box_block([edge / 2, edge / 2, 0.0], [edge] * 3, (1, 1, 2))
    whole = box_block([0.0] * 3, [edge] * 3, (2, 2, 2))
    planes = [(0, edge / 2), (1, edge / 2)]
    part = values_of(name, CaseMesh([quarter], edge / 2, "", planes))
    full = values_of(name, CaseMesh([whole], edge / 2, "", []))
    assert part.keys() == full.keys()
    for key, value in full.items():
        assert np.array(part[key]) == pytest.approx(np.array(value), abs=1e-8, rel=1e-7), key


def test_the_cut_through_a_tube_carries_the_pressure_on_its_deformed_bore():
    case = read_case(CASES / "inflated_tube.toml")
    division = case_mesh(case, 0)
    model = Model(case, mesh_of_blocks(division.blocks), division.symmetry)
    solved = solve_static(model, 4, silent, Factorisation())
    (pressure,) = case.pressures
    bore = np.flatnonzero(np.linalg.norm(model.nodes - [0.0, 0.01], axis=1) < 1e-9)[0]
    radius = 0.01 + solved.displacements[bore, 1]
    force = solved.reactions[model.supports["x0"], 0].sum()
    assert radius > 0.0145
    assert force == pytest.approx(-pressure.pressure * radius * case.thickness, rel=1e-8)


@pytest.mark.parametrize("name", ["bonded_block", "turek_hron_csm3"])
def test_pressures_in_space_and_in_motion_are_refused(name):
    (pressure,) = read_case(CASES / "inflated_tube.toml").pressures
    case = replace(read_case(CASES / f"{name}.toml"), pressures=[pressure])
    division = case_mesh(case, 0)
    with pytest.raises(ValueError, match="in equilibria in plane strain only"):
        Model(case, mesh_of_blocks(division.blocks), division.symmetry)


def test_the_tangent_of_a_body_under_pressure_is_the_derivative_of_its_forces():
    case = read_case(CASES / "inflated_tube.toml")
    model = Model(case, mesh_of_blocks(case_mesh(case, 0).blocks), [])
    random = np.random.default_rng(1)
    u, along = (1e-4 * random.standard_normal(model.nodes.shape) for _ in range(2))
    along = np.where(model.fixed, 0.0, along)
    _, _, upper, _ = model.internal(u, True)
    whole = upper + upper.T - scipy.sparse.diags(upper.diagonal())
    product = whole @ along.ravel()[model.free]
    forces = [model.internal(u + step * along)[1] for step in (1e-5, -1e-5)]
    expected = ((forces[0] - forces[1]) / 2e-5).ravel()[model.free]
    assert product == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())


def test_energy_is_conserved_without_damping():
    case = read_case(CASES / "falling_beam.toml")
    division = case_mesh(case, 0)
    model = Model(case, mesh_of_blocks(division.blocks), division.symmetry)
    recorder = Recorder(model)
    solve_dynamic(model, recorder, 80, silent, Factorisation())
    values = recorder.measurements.values
    kinetic = np.ravel(values["kinetic_energy"])
    strain = np.ravel(values["strain_energy"])
    fall = np.array(values["displacement/centre of mass"])[:, 2]
    mass = 1000.0 * 0.12 * 0.03 * 0.02
    total = kinetic + strain + mass * 9.81 * fall
    assert np.abs(total).max() < 0.01 * kinetic.max()
