"""The problems of the race: a case of the files, or a manufactured field on the unit cube."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..shared.case import (
    Amplitude,
    Case,
    Prescription,
    Probe,
    Region,
    Time,
    lattice_positions,
    read_case,
)
from ..shared.materials import material_from_table
from .manufactured import Manufactured

CELLS_OF_LATTICE = 13
"""Cells per edge whose centres are the probes of the manufactured problems. The number has
no common factor with those of the meshes, whose errors are least or largest at special
points of their cells."""


@dataclass(frozen=True)
class FieldPrescription(Prescription):
    """The boundary follows a manufactured field, in proportion to the amplitude."""

    solution: Manufactured

    def values(self, positions: np.ndarray, factor: float) -> np.ndarray:
        return factor * self.solution.displacement(positions)


@dataclass(frozen=True)
class Problem:
    """A case of the race; `solution` is the exact one, where it is known."""

    case: Case
    solution: Manufactured | None = None

    @property
    def lattice(self) -> np.ndarray:
        """Positions (n, 3) [m] at which displacements are compared."""
        (probe,) = [probe for probe in self.case.probes if probe.name == "lattice"]
        return probe.positions


SMOOTH = {
    "smooth_compressible": ("general", "neo_hookean_log_j", 0.3),
    "smooth_nearly_incompressible": ("nearly_isochoric", "neo_hookean_isochoric", 0.49),
}
"""Field, law and Poisson's ratio of the manufactured problems."""


def problem(name: str, cases: Path) -> Problem:
    """The problem with a name; `cases` is the folder of the case files."""
    if name not in SMOOTH:
        return Problem(read_case(cases / f"{name}.toml"))
    field, law, poisson_ratio = SMOOTH[name]
    table = {"law": law, "density": 1000.0, "young_modulus": 3000.0}
    material = material_from_table("solid", table | {"poisson_ratio": poisson_ratio})
    solution = Manufactured(field, material)
    boundary = FieldPrescription(
        "boundary", "surface", "all", (0.0,) * 3, None, Amplitude(), np.inf, solution
    )
    centres = (np.arange(CELLS_OF_LATTICE) + 0.5) / CELLS_OF_LATTICE
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
        probes=[Probe("lattice", lattice_positions(centres, centres, centres), None)],
        moment_about=np.zeros(3),
    )
    return Problem(case, solution)
