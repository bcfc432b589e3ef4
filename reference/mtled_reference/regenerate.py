"""Solves all cases with both codes in parallel processes and merges the solutions."""

import json
import shlex
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from .process import environment, module_command, this_python
from .shared.case import read_case
from .shared.reference_file import merge_into


def regenerate(
    cases: list[Path], codes: list[str], interpreters: dict, data: Path, jobs: int
) -> None:
    """Solves every case with every code and writes `data`/CASE.json; prints a row
    for each solution, then the total time [s] and the peak memory [bytes]."""
    start = time.monotonic()
    rows, failures = [], []
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(jobs) as pool:
        tasks = [
            (path, code, Path(folder) / f"{path.stem}.{code}.json")
            for path in cases
            for code in codes
        ]
        runs = [
            pool.submit(_solve, path, code, out, interpreters.get(code))
            for path, code, out in tasks
        ]
        for (path, code, out), run in zip(tasks, runs):
            if run.result() != 0:
                failures.append(f"{path.stem} with {code}")
                continue
            rows += _rows(path.stem, json.loads(out.read_text())["solutions"])
            merge_into(read_case(path), data, [out])
            print(f"solved {path.stem} with {code}", flush=True)
    _print_table(rows)
    if rows:
        print(f"processor time {sum(row['cpu_s'] for row in rows):.0f} s", end=", ")
        print(f"elapsed {time.monotonic() - start:.0f} s", end=", ")
        print(f"largest process {max(row['peak_memory_bytes'] for row in rows) / 1e6:.0f} MB")
    if failures:
        raise RuntimeError("not solved: " + ", ".join(failures))


def _solve(case: Path, code: str, out: Path, interpreter: str | None) -> int:
    """Exit code of the command `solve` in the interpreter of the code."""
    python = shlex.split(interpreter) if interpreter else this_python()
    command = module_command(python, "solve", case, "--code", code, "--out", out)
    return subprocess.run(command, env=environment(), stdout=subprocess.DEVNULL).returncode


def _rows(case: str, solutions: list[dict]) -> list[dict]:
    return [
        {"case": case, "code": solution["code"], "level": level, **mesh}
        for solution in solutions
        for level, mesh in enumerate(solution["meshes"])
    ]


def _print_table(rows: list[dict]) -> None:
    heading = f"{'case':24}{'code':12}{'mesh':>5}{'elements':>10}{'unknowns':>10}"
    print(heading + f"{'CPU s':>9}{'MB':>7}")
    for row in rows:
        print(
            f"{row['case']:24}{row['code']:12}{row['level']:5}{row['elements']:10}"
            f"{row['unknowns']:10}{row['cpu_s']:9.1f}{row['peak_memory_bytes'] / 1e6:7.0f}"
        )
