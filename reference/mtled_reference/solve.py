"""Solves a case with one code, each mesh in its own process.

The module of each code has `solve_mesh(case, level, progress) -> dict`. It reports by
`progress(fraction, message)` and returns

    "solution": version, formulation, element, mesh_family, solver,
                time_scheme (dynamic only) and packages,
    "times_s":  instants of the values,
    "mesh":     size_m, elements, unknowns, time_step_s (dynamic only),
                load_steps, newton_iterations and values (shared/measurements.py).
"""

import datetime
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from .process import environment, module_command, this_python
from .shared.case import read_case
from .shared.reference_file import reference, write
from .shared.resources import peak_memory

WHOLE_BRAIN = ("brain_shift", "brain_gravity")
"""Cases of the package `whole_brain`."""

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS")


def solver(code: str, case_name: str) -> Callable:
    """The function `solve_mesh` of the code for the case."""
    # Only one of the codes may be installed.
    if case_name == "brain_slice":
        if code == "fenicsx":
            from .brain.fenicsx import solve_mesh
        else:
            from .brain.scikit_fem import solve_mesh
    elif case_name in WHOLE_BRAIN:
        if code == "fenicsx":
            from .whole_brain.fenicsx import solve_mesh
        else:
            from .whole_brain.scikit_fem import solve_mesh
    elif code == "fenicsx":
        from .fenicsx.solve import solve_mesh
    else:
        from .scikit_fem.solve import solve_mesh
    return solve_mesh


def solve_mesh_here(case_path: Path, code: str, level: int, out: Path) -> None:
    """Solves one mesh in this process and writes the result of `solve_mesh`, with
    processor time [s] and peak memory [bytes]."""
    case = read_case(case_path)
    solve_mesh = solver(code, case.name)

    def progress(fraction: float, message: str) -> None:
        line = {"case": case.name, "code": code, "mesh": level}
        print(json.dumps(line | {"progress": round(fraction, 4), "message": message}), flush=True)

    start = time.process_time()
    result = solve_mesh(case, level, progress)
    mesh = result["mesh"]
    mesh["cpu_s"] = round(time.process_time() - start, 2)
    mesh["peak_memory_bytes"] = peak_memory()
    out.write_text(json.dumps(result))


def solve(case_path: Path, code: str, levels: list[int], out: Path) -> None:
    """Solves the meshes one after another and writes a reference with one solution."""
    case = read_case(case_path)
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for order, level in enumerate(levels):
            path = Path(folder) / f"{level}.json"
            _run_child(case_path, code, level, path, _part(levels, order))
            results.append(json.loads(path.read_text()))
    times = results[0]["times_s"]
    if any(result["times_s"] != times for result in results):
        raise ValueError("the meshes have different instants")
    about = results[-1]["solution"]
    meshes = [_ordered(result["mesh"]) for result in results]
    date = datetime.date.today().isoformat()
    solution = {"code": code, "version": about["version"], "date": date} | about
    write(out, reference(case, times, [solution | {"meshes": meshes}]))


def _ordered(mesh: dict) -> dict:
    """The same table with the values last."""
    return {key: mesh[key] for key in mesh if key != "values"} | {"values": mesh["values"]}


def _part(levels: list[int], order: int) -> tuple[float, float]:
    """Start and length of the progress of a mesh in that of all; each level takes about
    five times as long as the one below."""
    times = [5.0**level for level in levels]
    return sum(times[:order]) / sum(times), times[order] / sum(times)


def _run_child(case_path: Path, code: str, level: int, out: Path, part) -> None:
    """Runs `solve-mesh` with one thread and passes its progress on."""
    arguments = ["solve-mesh", case_path, "--code", code, "--mesh", level, "--out", out]
    command = module_command(this_python(), *arguments)
    one_thread = environment() | {name: "1" for name in ONE_THREAD}
    start, length = part
    with subprocess.Popen(command, env=one_thread, stdout=subprocess.PIPE, text=True) as child:
        try:
            for line in child.stdout:
                _pass_on(line, start, length)
        except BaseException:
            child.terminate()
            raise
    if child.returncode != 0:
        raise RuntimeError(f"mesh {level} of {case_path.stem} was not solved by {code}")


def _pass_on(line: str, start: float, length: float) -> None:
    """Prints a child's line of progress with the fraction of the whole call; other lines
    go to stderr."""
    try:
        report = json.loads(line)
        report["progress"] = round(start + length * report["progress"], 4)
    except (ValueError, KeyError, TypeError):
        sys.stderr.write(line)
        return
    print(json.dumps(report), flush=True)
