"""Materials.

Written by verify/guide/problem_tables.py from `mtled case schema`; do not edit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import ClassVar, Literal

from ._shapes import Unit
from ._tables import Path, Unnamed

__all__ = [
    "ActiveStress",
    "Data",
    "Direction",
    "Formula",
    "Linear",
    "Material",
    "OgdenTerm",
    "PronyTerm",
    "Smooth",
    "Table",
]


@dataclass
class Material:
    """A constitutive law with its parameters: exactly one pair of elastic constants; A, B and poisson_ratio for
    mooney_rivlin; terms and poisson_ratio or bulk_modulus for ogden; constants and poisson_ratio or bulk_modulus for
    yeoh and demiray; constants, bulk_modulus and directions for laws with fibres."""

    law: Law
    """Its strain energy."""
    density_kg_m3: float
    """Per reference volume [kg/m³]."""
    _: KW_ONLY
    A_pa: float | None = None
    """A of mooney_rivlin [Pa]; left out for other laws."""
    B_pa: float | None = None
    """B of mooney_rivlin [Pa]; left out for other laws."""
    active_stress: ActiveStress | None = None
    """What muscle pulls with along its fibres, whatever its strain; left out where nothing pulls."""
    bulk_modulus_pa: float | None = None
    """K [Pa], with shear_modulus or terms; left out where another pair is given."""
    constants: Mapping[str, float] | None = None
    """Constants of yeoh, demiray and laws with fibres by their names in the formula [Pa, rad or –], such as { mu =
    1000.0, b = 2.0 }; left out for other laws."""
    fibres: Direction | None = None
    """Directions of the fibres, of a law or of an active stress; left out for others."""
    lame_modulus_pa: float | None = None
    """First Lamé modulus λ [Pa], with shear_modulus; left out where another pair is given."""
    poisson_ratio: float | None = None
    """ν [–], -1 < ν < 0.5, with young_modulus, A and B, or terms; else left out."""
    prony: Sequence[PronyTerm] | None = None
    """One to six terms of viscosity, by which the isochoric stress relaxes after a sudden strain, whose constants the
    law has, to its part 1 − Σ g (1 − e^(−t/tau)); left out where nothing relaxes."""
    shear_modulus_pa: float | None = None
    """μ [Pa], with lame_modulus or bulk_modulus; left out where another pair is given."""
    sheets: Direction | None = None
    """Directions that lie in the sheets of the fibres; left out for laws without."""
    terms: Sequence[OgdenTerm] | None = None
    """One to three terms of ogden; left out for other laws."""
    volumetric: Volumetric | None = None
    """Volumetric energy of neo_hookean_isochoric, ogden and laws with constants; "quadratic" if left out."""
    young_modulus_pa: float | None = None
    """E [Pa], with poisson_ratio; left out where another pair is given."""


@dataclass
class ActiveStress:
    """The second Piola–Kirchhoff stress T f ⊗ f with the direction f of the fibres at rest."""

    tension_pa: float
    """T at amplitude 1 [Pa]."""
    _: KW_ONLY
    amplitude: Amplitude | None = None
    """Factor over time; constant if left out."""


@dataclass
class Linear:
    """From 0 to 1 in a straight line, then 1."""

    kind: ClassVar[str] = "linear"
    duration_s: float
    """Time from 0 to 1 [s]."""


@dataclass
class Smooth:
    """10s³ − 15s⁴ + 6s⁵ with s = t/duration, then 1."""

    kind: ClassVar[str] = "smooth"
    duration_s: float
    """Time from 0 to 1 [s]."""


@dataclass
class Table(Unnamed):
    """Straight lines through rows of time [s] and factor, constant outside."""

    kind: ClassVar[str] = "table"
    rows: Sequence[Sequence[float]]


Amplitude = Linear | Smooth | Table | Literal["constant"]
"""A factor over time; constant if left out. "constant": 1 from the start."""


@dataclass
class Direction:
    """A direction at every place: one of `direction`, `formula` and `data`. Its length does not count."""

    direction: Sequence[float] | None = None
    """The same everywhere [–]; left out where another kind is given."""
    _: KW_ONLY
    data: Data | None = None
    """Vectors from a file, all of them turned to the same side; left out where another kind is given."""
    formula: Formula | None = None
    """A function of the position; left out where another kind is given."""


@dataclass
class Data:
    """Displacements at amplitude 1 at scattered points, such as measured ones, or directions. Between them the linear
    function counts that fits the nearest 16 best."""

    file: Path
    """CSV with a header x, y, z, ux, uy, uz; NPY of shape (n, 6) in this order; VTU; or an image of vectors, NRRD with
    the components first or NIfTI with the components last, whose world is R, A, S."""
    reach_m: float
    """Largest distance of a node from the nearest point [m]."""
    _: KW_ONLY
    beyond: Beyond | None = None
    """What happens to selected nodes that are farther. Default: "error"."""
    factor: float | None = None
    """Multiplies the displacements [–]. Default: 1.0."""
    field: str | None = None
    """Name of the point data of a VTU file; "displacement" if left out."""
    frame: VectorFrame | None = None
    """What the vectors of an image are measured along; needed for NIfTI, which does not say it. If left out, what an
    NRRD file states: its measurement frame, or its space without one."""
    unit: Unit | None = None
    """Unit of positions and displacements in the file; m if left out, in images what they state."""


Beyond = Literal["error", "free"]
"""What happens to nodes that are too far from all data. "error": They are an error. "free": They are not prescribed."""


VectorFrame = Literal["ras", "lps", "fsl"]
"""What the components of vectors in an image are measured along. "ras": Right, anterior, superior. "lps": Left,
posterior, superior, as ITK, ANTs and 3D Slicer write displacements. "fsl": The voxels, as FSL's dtifit writes
directions: the first index runs to the left."""


@dataclass
class Formula:
    """A vector as formulas of the reference position x, y, z [m], such as "0.02*sin(PI*x/0.1)": + - * / ^, parentheses,
    sqrt, exp, ln, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, abs, PI."""

    x: str
    """Component along x [m, m/s, m/s², Pa or –]."""
    y: str
    """Component along y [m, m/s, m/s², Pa or –]."""
    z: str | None = None
    """Component along z [m, m/s, m/s², Pa or –]; left out in plane strain only."""
    _: KW_ONLY
    factor: float | None = None
    """Multiplies all of them [–]. Default: 1.0."""


Law = Literal[
    "mooney_rivlin",
    "neo_hookean_log_j",
    "neo_hookean_isochoric",
    "ogden",
    "yeoh",
    "demiray",
    "guccione",
    "holzapfel_gasser_ogden",
    "holzapfel_ogden",
    "st_venant_kirchhoff",
    "linear_elastic",
]
"""A constitutive law. "mooney_rivlin": ψ = A(I−3) + B(II−3) + C(III⁻²−1) + D(III−1)². "neo_hookean_log_j": ψ = μ/2
(I₁−3) − μ ln J + λ/2 (ln J)². "neo_hookean_isochoric": ψ = μ/2 (J^(−2/3) I₁ − 3) + U(J). "ogden": ψ = Σ 2μ/α² (λ̄₁^α +
λ̄₂^α + λ̄₃^α − 3) + U(J), λ̄ = J^(−1/3) λ. "yeoh": ψ = C1 x + C2 x² + C3 x³ + U(J), x = Ī₁ − 3 [Pa]; C2 and C3 are 0 if
left out. "demiray": ψ = mu/2b (exp(b (Ī₁ − 3)) − 1) + U(J). "guccione": ψ = C/2 (exp Q − 1) + U(J), Q = b_f E₁₁² + b_t
(E₂₂² + E₃₃² + 2 E₂₃²) + 2 b_fs (E₁₂² + E₁₃²), E = (C̄ − 1)/2 with axis 1 along the fibres. "holzapfel_gasser_ogden": ψ
= mu/2 (Ī₁ − 3) + k1/2k2 Σ (exp(k2 E²) − 1) + U(J), E = max(0, kappa (Ī₁ − 3) + (1 − 3 kappa)(m·C̄m − 1)) of two
families m of fibres at ± angle [rad] from `fibres` towards `sheets`; kappa and angle are 0 if left out.
"holzapfel_ogden": ψ = a/2b (exp(b (Ī₁ − 3)) − 1) + a_f/2b_f (exp(b_f max(0, C̄₁₁ − 1)²) − 1) + a_s/2b_s (exp(b_s max(0,
C̄₂₂ − 1)²) − 1) + a_fs/2b_fs (exp(b_fs C̄₁₂²) − 1) + U(J), axis 1 along the fibres, 2 in the sheets normal to them;
terms of sheets are left out with their constants. "st_venant_kirchhoff": ψ = λ/2 (tr E)² + μ E:E. "linear_elastic": ψ =
λ/2 (tr ε)² + μ ε:ε, small displacements only."""


@dataclass
class PronyTerm:
    """A term of viscosity."""

    g: float
    """The part of the isochoric stress that relaxes with it [–], positive; all sum to less than 1."""
    tau_s: float
    """Its relaxation time [s], positive."""


@dataclass
class OgdenTerm:
    """The term 2μ/α² (λ̄₁^α + λ̄₂^α + λ̄₃^α − 3) of ogden, as Miller and Chinzei (2002) write it."""

    mu_pa: float
    """Its part of the shear modulus at rest [Pa], positive."""
    alpha: float
    """Exponent α [–], not 0; -4.7 for brain tissue."""


Volumetric = Literal["quadratic", "simo_taylor"]
"""Volumetric energy U(J) of neo_hookean_isochoric, ogden and laws with constants. "quadratic": U = K/2 (J−1)².
"simo_taylor": U = K/4 (J² − 1 − 2 ln J)."""
