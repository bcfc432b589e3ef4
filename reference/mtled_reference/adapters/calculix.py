"""Solves a job with CalculiX: python -m mtled_reference.adapters.calculix JOB ANSWER

CalculiX CrunchiX 2.20, apt install calculix-ccx, which puts `ccx` into the path; meshes of bodies
other than boxes need pip install netgen-mesher. Equilibria in 3-D. Boxes get even hexahedra of 20
nodes with reduced integration (C3D20R), which the manual recommends, other bodies tetrahedra of
10 nodes (C3D10), all in displacements alone. Laws are those that CalculiX has: its neo-Hookean
one, ψ = μ/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)², and St. Venant and Kirchhoff's, which is ELASTIC with
NLGEOM. Dead loads are nodal forces (CLOAD): tractions of CalculiX follow the surface.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from ..shared.materials import Material
from . import elements
from .cases import read_without_contact
from .files import Refused, answer
from .nodal import Nodal

STEPS = 4
"""In which loads and supports grow; CalculiX divides them where it does not converge."""
TYPES = {id(elements.HEXAHEDRON_20): "C3D20R", id(elements.TETRAHEDRON_10): "C3D10"}
NUMBER = ".12g"
"""Of numbers, for which CalculiX reads 20 letters."""
PER_LINE = 15
"""Numbers in a line of the input, which has at most 16."""


def solve(job: dict) -> dict:
    """The answer to a job."""
    case = read_without_contact(job)
    if not case.is_static:
        raise Refused("motion in time")
    materials = "".join(
        f"*MATERIAL, NAME=M{number}\n{_law(region.material)}"
        for number, region in enumerate(case.regions)
    )
    model = Nodal(case, job["spacing_m"], 2)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "job.inp").write_text(_mesh(model) + materials + _steps(model))
        run = subprocess.run(["ccx", "job"], cwd=folder, capture_output=True, text=True)
        written = Path(folder, "job.dat")
        tables = _tables(written.read_text()) if written.exists() else {}
    if run.returncode != 0 or "*ERROR" in run.stdout or ("forces", STEPS) not in tables:
        lines = [line.strip() for line in run.stdout.splitlines() if "*ERROR" in line]
        raise Refused(f"ccx: {lines[0] if lines else run.returncode}", "not_converged")
    u, forces = (np.zeros_like(model.points) for _ in range(2))
    for into, name in ((u, "displacements"), (forces, "forces")):
        rows = tables[name, STEPS]
        into[rows[:, 0].astype(int) - 1] = rows[:, 1:]
    # What CalculiX calls forces are internal ones.
    forces -= model.loads(case.time.load_end)
    content = model.answer([(u, forces)])
    return content | {"method": f"{TYPES[id(model.element)]}, SPOOLES"}


def _law(material: Material) -> str:
    if material.is_quadratic_isochoric:
        c_10, d_1 = material.shear_modulus / 2.0, 2.0 / material.bulk_modulus
        return f"*HYPERELASTIC, NEO HOOKE\n{c_10:{NUMBER}}, {d_1:{NUMBER}}\n"
    if material.law == "st_venant_kirchhoff":
        young, nu = material.young_modulus, material.poisson_ratio
        return f"*ELASTIC\n{young:{NUMBER}}, {nu:{NUMBER}}\n"
    raise Refused(f"the law {material.law}")


def _numbers(values) -> str:
    return ", ".join(format(value, NUMBER) for value in values)


def _mesh(model: Nodal) -> str:
    """Nodes, elements by region, and their sections."""
    lines = ["*NODE, NSET=NALL"]
    lines += [f"{n}, {_numbers(row)}" for n, row in enumerate(model.points, 1)]
    for number in range(len(model.case.regions)):
        lines.append(f"*ELEMENT, TYPE={TYPES[id(model.element)]}, ELSET=E{number}")
        for cell in np.flatnonzero(model.owners == number):
            numbers = [cell + 1, *(model.cells[cell] + 1)]
            lines.append(", ".join(map(str, numbers[:PER_LINE])))
            if numbers[PER_LINE:]:
                lines[-1] += ","
                lines.append(", ".join(map(str, numbers[PER_LINE:])))
        lines.append(f"*SOLID SECTION, ELSET=E{number}, MATERIAL=M{number}")
    return "\n".join(lines) + "\n"


def _steps(model: Nodal) -> str:
    """Steps with what is prescribed and the loads at their ends."""
    end, lines = model.case.time.load_end, []
    nodes, axes = np.nonzero(model.fixed)
    loads = model.loads(end)
    loaded = np.argwhere(loads != 0.0).tolist()
    for step in range(1, STEPS + 1):
        values = model.prescribed(end, step / STEPS)[nodes, axes]
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", "1.0, 1.0", "*BOUNDARY"]
        lines += [
            f"{n + 1}, {k + 1}, {k + 1}, {v:{NUMBER}}" for n, k, v in zip(nodes, axes, values)
        ]
        if loaded:
            lines.append("*CLOAD")
            lines += [f"{n + 1}, {k + 1}, {loads[n, k] * step / STEPS:{NUMBER}}" for n, k in loaded]
        lines += ["*NODE PRINT, NSET=NALL", "U, RF", "*END STEP"]
    return "\n".join(lines) + "\n"


def _tables(text: str) -> dict:
    """Rows of node, x, y, z by the name of a table and its time."""
    tables = {}
    for line in text.splitlines():
        title = re.match(r"\s*(displacements|forces) \(.* time\s+(\S+)", line)
        if title:
            rows = tables.setdefault((title[1], float(title[2])), [])
        elif len(line.split()) == 4:
            rows.append([float(word) for word in line.split()])
    return {key: np.array(rows) for key, rows in tables.items()}


def _version() -> str:
    found = subprocess.run(["ccx", "-v"], capture_output=True, text=True).stdout
    return re.search(r"[\d.]+", found)[0]


if __name__ == "__main__":
    if not shutil.which("ccx"):
        sys.exit("ccx is not in the path: apt install calculix-ccx")
    answer("CalculiX", _version, solve)
