"""One run of the race: a problem on a uniform mesh of the whole body, and its cost.

The meshless solver is raced against these on the same machine (`mtled study race`).
No symmetry is used. Newton's method stops where the discretisation is the larger
error, and the load is applied in the fewest steps that converge: both for speed.

A code's module `race_CODE.py` has `run(problem, element, cells, steps, clock)`, which
returns a `Run`; it stops `clock` when the displacements are known.
"""

import datetime
import json
import resource
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .case import Amplitude, Case, Prescription, Probe, Region, Time, read_case
from .manufactured import Manufactured
from .materials import material_from_table
from .problem_hash import problem_hash
from .reference_file import write

RESIDUAL = 1e-4
"""Newton has converged at this residual over the forces at work [–]: a hundredth of
what the discretisations differ by."""

LOAD_STEPS = (1, 2, 4, 8, 16)
"""Tried in turn; only the first that converges is timed."""

MIDDLES = 13
"""Smooth problems are probed at the middles of this many cells per edge: a number that
shares no factor with those of the meshes, which are best or worst at places of their own."""


@dataclass(frozen=True)
class FieldPrescription(Prescription):
    """The boundary follows a manufactured field, in proportion to the amplitude."""

    solution: Manufactured

    def values(self, positions: np.ndarray, factor: float) -> np.ndarray:
        return factor * self.solution.displacement(positions)


@dataclass(frozen=True)
class Problem:
    """A case to be raced; `solution` is the exact one where there is one."""

    case: Case
    solution: Manufactured | None = None


SMOOTH = {
    "smooth_compressible": ("general", "neo_hookean_log_j", 0.3),
    "smooth_nearly_incompressible": ("nearly_isochoric", "neo_hookean_isochoric", 0.49),
}
"""Field, law and Poisson's ratio of the manufactured problems."""


def problem(name: str, cases: Path) -> Problem:
    """The problem of that name; `cases` is the folder of the case files."""
    if name not in SMOOTH:
        return Problem(read_case(cases / f"{name}.toml"))
    field, law, poisson_ratio = SMOOTH[name]
    table = {"law": law, "density": 1000.0, "young_modulus": 3000.0}
    material = material_from_table("solid", table | {"poisson_ratio": poisson_ratio})
    solution = Manufactured(field, material)
    boundary = FieldPrescription(
        "boundary", "surface", "all", (0.0,) * 3, None, Amplitude(), np.inf, solution
    )
    middles = (np.arange(MIDDLES) + 0.5) / MIDDLES
    z, y, x = np.meshgrid(middles, middles, middles, indexing="ij")
    probe = Probe("lattice", np.column_stack([x.ravel(), y.ravel(), z.ravel()]), None)
    case = Case(
        name=name,
        folder=cases,
        document={},
        dimension=3,
        thickness=1.0,
        plane_z=0.0,
        shape={"box": {"min": [0.0] * 3, "max": [1.0] * 3}},
        regions=[Region("body", "all", material)],
        prescriptions=[boundary],
        body_forces=[],
        tractions=[],
        obstacles=[],
        time=Time("static", 0.0, 1.0, 0.0),
        probes=[probe],
        moment_about=np.zeros(3),
    )
    return Problem(case, solution)


@dataclass(frozen=True)
class Run:
    """Displacements (n, 3) [m] at the lattice, and what it took."""

    version: str
    solver: str
    unknowns: int
    elements: int
    newton_iterations: int
    displacement: np.ndarray


class Clock:
    """Processor time of this process and its children [s], less what is set apart."""

    def __init__(self):
        self.apart = 0.0
        self.begin = self.now()
        self.wall = time.monotonic()
        self.cpu_s = self.wall_s = None

    @staticmethod
    def now() -> float:
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.process_time() + children.ru_utime + children.ru_stime

    def stop(self) -> None:
        """The solution is known; what follows costs nothing."""
        self.cpu_s = self.now() - self.begin - self.apart
        self.wall_s = time.monotonic() - self.wall


def write_truth(case_path: Path, solved: Path, refinement: float, out: Path) -> None:
    """Writes the field that the race is measured against from what `solve-mesh` wrote
    of the finest mesh; `refinement` is the size of the next coarser one over its own."""
    case = read_case(case_path)
    result = json.loads(solved.read_text())
    mesh, about = result["mesh"], result["solution"]
    content = {
        "case": case.name,
        "problem_hash": problem_hash(case.document, case.folder),
        "code": "fenicsx",
        "version": about["version"],
        "date": datetime.date.today().isoformat(),
        "element": about["element"],
        "mesh_family": about["mesh_family"],
        "solver": about["solver"],
        "refinement": refinement,
        **{key: mesh[key] for key in ("size_m", "elements", "unknowns", "cpu_s")},
        "displacement_m": mesh["values"]["displacement/lattice"][0],
    }
    out.parent.mkdir(parents=True, exist_ok=True)
    write(out, content)


def race(name: str, cases: Path, code: str, element: str, cells: int, out: Path) -> None:
    """Solves and writes JSON. `start_cpu_s` is what the interpreter and the imports
    took, `compile_cpu_s` the generation of kernels; `cpu_s` is the rest."""
    if code == "fenicsx":
        from .race_fenicsx import run
    else:
        from .race_scikit_fem import run
    chosen = problem(name, cases)
    for steps in LOAD_STEPS:
        clock = Clock()
        start = clock.begin
        try:
            found = run(chosen, element, cells, steps, clock)
            break
        except (RuntimeError, FloatingPointError):
            if steps == LOAD_STEPS[-1]:
                raise
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    content = {
        "problem": name,
        "code": code,
        "version": found.version,
        "solver": found.solver,
        "element": element,
        "cells_per_edge": cells,
        "elements": found.elements,
        "unknowns": found.unknowns,
        "load_steps": steps,
        "newton_iterations": found.newton_iterations,
        "start_cpu_s": round(start, 3),
        "compile_cpu_s": round(clock.apart, 3),
        "cpu_s": round(clock.cpu_s, 4),
        "wall_s": round(clock.wall_s, 4),
        "peak_memory_bytes": peak,
        "displacement_m": [float(f"{u:.9g}") for u in found.displacement.ravel()],
    }
    out.write_text(json.dumps(content))
