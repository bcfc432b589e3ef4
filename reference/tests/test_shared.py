"""Case files, hashes, selections and reference files."""

import hashlib
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from mtled_reference.shared.case import Amplitude, Rotation, read_case
from mtled_reference.shared.formula import evaluated
from mtled_reference.shared.materials import material_from_table
from mtled_reference.shared.measurements import Measurements, resultant, rounded
from mtled_reference.shared.problem_hash import canonical_text, problem_hash
from mtled_reference.shared.reference_file import merge_into, reference, write
from mtled_reference.shared.selection import inside, selected

CASES = Path(__file__).parent.parent / "cases"


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_case_is_read(path):
    case = read_case(path)
    assert case.name == path.stem
    assert case.probes and (case.prescriptions or case.body_forces)
    assert case.is_static or case.time.end > 0.0


def test_a_law_that_no_reference_solves_is_refused():
    table = {"law": "ogden", "density": 1000.0, "terms": [{"mu": 842.0, "alpha": -4.7}]}
    with pytest.raises(ValueError, match="material brain: ogden is not solved"):
        material_from_table("brain", table)


def test_what_no_reference_solves_is_refused(tmp_path):
    text = (CASES / "bonded_block.toml").read_text()
    case = tmp_path / "case.toml"
    case.write_text(text + '[[spring]]\nname = "p"\nwhere = "all"\nstiffness = 1.0\n')
    with pytest.raises(ValueError, match="spring is not solved by the references"):
        read_case(case)
    part = "{ sphere = { centre = [0.0, 0.0, 0.0], radius = 1.0 } }"
    case.write_text(text + f"[[body_force]]\nwhere = {part}\nacceleration = [0.0, 0.0, 1.0]\n")
    with pytest.raises(ValueError, match="a body force on a part of the body is not solved"):
        read_case(case).uniform_body_forces()


def test_formulas_of_the_position():
    at = np.array([[0.1, 0.2, 0.3], [1.0, 2.0, -3.0]])
    x, y, z = at.T
    assert evaluated("-0.5*(1-x^2/0.25)^2 + abs(z)*sin(PI*y)", at) == pytest.approx(
        -0.5 * (1 - x**2 / 0.25) ** 2 + np.abs(z) * np.sin(np.pi * y)
    )
    assert evaluated("2", at) == pytest.approx([2.0, 2.0])
    with pytest.raises(ValueError, match="not known"):
        evaluated("x.real", at)


def test_canonical_text():
    document = tomllib.loads('b = [1, 2.5]\na = "é"\nc = { x = true }')
    text = canonical_text(document, Path())
    assert text == "{s1:as2:és1:b[n3ff0000000000000n4004000000000000]s1:c{s1:xb1}}"


def test_files_are_hashed_by_their_content(tmp_path):
    (tmp_path / "map").write_bytes(b"abc")
    text = canonical_text({"file": "map"}, tmp_path)
    assert text == "{s4:filef" + hashlib.sha256(b"abc").hexdigest() + "}"


def test_the_hash_depends_on_the_problem_only():
    document = tomllib.loads((CASES / "falling_beam.toml").read_text())
    hashed = problem_hash(document, CASES)
    changed = document | {"title": "other", "discretisation": {}}
    changed["time"] = document["time"] | {"safety_factor": 0.5}
    assert problem_hash(changed, CASES) == hashed
    changed["time"] = document["time"] | {"end": 0.3}
    assert problem_hash(changed, CASES) != hashed


def test_hashes_are_those_that_rust_computes():
    rows = json.loads((Path(__file__).parent / "problem_hash.json").read_text(encoding="utf-8"))
    for row in rows:
        assert problem_hash(tomllib.loads(row["toml"]), Path()) == row["hash"], row["what"]


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_the_stored_reference_belongs_to_the_case(path):
    stored = json.loads((CASES.parent / "data" / f"{path.stem}.json").read_text(encoding="utf-8"))
    case = read_case(path)
    assert stored["problem_hash"] == problem_hash(case.document, case.folder)


def test_minus_zero_is_zero():
    assert canonical_text(-0.0, Path()) == canonical_text(0, Path())


def test_selections():
    X = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]])
    plane = {"plane": {"point": [0.5, 0, 0], "normal": [2.0, 0, 0]}}
    ball = {"sphere": {"centre": [0, 0, 0], "radius": 1.0}}
    assert selected(plane, X, 1e-9).tolist() == [False, True, False, False]
    assert selected({"not": ball}, X, 1e-9).tolist() == [False, False, False, True]
    both = {"intersection": [ball, {"half_space": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}]}
    assert selected(both, X, 1e-9).tolist() == [True, True, False, False]
    tube = {"cylinder": {"base": [0, 0, -1], "axis": [0, 0, 1], "radius": 0.6, "height": 2.0}}
    assert selected({"shape": tube}, X, 0.0).tolist() == [True, True, False, False]
    assert inside({"difference": [ball, tube]}, X).tolist() == [False, False, True, False]
    assert inside({"intersection": [ball, tube]}, X).tolist() == [True, True, False, False]


def test_polygon_with_tolerance():
    square = {"polygon": {"points": [[0, 0], [1, 0], [1, 1], [0, 1]], "z": [0, 1]}}
    X = np.array([[0.5, 0.5, 0.5], [1.0, 0.5, 0.5], [1.1, 0.5, 0.5], [0.5, 0.5, 2.0]])
    assert inside(square, X, 1e-9).tolist() == [True, True, False, False]
    assert inside(square, X, 0.2).tolist() == [True, True, True, False]
    assert inside(square, X, -1e-3).tolist() == [True, False, False, False]


def test_amplitudes():
    assert Amplitude("smooth", 2.0)(1.0) == 0.5
    assert Amplitude("linear", 2.0)(0.5) == 0.25
    assert Amplitude("table", rows=((0.0, 1.0), (1.0, 3.0)))(0.5) == 2.0
    assert Amplitude()(7.0) == 1.0


def test_a_rotation_turns_about_its_axis():
    turn = Rotation((1.0, 0.0, 0.0), (0.0, 0.0, 2.0), np.pi / 2)
    moved = turn.displacements(np.array([[2.0, 0.0, 5.0], [1.0, 0.0, 3.0]]), 1.0)
    assert np.allclose(moved, [[-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])


def test_a_moment_is_about_displaced_positions():
    force, moment = resultant(
        np.array([[1.0, 0.0]]), np.array([[1.0, 0.0]]), np.array([[0.0, 3.0]]), np.zeros(3)
    )
    assert force.tolist() == [0.0, 3.0, 0.0]
    assert moment.tolist() == [0.0, 0.0, 6.0]


def test_numbers_are_rounded_and_must_be_finite():
    assert rounded([1 / 3, -0.0]) == [0.333333333, 0.0]
    with pytest.raises(ValueError):
        rounded([float("nan")])


def test_merging_keeps_the_other_code(tmp_path):
    case = read_case(CASES / "cook_membrane.toml")

    def solution(code: str, value: float) -> Path:
        values = Measurements()
        values.strain_energy(value)
        path = tmp_path / f"{code}{value}.json"
        write(path, reference(case, [1.0], [{"code": code, "meshes": [{"values": values.values}]}]))
        return path

    merge_into(case, tmp_path, [solution("fenicsx", 1.0), solution("scikit-fem", 2.0)])
    path = merge_into(case, tmp_path, [solution("fenicsx", 3.0)])
    solutions = json.loads(path.read_text())["solutions"]
    stored = {s["code"]: s["meshes"][0]["values"] for s in solutions}
    assert stored["fenicsx"]["strain_energy"] == [[3.0]]
    assert stored["scikit-fem"]["strain_energy"] == [[2.0]]


def test_a_solution_of_another_problem_is_refused(tmp_path):
    case = read_case(CASES / "cook_membrane.toml")
    other = read_case(CASES / "turek_hron_csm1.toml")
    path = tmp_path / "other.json"
    write(path, reference(other, [1.0], [{"code": "fenicsx", "meshes": []}]))
    with pytest.raises(ValueError):
        merge_into(case, tmp_path, [path])
