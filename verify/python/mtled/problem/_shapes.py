"""Shapes, selections and regions.

Written by verify/guide/problem_tables.py from `mtled case schema`; do not edit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import ClassVar, Literal

from ._tables import Path, Unnamed

__all__ = [
    "Box",
    "Cylinder",
    "Difference",
    "Ellipsoid",
    "Facing",
    "HalfSpace",
    "InShape",
    "Intersection",
    "Label",
    "LabelMap",
    "Not",
    "Plane",
    "Polygon",
    "Region",
    "Sphere",
    "Stl",
    "Union",
]


@dataclass
class Box:
    """Axis-parallel, between two corners [m]. As a selection: in an axis-parallel box."""

    kind: ClassVar[str] = "box"
    min_m: Sequence[float]
    """Corner with the smallest coordinates [m]."""
    max_m: Sequence[float]
    """Opposite corner [m]."""
    _: KW_ONLY
    tolerance_m: float | None = None
    """Distance that still counts [m]; a thousandth of the nodal spacing if left out."""


@dataclass
class Cylinder:
    """From `base` [m] along `axis` (of any length) over `height` [m]."""

    kind: ClassVar[str] = "cylinder"
    base_m: Sequence[float]
    """Centre of the circle at its foot [m]."""
    axis: Sequence[float]
    """Direction from there, of any length [–]."""
    radius_m: float
    """Radius [m]."""
    height_m: float
    """Length along the axis [m]."""


@dataclass
class Sphere:
    """Centre and radius [m]. As a selection: in a sphere."""

    kind: ClassVar[str] = "sphere"
    centre_m: Sequence[float]
    """Centre [m]."""
    radius_m: float
    """Radius [m]."""
    _: KW_ONLY
    tolerance_m: float | None = None
    """Distance that still counts [m]; a thousandth of the nodal spacing if left out."""


@dataclass
class Ellipsoid:
    """Axis-parallel with three semi-axes [m]."""

    kind: ClassVar[str] = "ellipsoid"
    centre_m: Sequence[float]
    """Centre [m]."""
    radii_m: Sequence[float]
    """Semi-axes along x, y and z [m]."""


@dataclass
class Polygon:
    """A simple polygon in x and y [m], extruded from z[0] to z[1] [m]."""

    kind: ClassVar[str] = "polygon"
    points_m: Sequence[Sequence[float]]
    """Its corners in order, x and y of each [m]."""
    z_m: Sequence[float]
    """Lower and upper end [m]."""


@dataclass
class HalfSpace:
    """Everything behind the plane through `point` [m]; `normal` (of any length) points out. As a selection: behind a
    plane; `normal` points out."""

    kind: ClassVar[str] = "half_space"
    point_m: Sequence[float]
    """A point of the plane [m]."""
    normal: Sequence[float]
    """Outward direction, of any length [–]."""
    _: KW_ONLY
    tolerance_m: float | None = None
    """Distance that still counts [m]; a thousandth of the nodal spacing if left out."""


@dataclass
class Union(Unnamed):
    """In at least one of these."""

    kind: ClassVar[str] = "union"
    parts: Sequence[Shape | Selector]


@dataclass
class Intersection(Unnamed):
    """What all of these have in common. As a selection: in all of these."""

    kind: ClassVar[str] = "intersection"
    parts: Sequence[Shape | Selector]


@dataclass
class Difference(Unnamed):
    """The first without the second."""

    kind: ClassVar[str] = "difference"
    first: Shape
    second: Shape


@dataclass
class Stl:
    """A closed surface from a file: STL, OBJ, PLY, or PolyData of VTK (.vtp or legacy .vtk), as the extension of its
    name says. Path relative to the case file. Faces of more than three corners are cut into triangles; lines and points
    are left out. It may consist of several shells; those that cross are united, cavities are those whose triangles face
    inwards."""

    kind: ClassVar[str] = "stl"
    file: Path
    """The file (.stl, .obj, .ply, .vtp, .vtk), as text or binary, all its solids, objects or pieces. Vertices no
    further apart than 1e-9 of the size of the surface are one. Coordinates are along R, A and S; where the header, a
    comment or the name of a solid says `SPACE=LPS`, x and y change their signs."""
    unit: Unit
    """Unit of the coordinates in the file."""


@dataclass
class LabelMap:
    """The voxels of some labels of an NRRD or NIfTI file, in the file's world coordinates turned to RAS. Path relative
    to the case file."""

    kind: ClassVar[str] = "label_map"
    file: Path
    """The NRRD or NIfTI file."""
    labels: Sequence[int]
    """Values of the voxels that belong to the shape."""
    _: KW_ONLY
    layer: int | None = None
    """Which layer of a file of 3D Slicer (.seg.nrrd) whose segments overlap, counted from 0; left out, the file must
    have one."""
    smoothing: float | None = None
    """Standard deviation of the smoothing of the surface [voxel], at most 4: 0.7 if left out; 1.4 flattens the steps
    between voxels that contact would feel."""
    unit: Unit | None = None
    """Overrides the unit that the file states (mm if it states none); that of the file if left out."""


Shape = Box | Cylinder | Sphere | Ellipsoid | Polygon | HalfSpace | Union | Intersection | Difference | Stl | LabelMap
"""A solid."""


Unit = Literal["m", "mm"]
"""A unit of length."""


@dataclass
class Region:
    """A part of the body made of one material."""

    name: str
    """Its name in results and for probes."""
    where: Selector
    """A part of the body or of its boundary: "all" or a table with one key. Tolerances are lengths [m]; left out, they
    are a thousandth of the nodal spacing."""
    material: str
    """Name of a `[material.NAME]` table."""


@dataclass
class Plane:
    """Within `tolerance` of a plane."""

    kind: ClassVar[str] = "plane"
    point_m: Sequence[float]
    """A point of the plane [m]."""
    normal: Sequence[float]
    """Its normal, of any length [–]."""
    _: KW_ONLY
    tolerance_m: float | None = None
    """Distance that still counts [m]; a thousandth of the nodal spacing if left out."""


@dataclass
class InShape(Unnamed):
    """In any shape."""

    kind: ClassVar[str] = "shape"
    shape: Shape


@dataclass
class Label:
    """In a voxel of this label."""

    kind: ClassVar[str] = "label"
    value: int
    """The label."""
    _: KW_ONLY
    file: Path | None = None
    """A label map, path relative to the case file; the body's own if left out."""
    layer: int | None = None
    """Which layer of a `file` whose segments overlap, counted from 0; left out, that file must have one."""
    unit: Unit | None = None
    """Overrides the unit that the file states; that of the file if left out."""


@dataclass
class Facing:
    """Where the outward normal of the body is near a direction: a flat face of a surface, or one side of an organ. Away
    from the boundary, the normal at its nearest place."""

    kind: ClassVar[str] = "facing"
    direction: Sequence[float]
    """The direction, of any length [–]."""
    angle_rad: float
    """Largest angle between the normal and the direction [rad]: 0 < angle < π."""


@dataclass
class Not(Unnamed):
    """Not in this one."""

    kind: ClassVar[str] = "not"
    part: Selector


Selector = Plane | HalfSpace | Box | Sphere | InShape | Label | Facing | Union | Intersection | Not | Literal["all"]
"""A part of the body or of its boundary: "all" or a table with one key. Tolerances are lengths [m]; left out, they are
a thousandth of the nodal spacing. "all": Everything."""
