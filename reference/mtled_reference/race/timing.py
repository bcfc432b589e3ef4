"""One timed run of the race, on a uniform mesh of the whole body.

The meshless solver is timed on the same machine (`mtled study race`). For speed, Newton's
method stops where the error of the discretisation dominates, and the load is applied in the
fewest steps that converge. Symmetry is not used.
"""

import json
from pathlib import Path

from ..shared.measurements import nine_digits
from ..shared.resources import peak_memory
from .problems import problem
from .run import Clock

LOAD_STEPS = (1, 2, 4, 8, 16)
"""Numbers of load steps, tried in turn. Only the first that converges is timed."""


def race(name: str, cases: Path, code: str, element: str, cells: int, out: Path) -> None:
    """Solves a problem and writes JSON. `start_cpu_s` is the time of the interpreter and
    the imports, `compile_cpu_s` that of generating kernels, `cpu_s` the rest."""
    # Only one of the codes may be installed.
    if code == "fenicsx":
        from .fenicsx import run
    else:
        from .scikit_fem import run
    chosen = problem(name, cases)
    for steps in LOAD_STEPS:
        clock = Clock()
        try:
            solved = run(chosen, element, cells, steps, clock)
            break
        except (RuntimeError, FloatingPointError):
            if steps == LOAD_STEPS[-1]:
                raise
    content = {
        "problem": name,
        "code": code,
        "version": solved.version,
        "solver": solved.solver,
        "element": element,
        "cells_per_edge": cells,
        "elements": solved.elements,
        "unknowns": solved.unknowns,
        "load_steps": steps,
        "newton_iterations": solved.newton_iterations,
        "start_cpu_s": round(clock.begin, 3),
        "compile_cpu_s": round(clock.apart, 3),
        "cpu_s": round(clock.cpu_s, 4),
        "wall_s": round(clock.wall_s, 4),
        "peak_memory_bytes": peak_memory(),
        "displacement_m": [nine_digits(u) for u in solved.displacement.ravel()],
    }
    out.write_text(json.dumps(content))
