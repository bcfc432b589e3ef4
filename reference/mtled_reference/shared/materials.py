"""Strain energies per reference volume ψ [Pa], each written once.

The formulas use arithmetic and a logarithm passed by the caller, so that they work
on NumPy arrays, jets (scikit_fem/jet.py) and UFL expressions.
"""

from dataclasses import dataclass

NEARLY_INCOMPRESSIBLE = 0.45
"""Poisson's ratio [–] from which on u, p, θ are independent fields."""

OF_TWO_MODULI = (
    "neo_hookean_log_j",
    "neo_hookean_isochoric",
    "st_venant_kirchhoff",
    "linear_elastic",
)
"""Laws with a pair of elastic constants."""

THREE_FIELDS = "three fields u, p, θ: ψ((θ/J)^(1/3) F) + p(J − θ)"
"""The three-field formulation as reference files name it."""


@dataclass(frozen=True)
class Material:
    """A law with its constants: μ, λ, K [Pa], ν [–], density ρ [kg/m³];
    A, B, C, D [Pa] of the Mooney–Rivlin law; the volumetric energy's name."""

    name: str
    law: str
    density: float
    shear_modulus: float
    bulk_modulus: float
    volumetric: str = "quadratic"
    rubber: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    @property
    def lame_modulus(self) -> float:
        """λ = K − 2μ/3 [Pa]."""
        return self.bulk_modulus - 2.0 / 3.0 * self.shear_modulus

    @property
    def young_modulus(self) -> float:
        """E = 9Kμ/(3K + μ) [Pa]."""
        mu, bulk = self.shear_modulus, self.bulk_modulus
        return 9.0 * bulk * mu / (3.0 * bulk + mu)

    @property
    def poisson_ratio(self) -> float:
        """ν = (3K − 2μ)/2(3K + μ) [–]."""
        mu, bulk = self.shear_modulus, self.bulk_modulus
        return (3.0 * bulk - 2.0 * mu) / (2.0 * (3.0 * bulk + mu))

    @property
    def is_quadratic_isochoric(self) -> bool:
        """Whether ψ = μ/2 (J^(−2/3) I₁ − 3) + K/2 (J − 1)², which most programs have."""
        return self.law == "neo_hookean_isochoric" and self.volumetric == "quadratic"

    @property
    def is_nearly_incompressible(self) -> bool:
        """Whether ν ≥ 0.45, so that elements in displacements alone would lock."""
        return self.poisson_ratio >= NEARLY_INCOMPRESSIBLE - 1e-9


def material_from_table(name: str, table: dict) -> Material:
    """The material of a `[material.NAME]` table."""
    law, density = table["law"], float(table["density"])
    if law == "mooney_rivlin":
        return _rubber(name, density, table["A"], table["B"], table["poisson_ratio"])
    if law not in OF_TWO_MODULI:
        raise ValueError(f"material {name}: {law} is not solved by the references")
    shear, bulk = _elastic_constants(table)
    return Material(name, law, density, shear, bulk, table.get("volumetric", "quadratic"))


def _elastic_constants(table: dict) -> tuple[float, float]:
    """μ = E/2(1+ν), K = E/3(1−2ν), or K = λ + 2μ/3, or μ and K themselves [Pa]."""
    if "young_modulus" in table:
        young, nu = table["young_modulus"], table["poisson_ratio"]
        return young / (2.0 * (1.0 + nu)), young / (3.0 * (1.0 - 2.0 * nu))
    shear = table["shear_modulus"]
    if "bulk_modulus" in table:
        return shear, table["bulk_modulus"]
    return shear, table["lame_modulus"] + 2.0 / 3.0 * shear


def _rubber(name: str, density: float, a: float, b: float, nu: float) -> Material:
    """C = A/2 + B, D = [A(5ν − 2) + B(11ν − 5)]/2(1 − 2ν), μ = 2(A + B),
    K = 2μ(1 + ν)/3(1 − 2ν) [Pa]."""
    c = 0.5 * a + b
    d = (a * (5.0 * nu - 2.0) + b * (11.0 * nu - 5.0)) / (2.0 * (1.0 - 2.0 * nu))
    shear = 2.0 * (a + b)
    bulk = 2.0 * shear * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))
    return Material(name, "mooney_rivlin", density, shear, bulk, rubber=(a, b, c, d))


def strain_energy(material: Material, first, second, J, log):
    """ψ [Pa] from I = tr C, II = (I² − C:C)/2 and J = det F, C = FᵀF.

    In plane strain the invariants are those of the 3 × 3 tensor (F₃₃ = 1).
    """
    mu, lame, bulk = material.shear_modulus, material.lame_modulus, material.bulk_modulus
    if material.law == "mooney_rivlin":
        a, b, c, d = material.rubber
        return a * (first - 3.0) + b * (second - 3.0) + c * (J**-4 - 1.0) + d * (J**2 - 1.0) ** 2
    if material.law == "neo_hookean_log_j":
        return 0.5 * mu * (first - 3.0) - mu * log(J) + 0.5 * lame * log(J) ** 2
    if material.law == "neo_hookean_isochoric":
        if material.volumetric == "simo_taylor":
            volumetric = 0.25 * bulk * (J**2 - 1.0 - 2.0 * log(J))
        else:
            volumetric = 0.5 * bulk * (J - 1.0) ** 2
        return 0.5 * mu * (first * J ** (-2.0 / 3.0) - 3.0) + volumetric
    if material.law == "st_venant_kirchhoff":
        trace = 0.5 * (first - 3.0)
        square = 0.25 * (first**2 - 2.0 * second - 2.0 * first + 3.0)
        return 0.5 * lame * trace**2 + mu * square
    raise ValueError(f"law {material.law} is not a function of the invariants of C")


def three_field_energy(material: Material, first, second, J, theta, log):
    """ψ((θ/J)^(1/3) F) [Pa]: the energy with the volume ratio θ instead of J.

    The three-field functional is this plus p(J − θ) (Simo, Taylor and Pister,
    Comput. Methods Appl. Mech. Eng. 51, 177, 1985).
    """
    ratio = theta / J
    scaled_first = first * ratio ** (2.0 / 3.0)
    scaled_second = second * ratio ** (4.0 / 3.0)
    return strain_energy(material, scaled_first, scaled_second, theta, log)
