"""Conditions, loads and obstacles.

Written by verify/guide/problem_tables.py from `mtled case schema`; do not edit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, field
from typing import ClassVar, Literal

from ._materials import Amplitude, Data, Formula
from ._shapes import Selector, Shape
from ._tables import Function, Unnamed

__all__ = [
    "BodyForce",
    "Cavity",
    "Coulomb",
    "Displacement",
    "Fluid",
    "InitialVelocity",
    "Obstacle",
    "Prescribe",
    "Pressure",
    "RigidMotion",
    "Rotation",
    "Spring",
    "Traction",
]


@dataclass
class Prescribe:
    """A prescribed displacement: one of `displacement`, `rotation`, `formula` and `data`."""

    name: str
    """Its name in results."""
    where: Selector
    """A part of the body or of its boundary: "all" or a table with one key. Tolerances are lengths [m]; left out, they
    are a thousandth of the nodal spacing."""
    motion: Data | Displacement | Formula | Rotation | Function = field(
        metadata={"keys": ("data", "displacement", "formula", "rotation")}
    )
    """One of these tables, or a function of x, y and z that returns three numbers [m]."""
    _: KW_ONLY
    of: Extent = "surface"
    """Whether nodes are taken from the boundary only or from everywhere."""
    amplitude: Amplitude | None = None
    """A factor over time; constant if left out."""
    release_s: float | None = None
    """Enforced before this time [s]; for ever if left out."""


@dataclass
class Displacement:
    """A displacement at amplitude 1 [m]; a component that is left out is free."""

    x_m: float | None = None
    """Component along x [m]; free if left out."""
    y_m: float | None = None
    """Component along y [m]; free if left out."""
    z_m: float | None = None
    """Component along z [m]; free if left out."""


Extent = Literal["surface", "volume"]
"""Candidates of a selection. "surface": Nodes on the boundary of the body only. "volume": Every node of the body. Where
all components are prescribed for ever and a ball of one spacing fits in, what is held ends at its border and does not
deform: its motion costs no strain energy, and its weight stays in the reaction."""


@dataclass
class Rotation:
    """A rotation about an axis; the amplitude multiplies the angle."""

    point_m: Sequence[float]
    """A point on the axis [m]."""
    axis: Sequence[float]
    """Direction of the axis, of any length [–]."""
    angle_rad: float
    """Angle at amplitude 1 [rad]."""


@dataclass
class BodyForce:
    """A force per mass on the body."""

    acceleration_m_s2: Sequence[float] | None = None
    """Force per mass [m/s²]; left out where a formula is given."""
    _: KW_ONLY
    amplitude: Amplitude | None = None
    """A factor over time; constant if left out."""
    formula: Formula | None = None
    """The same as a function of the position [m/s²]; left out where it is uniform."""
    where: Selector | None = None
    """The part that it acts on, such as what lies above a fluid; everything if left out."""


@dataclass
class Traction:
    """A traction of fixed direction on a part of the boundary."""

    name: str
    """Its name in results."""
    where: Selector
    """A part of the body or of its boundary: "all" or a table with one key. Tolerances are lengths [m]; left out, they
    are a thousandth of the nodal spacing."""
    traction_pa: Sequence[float] | None = None
    """Force per reference area [Pa]; left out where a formula is given."""
    _: KW_ONLY
    amplitude: Amplitude | None = None
    """A factor over time; constant if left out."""
    formula: Formula | None = None
    """The same as a function of the position [Pa]; left out where it is uniform."""


@dataclass
class Pressure:
    """A pressure on the deformed surface: along its inward normal, whatever way it turns."""

    name: str
    """Its name in results."""
    where: Selector
    """A part of the body or of its boundary: "all" or a table with one key. Tolerances are lengths [m]; left out, they
    are a thousandth of the nodal spacing."""
    pressure_pa: float
    """Force per deformed area [Pa], positive where it presses on the body."""
    _: KW_ONLY
    amplitude: Amplitude | None = None
    """A factor over time; constant if left out."""


@dataclass
class Spring:
    """Springs all over a part of the boundary, between each point and where it was: an elastic bed, such as the tissue
    around an organ. One of the two stiffnesses is above 0."""

    name: str
    """Its name in results."""
    where: Selector
    """A part of the body or of its boundary: "all" or a table with one key. Tolerances are lengths [m]; left out, they
    are a thousandth of the nodal spacing."""
    _: KW_ONLY
    normal_pa_per_m: float | None = None
    """Force per reference area and displacement along the normal at rest [Pa/m]. Default: 0.0."""
    tangential_pa_per_m: float | None = None
    """The same along the surface [Pa/m]. Default: 0.0."""


@dataclass
class Cavity:
    """A part of the boundary that encloses a volume, which is recorded, and what fills it."""

    name: str
    """Its name in results."""
    where: Selector
    """All of its surface, or all of it but an opening."""
    _: KW_ONLY
    fluid: Fluid | None = None
    """A fluid that fills it; left out where its volume is only recorded."""
    opening_m: Sequence[float] | None = None
    """A point of the plane of its opening [m], near the rim, which stays in that plane, or of all the planes of
    symmetry that cut it; left out where the surface is closed. Nothing tells whether it lies in that plane: elsewhere
    it gives another volume."""


@dataclass
class Fluid:
    """A fluid whose pressure is its bulk modulus times what it lacks in room over the volume of the cavity at rest, (V₀
    + inflow − V)/V₀. With an inflow a volume is prescribed, and the pressure is the answer."""

    _: KW_ONLY
    amplitude: Amplitude | None = None
    """A factor over time; constant if left out."""
    bulk_modulus_pa: float | None = None
    """Bulk modulus [Pa]; 2.18e9, that of water, if left out. A motion takes steps that are the smaller the larger it
    is."""
    inflow_m3: float | None = None
    """Volume that is added [m³], in a plane to the cavity of the slab; negative where it is drawn off, none if left
    out."""


@dataclass
class InitialVelocity:
    """A velocity at t = 0."""

    where: Selector
    """A part of the body or of its boundary: "all" or a table with one key. Tolerances are lengths [m]; left out, they
    are a thousandth of the nodal spacing."""
    velocity_m_s: Sequence[float] | None = None
    """Its components [m/s]; left out where a formula is given."""
    _: KW_ONLY
    formula: Formula | None = None
    """The same as a function of the position [m/s]; left out where it is uniform."""


@dataclass
class Obstacle:
    """A rigid obstacle."""

    name: str
    """Its name in results."""
    shape: Shape
    """The obstacle or, with side = "inside", the cavity."""
    _: KW_ONLY
    friction: Friction | None = None
    """What happens along the surface of an obstacle. Default: "frictionless"."""
    motion: Sequence[RigidMotion] | None = None
    """How it moves, one motion after the other in axes that stay; left out where it stands still."""
    offset_m: float | None = None
    """The shape is grown by this much first [m]. Default: 0.0."""
    side: Side | None = None
    """Where the body lives. Default: "outside"."""


@dataclass
class Coulomb(Unnamed):
    """Coulomb's law: what acts along the surface is at most this coefficient [–] times what pushes."""

    kind: ClassVar[str] = "coulomb"
    coefficient: float


Friction = Coulomb | Literal["frictionless", "no_slip"]
"""What happens along the surface of an obstacle. "frictionless": Nodes slide freely. "no_slip": Nodes that touch do not
slide."""


@dataclass
class RigidMotion:
    """A motion of an obstacle: a displacement or a rotation."""

    displacement_m: Sequence[float] | None = None
    """Its way at amplitude 1 [m]; left out where a rotation is given."""
    _: KW_ONLY
    amplitude: Amplitude | None = None
    """A factor over time; constant if left out."""
    rotation: Rotation | None = None
    """A rotation; left out where a displacement is given."""


Side = Literal["outside", "inside"]
"""Where the body lives. "outside": The shape is solid, the body stays outside. "inside": The shape is a cavity, the
body stays inside."""
