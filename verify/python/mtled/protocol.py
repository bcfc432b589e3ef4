"""Solvers written in Python, which the harness measures.

A file with a solver::

    import mtled

    @mtled.solver(name="mine", version="0.1")
    def solve(job):
        if job["problem"]["obstacle"]:
            raise mtled.Refused("contact")
        return {"displacements_m": ..., "unknowns": ...}

    if __name__ == "__main__":
        solve.main()

``mtled.measure_solvers({"mine": "mine.py"})`` runs it on the bundled cases. The job and the keys
of the answer are those of the solver protocol, whose JSON Schemas ``mtled protocol schema job``
and ``answer`` print.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np

VERSION = 1

Job = dict[str, Any]


class Refused(Exception):
    """A solver raises it where it does not solve a job, which is no fault."""

    def __init__(
        self, what: str, reason: Literal["unsupported", "resolution", "not_converged"] = "unsupported"
    ) -> None:
        super().__init__(what)
        self.what = what
        self.reason = reason


class Solver:
    """A function from a job to an answer, with the name and version that the answer states."""

    def __init__(self, function: Callable[[Job], Mapping[str, Any]], name: str, version: str) -> None:
        self.function = function
        self.about = {"protocol": VERSION, "solver": {"name": name, "version": version}}

    def __call__(self, job: Job) -> dict[str, Any]:
        """The answer to a job, or its refusal."""
        if job.get("protocol") != VERSION:
            raise ValueError(f"the job has version {job.get('protocol')} of the protocol; this is for {VERSION}")
        try:
            return self.about | dict(self.function(job))
        except Refused as refused:
            return self.about | {"refused": {"reason": refused.reason, "what": refused.what}}

    def main(self, arguments: list[str] | None = None) -> None:
        """Reads the job and writes the answer, the two files that the command line names."""
        arguments = sys.argv[1:] if arguments is None else arguments
        if len(arguments) != 2:
            sys.exit("give two files: the job, which is read, and the answer, which is written")
        with open(arguments[0], encoding="utf-8") as file:
            job = json.load(file)
        answer = json.dumps(self(job), allow_nan=False, default=_plain)
        with open(arguments[1], "w", encoding="utf-8") as file:
            file.write(answer)


def solver(*, name: str, version: str = "0") -> Callable[[Callable[[Job], Mapping[str, Any]]], Solver]:
    """Makes a function of a job a solver that the harness can run."""
    return lambda function: Solver(function, name, version)


def _plain(item: Any) -> Any:
    """Arrays and numbers of numpy as JSON has them."""
    if isinstance(item, (np.ndarray, np.generic)):
        return item.tolist()
    raise TypeError(f"an answer has numbers, texts and lists, not {type(item).__name__}")
