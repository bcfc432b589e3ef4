"""Studies as functions that return tables, and solvers written in Python."""

import json
import os
import signal
import threading
from pathlib import Path

import mtled
import pytest
from conftest import CUBE

SOLVER = """
import numpy as np
import mtled

@mtled.solver(name="template", version="0.1")
def solve(job):
    \"\"\"A rigid answer: nothing moves.\"\"\"
    if job["problem"]["obstacle"]:
        raise mtled.Refused("contact")
    rest = lambda probe: np.zeros((len(job["instants_s"]), len(probe.get("positions_m") or [0]), 3))
    return {
        "displacements_m": {probe["name"]: rest(probe) for probe in job["probes"]},
        "unknowns": np.int64(1 + job["level"]),
    }

if __name__ == "__main__":
    solve.main()
"""


def test_a_convergence_study_is_tables(here):
    report = mtled.study("convergence", "uniaxial_bar", spacing="x2,x1.6", clouds=1)
    assert report.outcome in ("passed", "inconclusive") and (report.folder / "index.html").is_file()
    rows = next(rows for rows in report.tables.values() if len(rows) >= 2)
    assert all(isinstance(row, dict) for row in rows)
    assert (here / "reports" / "runs").is_dir()
    pytest.importorskip("pandas")
    title = next(iter(report.tables))
    assert len(report.to_pandas(title)) == len(report.tables[title])


def test_one_study_of_the_verification_passes(here):
    report = mtled.verify(only="parts")
    assert report.outcome == "passed" and report.checks and all(check["pass"] for check in report.checks)
    assert "passed" in repr(report)


def test_a_case_of_dataclasses_and_overrides_can_be_studied(here):
    case = mtled.Case.from_text(mtled.bundled()["uniaxial_bar"], name="mine", overrides={"output.frames": 0})
    report = mtled.study("timestep", case, dilation=[1.6, 1.8])
    assert len(next(iter(report.tables.values()))) == 2
    with pytest.raises(ValueError, match="solve it here"):
        mtled.study("timestep", case.with_distance(lambda x, y, z: x - 0.01, (0, 0, 0), (0.02, 0.02, 0.02)))


def test_tuning_writes_a_case_file(here):
    report = mtled.tune("uniaxial_bar", target_error=0.05, dilation="1.6,1.8", cells_per_spacing="1.26", clouds=1)
    assert report.outcome in ("passed", "failed", "inconclusive")
    if report.outcome == "passed":
        assert list(report.folder.glob("*.tuned.toml"))


def test_sensitivities_are_tables_by_numbers_and_answers(here):
    found = mtled.sensitivity("cube_shear", of=["force/top", "strain_energy"], check=True)
    young = "material.tissue.young_modulus"
    assert list(found.answers) == ["force/top", "strain_energy"]
    # A force grows as the stiffness where displacements are prescribed.
    assert found.per_cent_per_per_cent[young]["force/top"] == pytest.approx(1.0, abs=1e-7)
    assert found.by_solutions[young]["force/top"] == pytest.approx(1.0, abs=1e-4)
    modulus = next(number["value"] for number in found.json["numbers"] if number["key"] == young)
    assert found.derivatives[young]["force/top"] == pytest.approx(found.answers["force/top"] / modulus)
    assert "prescribe.top" in repr(found)
    pytest.importorskip("pandas")
    assert found.to_pandas().loc[young, "strain_energy"] == pytest.approx(1.0, abs=1e-7)
    with pytest.raises(mtled.MtledError, match="there is no answer `force/bottm`"):
        mtled.sensitivity("cube_shear", of=["force/bottm"])


def test_a_mistake_in_a_studied_case_is_a_case_error(here):
    with pytest.raises(mtled.MtledError, match="nowhere"):
        mtled.study("convergence", "nowhere.toml")
    Path("bad.toml").write_text(mtled.bundled()[CUBE].replace("density", "densty"))
    with pytest.raises(mtled.CaseError) as caught:
        mtled.study("convergence", "bad.toml")
    assert caught.value.key.endswith("densty") and caught.value.line > 1
    with pytest.raises(mtled.MtledError, match="unexpected argument"):
        mtled.study("convergence", CUBE, colour="red")


def test_ctrl_c_ends_a_study(here):
    threading.Timer(1.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        mtled.study("convergence", "twisted_cylinder", clouds=50)


def test_a_solver_in_python_is_measured(here):
    Path("mine.py").write_text(SOLVER)
    report = mtled.measure_solvers({"mine": "mine.py"}, "uniaxial_bar", spacing="x2,x1.41", time_limit=60)
    text = json.dumps(report.json["studies"])
    assert "mine" in text and "mtled" in text
    # An answer that does not change with the resolution is doubtful.
    assert report.outcome == "failed"
    with pytest.raises(FileNotFoundError, match="neither a file"):
        mtled.measure_solvers({"mine": "not_there.py"}, "uniaxial_bar")


def test_a_solver_answers_and_refuses_by_the_protocol():
    names = {}
    exec(SOLVER, names)
    solve = names["solve"]
    job = {"protocol": 1, "problem": {"obstacle": []}, "instants_s": [1.0], "level": 0,
           "probes": [{"name": "tip", "positions_m": [[0.0, 0.0, 0.0]]}]}  # fmt: skip
    assert solve(job)["solver"] == {"name": "template", "version": "0.1"}
    refused = solve(job | {"problem": {"obstacle": [1]}})["refused"]
    assert refused == {"reason": "unsupported", "what": "contact"}
    with pytest.raises(ValueError, match="version 2"):
        solve(job | {"protocol": 2})
    with pytest.raises(SystemExit, match="two files"):
        solve.main([])
