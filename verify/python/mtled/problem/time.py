"""Time, probes and output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from .kinds import Path, Triple, Unit, kind_of


@dataclass
class Static:
    """A static solution."""

    solver: Literal["auto", "newton", "relaxation"] | None = None
    load_end_s: float | None = None
    load_steps: int | None = None
    tolerance: float | None = None
    max_steps: int | None = None
    parts: int | None = None
    safety_factor: float | None = None
    reevaluate_every: int | None = None
    method: str = kind_of("static")


@dataclass
class Dynamic:
    """A motion in time."""

    end_s: float
    damping_per_s: float | None = None
    safety_factor: float | None = None
    reevaluate_every: int | None = None
    mass_scaling: float | None = None
    fixed_step_s: float | None = None
    method: str = kind_of("dynamic")


@dataclass
class Points:
    """Reference positions from a CSV file."""

    file: Path
    unit: Unit | None = None


@dataclass
class Lattice:
    """Equally spaced reference positions, ends included."""

    min_m: Triple
    max_m: Triple
    counts: Sequence[int]


@dataclass
class Probe:
    """Where displacements are recorded: one of a point, points, a lattice and a centre of mass."""

    name: str
    point_m: Triple | None = None
    points: Points | None = None
    lattice: Lattice | None = None
    centre_of_mass: str | None = None


@dataclass
class PlaneStrain:
    """The slice of a plane-strain problem."""

    thickness_m: float
    z_m: float


@dataclass
class Output:
    """What is recorded."""

    frames: int | None = None
    times_s: Sequence[float] | None = None
    states_s: Sequence[float] | None = None
    history: int | None = None
    moment_about_m: Triple | None = None
    volumes: bool | None = None
