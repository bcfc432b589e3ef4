"""What the adapters of the solver protocol share."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from mtled_reference.adapters.cases import counts, is_even
from mtled_reference.adapters.files import from_values
from mtled_reference.shared.case import BodyForce, read_case

CASES = Path(__file__).parent.parent / "cases"


def test_nodes_of_an_even_mesh_have_the_wanted_spacing():
    case = read_case(CASES / "uniaxial_bar.toml")
    low, high, linear = counts(case, 0.005, 1)
    assert linear == [20, 4, 4] and counts(case, 0.005, 2)[2] == [10, 2, 2]
    np.testing.assert_allclose(high - low, [0.1, 0.02, 0.02])
    assert counts(case, 1.0, 2)[2] == [1, 1, 1]


def test_boxes_whose_parts_a_grid_can_follow_get_even_meshes():
    even = {path.stem for path in CASES.glob("*.toml") if is_even(read_case(path))}
    assert even >= {"uniaxial_bar", "cube_compression", "brain_cube_shear"}
    assert not even & {"indented_block", "soft_inclusion", "falling_beam", "cook_membrane"}


def test_a_box_with_a_body_force_on_a_part_gets_no_even_mesh():
    case = read_case(CASES / "uniaxial_bar.toml")
    part = {"half_space": {"point": [0.05, 0.0, 0.0], "normal": [1.0, 0.0, 0.0]}}
    force = BodyForce((0.0, 0.0, -9.81), lambda t: 1.0)
    assert is_even(replace(case, body_forces=[force]))
    assert not is_even(replace(case, body_forces=[replace(force, selector=part)]))


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
