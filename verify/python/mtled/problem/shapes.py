"""Shapes, and selections of parts of a body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from .kinds import Function, Path, Triple, Unit, kind_of


@dataclass
class Box:
    """Axis-parallel, between two corners; a shape, or with a tolerance a selection."""

    min_m: Triple
    max_m: Triple
    tolerance_m: float | None = None
    kind: str = kind_of("box")


@dataclass
class Cylinder:
    """From ``base_m`` along ``axis`` over ``height_m``."""

    base_m: Triple
    axis: Triple
    radius_m: float
    height_m: float
    kind: str = kind_of("cylinder")


@dataclass
class Sphere:
    """A shape, or with a tolerance a selection."""

    centre_m: Triple
    radius_m: float
    tolerance_m: float | None = None
    kind: str = kind_of("sphere")


@dataclass
class Ellipsoid:
    """Axis-parallel with three semi-axes."""

    centre_m: Triple
    radii_m: Triple
    kind: str = kind_of("ellipsoid")


@dataclass
class Polygon:
    """A polygon in x and y, extruded from z_m[0] to z_m[1]."""

    points_m: Sequence[Sequence[float]]
    z_m: Sequence[float]
    kind: str = kind_of("polygon")


@dataclass
class HalfSpace:
    """Everything behind a plane, whose normal points out; a shape, or with a tolerance a selection."""

    point_m: Triple
    normal: Triple
    tolerance_m: float | None = None
    kind: str = kind_of("half_space")


@dataclass
class Stl:
    """A closed surface from an STL, OBJ, PLY, VTP or legacy VTK file."""

    file: Path
    unit: Unit
    kind: str = kind_of("stl")


@dataclass
class LabelMap:
    """The voxels of some labels of an NRRD or NIfTI file."""

    file: Path
    labels: Sequence[int]
    unit: Unit | None = None
    smoothing: float | None = None
    layer: int | None = None
    kind: str = kind_of("label_map")


@dataclass
class Union:
    """In at least one of these shapes or selections."""

    parts: Sequence[Any]
    kind: str = kind_of("union")


@dataclass
class Intersection:
    """In all of these shapes or selections."""

    parts: Sequence[Any]
    kind: str = kind_of("intersection")


@dataclass
class Difference:
    """The first shape without the second."""

    first: Any
    second: Any
    kind: str = kind_of("difference")


@dataclass
class Distance:
    """The body in which ``function(x, y, z)`` is negative; see :meth:`mtled.Case.with_distance`."""

    function: Function
    lower_m: Triple
    upper_m: Triple
    sample_m: float | None = None


# Selections; a text "all" is one too.


@dataclass
class Plane:
    """Within a tolerance of a plane."""

    point_m: Triple
    normal: Triple
    tolerance_m: float | None = None
    kind: str = kind_of("plane")


@dataclass
class InShape:
    """In any shape."""

    shape: Any
    kind: str = kind_of("shape")


@dataclass
class Label:
    """In a voxel of this label; of the body's own label map without a file."""

    value: int
    file: Path | None = None
    unit: Unit | None = None
    layer: int | None = None
    kind: str = kind_of("label")


@dataclass
class Facing:
    """Where the outward normal of the body and a direction enclose at most an angle."""

    direction: Triple
    angle_rad: float
    kind: str = kind_of("facing")


@dataclass
class Not:
    """Not in this selection."""

    part: Any
    kind: str = kind_of("not")
