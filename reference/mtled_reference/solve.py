"""A case solved with one code, each mesh in a process of its own.

A code's module has `solve_mesh(case, level, progress) -> dict`, where
`progress(fraction, message)` reports, and the dictionary holds

    "solution": version, formulation, element, mesh_family, solver,
                time_scheme (dynamic only) and packages,
    "times_s":  instants of the values,
    "mesh":     size_m, elements, unknowns, time_step_s (dynamic only),
                load_steps, newton_iterations and values (measure.py).
"""

import datetime
import importlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from . import CODES
from .case import read_case
from .reference_file import reference, write

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS")


def module_of(code: str, case_name: str):
    """The module that solves the case with the code."""
    prefix = CODES[code]
    name = f"brain_{prefix}" if case_name == "brain_slice" else f"{prefix}_solve"
    return importlib.import_module(f".{name}", __package__)


def solve_mesh_here(case_path: Path, code: str, level: int, out: Path) -> None:
    """Solves one mesh in this process and writes what `solve_mesh` returned, with
    processor time [s] and peak memory [bytes]."""
    case = read_case(case_path)
    module = module_of(code, case.name)

    def progress(fraction: float, message: str) -> None:
        line = {"case": case.name, "code": code, "mesh": level}
        print(json.dumps(line | {"progress": round(fraction, 4), "message": message}), flush=True)

    start = time.process_time()
    result = module.solve_mesh(case, level, progress)
    mesh = result["mesh"]
    mesh["cpu_s"] = round(time.process_time() - start, 2)
    mesh["peak_memory_bytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    out.write_text(json.dumps(result))


def solve(case_path: Path, code: str, levels: list[int], out: Path) -> None:
    """Solves the meshes one after another and writes a reference with one solution."""
    case = read_case(case_path)
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for order, level in enumerate(levels):
            path = Path(folder) / f"{level}.json"
            _run_child(case_path, code, level, path, _share(levels, order))
            results.append(json.loads(path.read_text()))
    times = results[0]["times_s"]
    if any(result["times_s"] != times for result in results):
        raise ValueError("the meshes are not recorded at the same instants")
    about = results[-1]["solution"]
    meshes = [_ordered(result["mesh"]) for result in results]
    date = datetime.date.today().isoformat()
    solution = {"code": code, "version": about["version"], "date": date} | about
    write(out, reference(case, times, [solution | {"meshes": meshes}]))


def _ordered(mesh: dict) -> dict:
    """The same with the values last."""
    return {key: mesh[key] for key in mesh if key != "values"} | {"values": mesh["values"]}


def _share(levels: list[int], order: int) -> tuple[float, float]:
    """Start and length of a mesh's part of the progress; a finer mesh takes five
    times as long."""
    weights = [5.0**level for level in levels]
    return sum(weights[:order]) / sum(weights), weights[order] / sum(weights)


def _run_child(case_path: Path, code: str, level: int, out: Path, share) -> None:
    """Runs `solve-mesh` with one thread and passes its progress on."""
    package = Path(__file__).resolve().parent
    paths = [str(package.parent), os.environ.get("PYTHONPATH", "")]
    environment = os.environ | {name: "1" for name in ONE_THREAD}
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
    flags = ["-s"] if sys.flags.no_user_site else []
    command = [sys.executable, *flags, "-m", __package__, "solve-mesh", str(case_path)]
    command += ["--code", code, "--mesh", str(level), "--out", str(out)]
    start, length = share
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as child:
        try:
            for line in child.stdout:
                _pass_on(line, start, length)
        except BaseException:
            child.terminate()
            raise
    if child.returncode != 0:
        raise RuntimeError(f"mesh {level} of {case_path.stem} was not solved by {code}")


def _pass_on(line: str, start: float, length: float) -> None:
    """Prints a child's report with its progress turned into that of the whole call;
    lines that are no report go to stderr."""
    try:
        report = json.loads(line)
        report["progress"] = round(start + length * report["progress"], 4)
    except (ValueError, KeyError, TypeError):
        sys.stderr.write(line)
        return
    print(json.dumps(report), flush=True)
