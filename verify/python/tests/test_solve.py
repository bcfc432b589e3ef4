"""A case from its file to arrays."""

import json
import os
import shlex
import subprocess
import sys
import threading
import time

import mtled
import numpy as np
import pytest
from conftest import CUBE

#: The program that results are compared with; without another that of the package.
PROGRAM = shlex.split(os.environ.get("MTLED_PROGRAM", f"{sys.executable} -m mtled"))


def program(*arguments):
    return subprocess.run([*PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=True)


def test_results_are_those_of_the_program_to_the_last_bit(here):
    for name in (CUBE, "brain_slice"):
        program("solve", name, "--out", here / name, "--quiet")
        written = json.loads((here / name / "result.json").read_text())
        result = mtled.load(name).solve()
        own = result.json
        assert own.pop("timings") and written.pop("timings")
        assert json.dumps(own, sort_keys=True) == json.dumps(written, sort_keys=True)
        field = json.loads((here / name / "displacement_field.json").read_text())
        assert np.array_equal(result.nodes_m, np.array(field["nodes_m"]))
        result.write(here / "own")
        for file in (here / name).iterdir():
            if file.name not in ("result.json", "index.html"):
                assert (here / "own" / file.name).read_bytes() == file.read_bytes(), file.name


def test_arrays_are_contiguous_and_own_the_memory_of_the_solver(cube):
    for array in (cube.nodes_m, cube.displacement_m):
        assert array.dtype == np.float64 and array.flags.c_contiguous
        assert array.shape == cube.nodes_m.shape and array.shape[1] == 3
    # The same array each time, not a copy.
    assert np.shares_memory(cube.displacement_m, cube.displacement_m)


def test_displacements_are_those_of_the_field_and_not_nodal_parameters(cube):
    # The top of the cube moves down by 20 mm, in the field exactly.
    assert cube.displacement_m[:, 2].min() == pytest.approx(-0.02, abs=1e-12)
    assert cube.displacement_at(cube.nodes_m) == pytest.approx(cube.displacement_m, abs=0.0)
    places, displacements = next(iter(cube.probes.values()))
    assert np.array_equal(cube.displacement_at(places), displacements)


def test_points_outside_of_all_supports_are_refused(cube):
    with pytest.raises(ValueError, match="10"):
        cube.displacement_at([[10.0, 0.0, 0.0]])
    with pytest.raises(ValueError, match="three columns"):
        cube.displacement_at([[0.0, 0.0]])
    with pytest.raises(ValueError, match="finite"):
        cube.displacement_at([[np.nan, 0.0, 0.0]])


def test_reactions_balance_each_other(cube):
    forces = np.array(list(cube.reactions_n.values()))
    assert np.abs(forces.sum(axis=0)).max() < 1e-5 * np.abs(forces).max()


def test_the_lock_of_the_interpreter_is_free_during_a_run():
    ticks = 0
    done = threading.Event()
    thread = threading.Thread(target=lambda: (mtled.load(CUBE).solve(), done.set()))
    thread.start()
    while not done.is_set():
        ticks += 1
        time.sleep(0.001)
    thread.join()
    assert ticks > 20


def test_two_threads_solve_at_once_with_the_same_bits():
    found = [None, None]

    def work(number):
        found[number] = mtled.load(CUBE).solve(error_bars=False).displacement_m

    threads = [threading.Thread(target=work, args=(number,)) for number in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.array_equal(*found)


def test_progress_goes_from_nothing_to_all(here):
    seen = []
    case = mtled.load("falling_beam")
    case.solve(error_bars=False, progress=lambda fraction, step: seen.append((fraction, step)))
    fractions = [fraction for fraction, _ in seen]
    assert seen and fractions == sorted(fractions) and 0.0 <= fractions[0] and fractions[-1] > 0.999
    assert seen[-1][1] > 0


def test_overrides_take_the_place_of_values_of_the_file():
    case = mtled.load(CUBE, overrides={"discretisation.spacing": 0.025, "title": 'Coarse "cube"'})
    assert case.title == 'Coarse "cube"' and "discretisation.spacing=0.025" in case.overrides
    assert len(case.discretise().nodes_m) < 200


def test_a_case_file_and_its_text_are_the_same_case(here):
    text = mtled.bundled()[CUBE]
    (here / "mine.toml").write_text(text)
    read, parsed = mtled.load("mine.toml"), mtled.Case.from_text(text, name="mine")
    assert read.name == parsed.name == "mine" and read.hash == parsed.hash


def test_the_discretisation_is_a_partition_of_unity():
    found = mtled.load(CUBE).discretise()
    starts = found.support_starts
    assert np.add.reduceat(found.phi, starts[:-1].astype(int)) == pytest.approx(1.0, abs=1e-12)
    assert found.quadrature_weights_m3.sum() == pytest.approx(1e-3, rel=1e-9)
    assert found.grad_phi_per_m.shape == (len(found.support_nodes), 3)
    assert found.nodes_m.shape == (len(found.on_boundary), 3)
    assert found.lumped_mass_kg.sum() == pytest.approx(1.0, rel=1e-9)
    assert found.setup_seconds > 0.0 and found.worst_condition >= 1.0


def test_the_program_is_part_of_the_package(here):
    command = [sys.executable, "-m", "mtled", "--version"]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert printed.strip() == f"mtled {mtled.__version__}"
    assert json.loads(mtled.schema())["title"] == "mtled case"


def test_what_a_run_doubts_of_itself_is_a_warning(cube):
    assert not cube.doubtful and cube.doubts == []
    found = json.loads(json.dumps(cube.json))
    found["audit"]["rows"][0] |= {"doubtful": True, "advice": "use a finer cloud"}

    class Core:
        """A run that has come to something else than was asked."""

        def json(self):
            return json.dumps(found)

        def solve(self, error_bars, progress):
            return self

    with pytest.warns(mtled.DoubtfulWarning, match="asked .* done .* finer cloud"):
        assert mtled.Case(Core()).solve().doubtful
