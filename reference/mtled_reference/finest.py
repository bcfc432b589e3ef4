"""The field of the bonded block on a finer mesh than those of its reference."""

import datetime
import json
from pathlib import Path

from .shared.case import read_case
from .shared.problem_hash import problem_hash
from .shared.reference_file import write


def write_reference_solution(case_path: Path, solved: Path, refinement: float, out: Path) -> None:
    """Writes the field from the output of `solve-mesh` on the finest mesh; `refinement` is
    the ratio of the size of the next coarser mesh to its size [–]."""
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
