"""Materials, regions and the discretisation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .conditions import Data, Formula
from .kinds import Path


@dataclass
class OgdenTerm:
    """A term of the law ``ogden``."""

    mu_pa: float
    alpha: float


@dataclass
class Direction:
    """A direction at every place: one of the three. Its length does not count."""

    direction: Sequence[float] | None = None
    formula: Formula | None = None
    data: Data | None = None


@dataclass
class PronyTerm:
    """A part of the isochoric stress that relaxes."""

    g: float
    tau_s: float


@dataclass
class ActiveStress:
    """What muscle pulls with along its fibres."""

    tension_pa: float
    amplitude: Any = None


@dataclass
class Material:
    """A law with its parameters."""

    law: str
    density_kg_m3: float
    young_modulus_pa: float | None = None
    poisson_ratio: float | None = None
    lame_modulus_pa: float | None = None
    shear_modulus_pa: float | None = None
    bulk_modulus_pa: float | None = None
    A_pa: float | None = None
    B_pa: float | None = None
    terms: Sequence[OgdenTerm] | None = None
    constants: Mapping[str, float] | None = None
    fibres: Direction | None = None
    sheets: Direction | None = None
    prony: Sequence[PronyTerm] | None = None
    active_stress: ActiveStress | None = None
    volumetric: str | None = None


@dataclass
class Region:
    """A part of the body of one material, by its name; the first that contains a point owns it."""

    name: str
    where: Any
    material: str


@dataclass
class RefineSpacing:
    """A smaller spacing in a part of the body."""

    where: Any
    spacing_m: float


@dataclass
class RefineCell:
    """Smaller cells in a part of the body."""

    where: Any
    cell_m: float


@dataclass
class Grid:
    """The background grid that quadrature points come from."""

    cell_m: float | None = None
    cells_per_spacing: float | None = None
    boundary_cell_m: float | None = None
    refine: Sequence[RefineCell] | None = None
    gauss_points: int | None = None
    inside: str | None = None


@dataclass
class Recipe:
    """How the body is turned into nodes, supports and quadrature points."""

    spacing_m: float | None = None
    cloud: str = "regular"
    jitter: float | None = None
    seed: int | None = None
    file: Path | None = None
    refine: Sequence[RefineSpacing] | None = None
    growth: float | None = None
    dilation: float | None = None
    basis: str | None = None
    regularisation: float | None = None
    weight_function: str | None = None
    mass: str | None = None
    enforcement: str | None = None
    gradients: str | None = None
    gradient_tolerance: float | None = None
    gradient_storage: str | None = None
    volumetric_projection: str | None = None
    material_borders: str | None = None
    grid: Grid | None = None
