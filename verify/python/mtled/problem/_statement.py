"""Probes, output and the whole case.

Written by verify/guide/problem_tables.py from `mtled case schema`; do not edit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Literal

from ._conditions import BodyForce, Cavity, InitialVelocity, Obstacle, Prescribe, Pressure, Spring, Traction
from ._materials import Material
from ._recipe import Recipe, Time
from ._shapes import Region, Shape, Unit
from ._tables import Distance, Path

__all__ = ["Lattice", "Output", "PlaneStrain", "Points", "Probe"]


Dimension = Literal["3d", "plane_strain"]
"""Three dimensions, or a plane-strain slice."""


@dataclass
class Output:
    """What is written."""

    _: KW_ONLY
    frames: int | None = None
    """Number of VTU frames after the first, at equal parts of the progress, the end among them; 20 if left out. A
    static run that ends early has fewer, and solver "newton" at most one for each part of the load; their frames are
    numbered, since they have no time without viscosity."""
    history: int | None = None
    """Number of samples of histories; 200 if left out."""
    moment_about_m: Sequence[float] | None = None
    """Moments of reactions are taken about this point [m]; the origin if left out."""
    states_s: Sequence[float] | None = None
    """Times at which the state of a motion is written [s], as state_1.json and so on, from which `mtled solve --from`
    goes on with it; none if left out. As `times` for the rest."""
    times_s: Sequence[float] | None = None
    """Times of the frames [s]; equal parts of the progress, `frames` of them, if left out. A step ends at each, and a
    sample of histories is taken too; the first state and the last are frames as well. For method "dynamic": increasing,
    above 0 and at most `time.end`."""
    volumes: bool | None = None
    """Whether histories have the volume of each region too. Default: false."""


@dataclass
class PlaneStrain:
    """The slice of a plane-strain problem."""

    thickness_m: float
    """Thickness of the slab that volumes, masses and forces belong to [m]."""
    z_m: float
    """Where the cross-section is taken [m]."""


@dataclass
class Probe:
    """Where displacements are recorded: one of `point`, `points`, `lattice`, `centre_of_mass`."""

    name: str
    """Its name in results."""
    point_m: Sequence[float] | None = None
    """A reference position [m]; left out where another kind is given."""
    _: KW_ONLY
    centre_of_mass: str | None = None
    """Name of a region; left out where another kind is given."""
    lattice: Lattice | None = None
    """Positions on a lattice; left out where another kind is given."""
    points: Points | None = None
    """Positions from a file; left out where another kind is given."""


@dataclass
class Lattice:
    """Equally spaced reference positions, ends included; those outside the body are left out."""

    min_m: Sequence[float]
    """First corner [m]."""
    max_m: Sequence[float]
    """Opposite corner [m]."""
    counts: Sequence[int]
    """Positions along x, y and z [–]; 1 along z in plane strain."""


@dataclass
class Points:
    """Reference positions from a file, each a probe with the name of this one, a point and its own name, as in
    `landmarks.tip`."""

    file: Path
    """CSV with a header that names name, x, y and z, or x_mm, y_mm and z_mm. Path relative to the case file."""
    _: KW_ONLY
    unit: Unit | None = None
    """Unit of the positions; may be left out where the header states it."""


@dataclass
class Statement:
    """One problem of solid mechanics for the meshless solver mtled. Lengths in m, masses in kg, times in s, stresses in
    Pa, angles in rad."""

    title: str
    """One line that names the problem."""
    shape: Shape | Distance
    """Its shape at rest."""
    material: Mapping[str, Material]
    """Materials by name."""
    discretisation: Recipe
    """How the body is turned into nodes, supports and quadrature points."""
    time: Time
    """How the body moves. `end`, `damping` and `mass_scaling` belong to method "dynamic"; `solver`, `load_end`,
    `load_steps`, `tolerance`, `max_steps` and `parts` to "static". Solver "newton" takes `load_end`, `tolerance` and
    `parts` only."""
    _: KW_ONLY
    body_force: Sequence[BodyForce] | None = None
    """Forces per mass on the body or parts of it; none if left out."""
    cavity: Sequence[Cavity] | None = None
    """Cavities whose volume is recorded, and the fluids that fill them; none if left out."""
    description: str | None = None
    """What is solved and why, in a few sentences."""
    dimension: Dimension | None = None
    """Three dimensions, or a plane-strain slice. Default: "3d"."""
    initial_velocity: Sequence[InitialVelocity] | None = None
    """Velocities at t = 0; the first part that contains a node counts; zero if left out."""
    obstacle: Sequence[Obstacle] | None = None
    """Rigid obstacles that nodes may not enter; none if left out."""
    output: Output | None = None
    """What is written; with the defaults of its keys if left out."""
    plane: PlaneStrain | None = None
    """The slice of a plane-strain problem; left out in three dimensions."""
    prescribe: Sequence[Prescribe] | None = None
    """Prescribed displacements; none if left out."""
    pressure: Sequence[Pressure] | None = None
    """Pressures that follow the deformed surface; none if left out."""
    probe: Sequence[Probe] | None = None
    """Where displacements are recorded; nowhere if left out."""
    region: Sequence[Region] | None = None
    """Parts of the body, the first that contains a point owns it; may be left out where there is one material."""
    source: str | None = None
    """Where the problem and its reference values come from."""
    spring: Sequence[Spring] | None = None
    """Elastic beds of parts of the boundary; none if left out."""
    traction: Sequence[Traction] | None = None
    """Dead tractions on parts of the boundary; none if left out."""
