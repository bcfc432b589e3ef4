"""The job that an adapter reads and the answer that it writes."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..shared.resources import peak_memory, processor_time

PROTOCOL = 1


class Refused(Exception):
    """A job that is not solved, with its reason: unsupported, resolution or not_converged."""

    def __init__(self, what: str, reason: str = "unsupported"):
        super().__init__(what)
        self.what, self.reason = what, reason


def answer(name: str, version: Callable[[], str], solve: Callable[[dict], dict]) -> None:
    """Reads the job and writes the answer that the command line names. `solve` returns what an
    answer has beside the solver."""
    job_path, answer_path = sys.argv[1:]
    job = json.loads(Path(job_path).read_text())
    if job["protocol"] != PROTOCOL:
        sys.exit(f"protocol {job['protocol']} is not spoken here")
    try:
        content = solve(job)
        content |= {"cpu_s": processor_time(), "peak_memory_bytes": peak_memory()}
    except Refused as refused:
        content = {"refused": {"reason": refused.reason, "what": refused.what}}
    content |= {"protocol": PROTOCOL, "solver": {"name": name, "version": version()}}
    Path(answer_path).write_text(json.dumps(content, allow_nan=False))


def from_values(values: dict[str, list], unknowns: int, method: str) -> dict:
    """An answer from values by the keys of a reference file."""
    content = {"displacements_m": {}, "reactions_n": {}, "moments_nm": {}}
    tables = {"displacement": "displacements_m", "force": "reactions_n", "moment": "moments_nm"}
    for key, instants in values.items():
        kind, _, name = key.partition("/")
        if kind == "displacement":
            rows = [np.reshape(flat, (-1, 3)).tolist() for flat in instants]
            content[tables[kind]][name] = rows
        elif kind in tables:
            content[tables[kind]][name] = instants
        elif kind in ("strain_energy", "kinetic_energy"):
            content[f"{kind}_j"] = [flat[0] for flat in instants]
    return content | {"unknowns": unknowns, "method": method}
