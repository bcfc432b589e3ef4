"""Cases from dicts, from dataclasses and with Python functions."""

import mtled
import numpy as np
import pytest
from mtled import problem as p
from mtled import toml
from mtled.problem._tables import table_of

EDGE = 0.1


def stretched(**changes):
    """A block that is stretched by a tenth."""
    face = lambda name, z, motion: p.Prescribe(  # noqa: E731
        name, p.Plane([0.0, 0.0, z], [0.0, 0.0, 1.0]), motion, amplitude=p.Smooth(1.0)
    )
    given = dict(
        title="Stretched block",
        shape=p.Box([0.0, 0.0, 0.0], [EDGE] * 3),
        material={"tissue": p.Material("neo_hookean_log_j", 1000.0, young_modulus_pa=3000.0, poisson_ratio=0.4)},
        discretisation=p.Recipe(spacing_m=0.02),
        time=p.Static(),
        prescribe=[
            face("bottom", 0.0, p.Displacement(0.0, 0.0, 0.0)),
            face("top", EDGE, p.Displacement(0.0, 0.0, 0.01)),
        ],
        probe=[p.Probe("middle", point_m=[0.05, 0.05, 0.05])],
    )
    return p.Problem(**given | changes)


def test_a_problem_of_dataclasses_is_solved():
    result = stretched().case(name="block").solve(error_bars=False)
    (_, displacement) = result.probes["middle"]
    assert displacement[0, 2] == pytest.approx(0.005, rel=0.02)
    assert result.displacement_m[:, 2].max() == pytest.approx(0.01)


def test_a_mistake_in_a_dataclass_has_the_key_of_the_case_file():
    with pytest.raises(mtled.CaseError) as caught:
        stretched(discretisation=p.Recipe(spacing_m=-1.0)).case()
    assert caught.value.key == "discretisation.spacing" and caught.value.file == "case.toml"


def test_what_has_no_key_in_a_case_file_is_written_without():
    box, ball = p.Box([0, 0, 0], [1, 1, 1]), p.Sphere([0, 0, 0], 1.0)
    tables = [{"box": {"min": [0, 0, 0], "max": [1, 1, 1]}}, {"sphere": {"centre": [0, 0, 0], "radius": 1.0}}]
    assert table_of(p.Difference(box, ball)) == {"difference": tables}
    assert table_of(p.Union([box, ball])) == {"union": tables}
    assert table_of(p.Not(p.InShape(ball))) == {"not": {"shape": tables[1]}}
    assert table_of(p.Table([(0, 0), (1, 2)])) == {"table": [[0, 0], [1, 2]]}
    assert table_of(p.Static()) == {"method": "static"}
    turned = p.Prescribe("top", "all", p.Rotation([0, 0, 0], [0, 0, 1], 0.5), release_s=2.0)
    assert table_of(turned) == {
        "name": "top", "where": "all", "of": "surface", "release": 2.0,
        "rotation": {"point": [0, 0, 0], "axis": [0, 0, 1], "angle": 0.5},
    }  # fmt: skip
    with pytest.raises(TypeError, match="the motion of top is .* Rotation, or a function"):
        table_of(p.Prescribe("top", "all", box))


def test_each_dataclass_is_a_table_that_case_files_take():
    held = p.Prescribe("foot", p.HalfSpace([0, 0, 0.03], [0, 0, 1]), p.Formula("0", "0", "0"), of="volume")
    moved = p.RigidMotion([0, 0, -0.001], amplitude=p.Table([(0, 0), (1, 1)]))
    stretched(
        shape=p.Union([p.Box([0, 0, 0], [EDGE] * 3), p.Cylinder([0, 0, 0], [0, 0, 1], 0.03, 0.05)]),
        prescribe=[held],
        region=[p.Region("top", p.Facing([0, 0, 1], 0.5), "tissue"), p.Region("rest", "all", "tissue")],
        traction=[p.Traction("side", p.Plane([EDGE, 0, 0], [1, 0, 0]), [1.0, 0, 0], amplitude=p.Linear(0.5))],
        pressure=[p.Pressure("lid", p.Box([0, 0, 0.09], [EDGE] * 3, tolerance_m=1e-4), 10.0)],
        body_force=[p.BodyForce([0, 0, -9.81], where=p.Not(p.Sphere([0, 0, 0], 0.01)))],
        obstacle=[p.Obstacle("plate", p.HalfSpace([0, 0, 0.2], [0, 0, -1]), friction=p.Coulomb(0.3), motion=[moved])],
        discretisation=p.Recipe(spacing_m=0.02, grid=p.Grid(refine=[p.RefineCell("all", 0.01)])),
        time=p.Dynamic(0.1, damping_per_s=1.0),
        probe=[p.Probe("line", lattice=p.Lattice([0, 0, 0], [EDGE] * 3, [2, 2, 2]))],
        output=p.Output(frames=1),
    ).case()


def test_a_dict_is_the_same_case_as_its_file():
    tables = {
        "title": "Block",
        "geometry": {"shape": {"box": {"min": np.zeros(3), "max": [0.1, 0.1, np.float64(0.1)]}}},
        "material": {"soft tissue": {"law": "neo_hookean_log_j", "density": 1000, "young_modulus": 3e3,
                                     "poisson_ratio": 0.4}},
        "discretisation": {"cloud": "regular", "spacing": 0.02},
        "body_force": [{"acceleration": [0, 0, -9.81]}],
        "prescribe": [{"name": "bottom", "of": "surface", "displacement": {"x": 0, "y": 0, "z": 0},
                       "where": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}}],
        "time": {"method": "static"},
    }  # fmt: skip
    case = mtled.Case.from_dict(tables, name="block")
    assert '[material."soft tissue"]' in case.text and "[[prescribe]]" in case.text
    assert mtled.Case.from_text(case.text, name="block").hash == case.hash
    assert case.solve(error_bars=False).displacement_m[:, 2].min() < -1e-3


def test_values_are_written_as_toml():
    assert toml.value({"a b": [1, 2.5, True, 'x"y\n'], "c": np.float32(0.5)}) == (
        '{ "a b" = [1, 2.5, true, "x\\"y\\n"], c = 0.5 }'
    )
    assert toml.value(np.array([1e-12, 3.0])) == "[1e-12, 3.0]"


def test_the_distance_of_a_sphere_in_python_gives_the_sphere_of_the_case_file():
    radius, centre = 0.04, np.array([0.05, 0.05, 0.05])

    def distance(x, y, z):
        return np.hypot(np.hypot(x - centre[0], y - centre[1]), z - centre[2]) - radius

    bottom = [p.Prescribe("bottom", p.HalfSpace([0.0, 0.0, 0.03], [0.0, 0.0, 1.0]), p.Displacement(0.0, 0.0, 0.0))]
    changes = dict(
        prescribe=bottom, probe=[], discretisation=p.Recipe(spacing_m=0.01), body_force=[p.BodyForce([0, 0, -9.81])]
    )
    own = stretched(shape=p.Distance(distance, centre - radius, centre + radius), **changes).case()
    known = stretched(shape=p.Sphere(centre, radius), **changes).case()
    one, other = own.solve(error_bars=False), known.solve(error_bars=False)
    size = np.abs(other.displacement_m).max()
    assert np.abs(one.displacement_m).max() == pytest.approx(size, rel=0.02)
    with pytest.raises(ValueError, match="does not state the Python"):
        one.write("nowhere")


def test_a_displacement_in_python_is_prescribed():
    motion = lambda x, y, z: (0.0, 0.0, 0.01 * x / EDGE)  # noqa: E731
    result = stretched(prescribe=[
        p.Prescribe("bottom", p.Plane([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]), p.Displacement(0.0, 0.0, 0.0)),
        p.Prescribe("top", p.Plane([0.0, 0.0, EDGE], [0.0, 0.0, 1.0]), motion),
    ]).case().solve(error_bars=False)  # fmt: skip
    top = np.isclose(result.nodes_m[:, 2], EDGE)
    assert result.displacement_m[top, 2] == pytest.approx(0.1 * result.nodes_m[top, 0], abs=1e-9)


def test_what_a_function_raises_is_raised():
    def wrong(x, y, z):
        raise ZeroDivisionError("in the body")

    case = mtled.load("cube_compression")
    with pytest.raises(ZeroDivisionError, match="in the body"):
        case.with_distance(wrong, (0, 0, 0), (EDGE, EDGE, EDGE))
    with pytest.raises(ZeroDivisionError, match="in the body"):
        case.with_displacement(case.conditions[0], wrong).solve()
    with pytest.raises(TypeError):
        case.with_displacement(case.conditions[0], lambda x, y, z: None).solve()
    with pytest.raises(KeyError, match="there is no condition called nobody"):
        case.with_displacement("nobody", wrong)
    with pytest.raises(ValueError, match="lower one below"):
        case.with_distance(wrong, (0, 0, 0), (0, 1, 1), sample_m=0.1)
    with pytest.raises(ValueError, match="must be finite numbers"):
        case.with_distance(lambda x, y, z: np.full_like(x, np.nan), (0, 0, 0), (1, 1, 1))
    with pytest.raises(ValueError, match="of the same length"):
        case.with_distance(lambda x, y, z: x[:5], (0, 0, 0), (1, 1, 1))
    with pytest.raises(ValueError, match="at most"):
        case.with_distance(lambda x, y, z: x, (0, 0, 0), (1, 1, 1), sample_m=1e-6)
