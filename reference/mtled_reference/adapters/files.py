"""The job that an adapter reads and the answer that it writes."""

import argparse
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


class Quick:
    """Solves as a race does: the load in the fewest parts that converge, to a residual of a
    hundredth of the differences between discretisations. It tells apart the processor
    time of failed attempts, of compiling, of imports and of writing the answer."""

    PARTS = (1, 2, 4, 8, 16)
    """Numbers of parts of the load, tried in turn."""
    RESIDUAL = 1e-4
    """Of Newton's method, over the acting forces [–]."""

    def __init__(self, failures: tuple, compiling: Callable[[], float] = lambda: 0.0):
        self.failures, self.compiling = failures, compiling
        self.spent_s = 0.0

    def solved(self, attempt: Callable[[int], object]) -> object:
        """What `attempt` returns for the first number of parts with which it does not fail."""
        for parts in self.PARTS:
            start = processor_time() - self.compiling()
            try:
                result = attempt(parts)
                self.spent_s = processor_time() - self.compiling() - start
                return result
            except self.failures as error:
                failure = error
        raise Refused(f"no convergence: {failure}", "not_converged")

    def apart_s(self) -> float:
        """Processor time [s] of this process that the solution has not taken."""
        return processor_time() - self.spent_s


def answer(
    name: str, version: Callable[[], str], solve: Callable, elements: tuple[str, ...] = ()
) -> None:
    """Reads the job and writes the answer that the command line names. `solve` returns what an
    answer has beside the solver; where there is a choice of `elements` it gets one too, or None."""
    parser = argparse.ArgumentParser()
    parser.add_argument("job", type=Path)
    parser.add_argument("answer", type=Path)
    if elements:
        parser.add_argument("--element", choices=elements, help="solve an even mesh as a race does")
    options = parser.parse_args()
    job = json.loads(options.job.read_text())
    if job["protocol"] != PROTOCOL:
        sys.exit(f"protocol {job['protocol']} is not spoken here")
    try:
        content = solve(job, options.element) if elements else solve(job)
        content |= {"cpu_s": processor_time(), "peak_memory_bytes": peak_memory()}
    except Refused as refused:
        content = {"refused": {"reason": refused.reason, "what": refused.what}}
    content |= {"protocol": PROTOCOL, "solver": {"name": name, "version": version()}}
    options.answer.write_text(json.dumps(content, allow_nan=False))


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
