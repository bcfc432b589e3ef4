"""Conditions, loads and obstacles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from .kinds import Function, Path, Triple, Unit, kind_of


@dataclass
class Linear:
    """From 0 to 1 in a straight line, then 1."""

    duration_s: float
    kind: str = kind_of("linear")


@dataclass
class Smooth:
    """From 0 to 1 without jumps of acceleration, then 1."""

    duration_s: float
    kind: str = kind_of("smooth")


@dataclass
class Table:
    """Straight lines through rows of time [s] and factor."""

    rows: Sequence[Sequence[float]]
    kind: str = kind_of("table")


# Conditions and loads


@dataclass
class Displacement:
    """At amplitude 1; a component that is ``None`` is free."""

    x_m: float | None = None
    y_m: float | None = None
    z_m: float | None = None


@dataclass
class Rotation:
    """About an axis; the amplitude multiplies the angle."""

    point_m: Triple
    axis: Triple
    angle_rad: float


@dataclass
class Formula:
    """A vector, such as a displacement [m], as formulas of x, y and z [m]."""

    x: str
    y: str
    z: str | None = None
    factor: float | None = None


@dataclass
class Data:
    """Displacements, or directions, at scattered points or voxels from a file."""

    file: Path
    reach_m: float
    unit: Unit | None = None
    frame: Literal["ras", "lps", "fsl"] | None = None
    field: str | None = None
    beyond: str | None = None
    factor: float | None = None


@dataclass
class Prescribe:
    """A prescribed displacement: a table of this module, or a function of x, y and z that returns three numbers [m]."""

    name: str
    where: Any
    motion: Displacement | Rotation | Formula | Data | Function
    of: Literal["surface", "volume"] = "surface"
    amplitude: Any = None
    release_s: float | None = None


@dataclass
class BodyForce:
    """A force per mass."""

    acceleration_m_s2: Triple | None = None
    where: Any = None
    amplitude: Any = None
    formula: Formula | None = None


@dataclass
class Traction:
    """A force per reference area of fixed direction."""

    name: str
    where: Any
    traction_pa: Triple | None = None
    amplitude: Any = None
    formula: Formula | None = None


@dataclass
class Pressure:
    """A force per deformed area along the inward normal."""

    name: str
    where: Any
    pressure_pa: float
    amplitude: Any = None


@dataclass
class Spring:
    """Springs between each point of a surface and where it was, per reference area."""

    name: str
    where: Any
    normal_pa_per_m: float | None = None
    tangential_pa_per_m: float | None = None


@dataclass
class Fluid:
    """A fluid that fills a cavity; that of water if the bulk modulus is ``None``."""

    inflow_m3: float | None = None
    bulk_modulus_pa: float | None = None
    amplitude: Any = None


@dataclass
class Cavity:
    """A surface that encloses a volume, and what fills it."""

    name: str
    where: Any
    opening_m: Triple | None = None
    fluid: Fluid | None = None


@dataclass
class InitialVelocity:
    """A velocity at t = 0."""

    where: Any
    velocity_m_s: Triple | None = None
    formula: Formula | None = None


@dataclass
class RigidMotion:
    """A motion of an obstacle: along a vector [m] or a rotation."""

    way: Triple | Rotation
    amplitude: Any = None


@dataclass
class Obstacle:
    """A rigid body that nodes may not enter, or not leave."""

    name: str
    shape: Any
    offset_m: float | None = None
    side: Literal["outside", "inside"] | None = None
    friction: Literal["frictionless", "no_slip"] | dict[str, float] | None = None
    motion: Sequence[RigidMotion] = ()
