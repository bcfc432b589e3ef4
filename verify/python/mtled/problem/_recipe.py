"""The discretisation and time.

Written by verify/guide/problem_tables.py from `mtled case schema`; do not edit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, field
from typing import Literal

from ._shapes import Selector
from ._tables import Path

__all__ = ["Dynamic", "Grid", "Recipe", "RefineCell", "RefineSpacing", "Static"]


@dataclass
class Recipe:
    """How the body is turned into nodes, supports and quadrature points."""

    _: KW_ONLY
    cloud: Cloud = "regular"
    """Where the nodes come from."""
    basis: Basis | None = None
    """Polynomial basis of the moving least squares; "linear" if left out."""
    dilation: float | None = None
    """Influence radius over nodal spacing [–], larger than 1; 1.8 if left out, 2.6 with the quadratic basis, 2 with the
    modified one."""
    enforcement: Enforcement | None = None
    """How prescribed displacements are enforced; "collocation" if left out."""
    file: Path | None = None
    """Node positions [m] (CSV, NPY, VTU, VTK), path relative to the case file; for "file", where it may not be left
    out."""
    gradient_storage: GradientStorage | None = None
    """How many digits of the gradients the forces read; "auto" if left out."""
    gradient_tolerance: float | None = None
    """Of consistent gradients, over the defect of plain ones [–]; 1e-3 if left out."""
    gradients: Gradients | None = None
    """Which gradients of the shape functions are used; "second_order" if left out."""
    grid: Grid | None = None
    """The background grid that quadrature points come from; with the defaults of its keys if left out."""
    growth: float | None = None
    """Largest growth of the spacing per length [–]; for "graded", 0.25 if left out."""
    jitter: float | None = None
    """Largest random move over the spacing [–], in [0, 0.5); for "jittered", where it may not be left out."""
    mass: Mass | None = None
    """How the mass of a quadrature point is given to nodes; "moments_of_free_bodies" if left out, "even_split" with the
    quadratic bases, whose row sums are negative at some corners."""
    material_borders: MaterialBorders | None = None
    """Borders between materials of different stiffness; "sharp" if left out."""
    refine: Sequence[RefineSpacing] | None = None
    """Smaller spacings inside parts of the body; for "graded", none if left out."""
    regularisation: float | None = None
    """Weight of the second-order coefficients over that of the nodes [–], in (0, 1]; for "modified_quadratic", 1e-7 if
    left out."""
    seed: int | None = None
    """Of the random numbers; for "jittered", 1 if left out, and for "graded", 0 if left out, which moves nothing."""
    spacing_m: float | None = None
    """Distance of neighbouring nodes [m]; left out only for cloud "file"."""
    volumetric_projection: VolumetricProjection | None = None
    """Projection of the change of volume in the bulk energy; "patches" if left out."""
    weight_function: WeightFunction | None = None
    """Weight function of the moving least squares; "quartic_spline" if left out."""


Basis = Literal["linear", "quadratic", "modified_quadratic"]
"""Polynomial basis of the moving least squares. "modified_quadratic": Quadratic with small second-order coefficients
(modified moving least squares): for supports too poor for the plain quadratic basis."""


Cloud = Literal["regular", "jittered", "graded", "file"]
"""Where the nodes come from. "regular": A lattice inside the body plus boundary nodes. "jittered": A lattice moved at
random. "graded": A spacing that varies. "file": Positions from a file."""


Enforcement = Literal["direct", "collocation"]
"""How prescribed displacements are enforced. "direct": On the nodal parameters. "collocation": On the displacement
field at the nodes."""


GradientStorage = Literal["auto", "double", "single"]
"""How many digits of the gradients the forces read. "auto": Double precision below a million support entries, single
precision from there on, where the forces wait for memory. "double": Every one. "single": Single precision: half the
bytes to read. Patch tests stop at 1e-7 and displacements change by less than 1e-6 of the largest."""


Gradients = Literal["plain", "consistent", "second_order"]
"""Which gradients of the shape functions are used. "plain": The derivatives of the shape functions. "consistent":
Changed as little as possible until the divergence theorem holds. "second_order": The same, nearly for linear stresses
too, with quadrature points moved until they integrate functions of second order."""


@dataclass
class Grid:
    """The background grid that quadrature points come from."""

    _: KW_ONLY
    boundary_cell_m: float | None = None
    """Cells on the boundary are halved down to this edge [m]; they are as the others if left out."""
    cell_m: float | None = None
    """Edge of the largest cells [m]; instead of cells_per_spacing, which counts if it is left out. With it, or with
    refine, the grid is made by hand and does not follow the nodes of a graded cloud or of a file."""
    cells_per_spacing: float | None = None
    """Cells along one nodal spacing [–], along the local one where it varies; instead of cell. 1.26 if both are left
    out, two points per node in three dimensions."""
    gauss_points: int | None = None
    """Gauss points per cell and direction, 1 to 5; 1 if left out."""
    inside: Inside | None = None
    """What becomes of a cell that the boundary cuts; "volume_fraction" if left out."""
    refine: Sequence[RefineCell] | None = None
    """Smaller cells in parts of the body; none if left out."""


Inside = Literal["centre", "volume_fraction"]
"""What becomes of a cell that the boundary cuts. "centre": Kept whole if its centre is inside. "volume_fraction": A
point at the centroid of the inside part with its volume."""


@dataclass
class RefineCell:
    """The largest edge of cells in a part of the body."""

    where: Selector
    """A part of the body or of its boundary: "all" or a table with one key. Tolerances are lengths [m]; left out, they
    are a thousandth of the nodal spacing."""
    cell_m: float
    """Edge of the largest cells there [m]."""


Mass = Literal["even_split", "row_sum", "moments", "moments_of_free_bodies"]
"""How the mass of a quadrature point is given to nodes. "even_split": Evenly over its support. "row_sum": In proportion
to the shape functions. "moments": As row_sum, but changed, where masses move, until each connected body has its moments
of inertia, and so turns as it should. "moments_of_free_bodies": The same for bodies that nothing holds, row sums for
others, whose critical step is longer."""


MaterialBorders = Literal["sharp", "straddled"]
"""Borders between materials of different stiffness, where displacements have a kink. "sharp": Nodes are put on them
(not into a cloud from a file), on both faces of a layer however thin, and the stiffer side does not see the nodes of
the softer one, nor its own across it. "straddled": Supports reach across them, which smooths the kink: layers want 2.5
spacings."""


@dataclass
class RefineSpacing:
    """The spacing in a part of the body."""

    where: Selector
    """A part of the body or of its boundary: "all" or a table with one key. Tolerances are lengths [m]; left out, they
    are a thousandth of the nodal spacing."""
    spacing_m: float
    """Distance of neighbouring nodes there [m]."""


VolumetricProjection = Literal["none", "patches"]
"""Projection of the change of volume in the bulk energy. "none": None, which locks where ν is close to 0.5. "patches":
On patches of points where ν is larger than 0.3."""


WeightFunction = Literal["cubic_spline", "quartic_spline", "exponential"]
"""Weight function of the moving least squares."""


@dataclass
class Dynamic:
    """The motion of the body in time."""

    method: str = field(default="dynamic", init=False, repr=False)
    end_s: float
    """Simulated time of a dynamic run [s]; left out for method "static" only."""
    _: KW_ONLY
    damping_per_s: float | None = None
    """Mass-proportional damping [1/s]; 0 if left out."""
    fixed_step_s: float | None = None
    """A step to be used instead [s]; refused if it is not stable. If left out, the step follows the critical one."""
    mass_scaling: float | None = None
    """Factor by which heavier nodes lengthen the critical step of a slow dynamic run [–]; 1 if left out; refused if it
    takes more than 10 % of the body's mass."""
    reevaluate_every: int | None = None
    """The critical step is found again after this many steps at the latest; 1000 if left out."""
    safety_factor: float | None = None
    """Step over the critical step [–], in (0, 1]; 0.94 if left out, 0.8 for motion without damping."""


@dataclass
class Static:
    """The state at rest that the loads and conditions lead to."""

    method: str = field(default="static", init=False, repr=False)
    _: KW_ONLY
    fixed_step_s: float | None = None
    """A step to be used instead [s]; refused if it is not stable. If left out, the step follows the critical one."""
    load_end_s: float | None = None
    """Amplitudes run up to this time [s] in a static run; 1 if left out."""
    load_steps: int | None = None
    """Steps over which relaxation applies the load; 500 if left out."""
    max_steps: int | None = None
    """A relaxation that needs more steps has failed; 200000 if left out."""
    parts: int | None = None
    """Equal parts of the time between two corners of amplitudes in which a static run follows materials with viscosity
    [–]; 20 if left out."""
    reevaluate_every: int | None = None
    """The critical step is found again after this many steps at the latest; 1000 if left out."""
    safety_factor: float | None = None
    """Step over the critical step [–], in (0, 1]; 0.94 if left out, 0.8 for motion without damping."""
    solver: Solver | None = None
    """How a static solution is found; "auto" if left out."""
    tolerance: float | None = None
    """Requested relative error of the largest displacement [–], 1e-4 if left out, which Newton's method takes for a
    hundredth of it in nodal forces; of solver "newton" the largest unbalanced nodal force over the largest nodal force,
    1e-10 if left out."""


Time = Dynamic | Static


Solver = Literal["auto", "relaxation", "newton"]
"""The way to a static solution. "auto": Newton's method, and relaxation where that fails, or where the body sticks to
an obstacle, since the way to the solution matters then. "relaxation": Damped explicit motion until it rests. "newton":
Newton's method with conjugate gradients."""
