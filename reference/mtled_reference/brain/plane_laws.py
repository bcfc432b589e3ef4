"""Stresses and tangents of the laws of the brain slice, in plane strain.

Arrays are (e, q, …) over elements and quadrature points, with F and its cofactor 2 × 2
and F₃₃ = 1.
"""

import numpy as np

from ..shared.materials import Material

SIGN = np.array([[1.0, -1.0], [-1.0, 1.0]])
"""Signs of the cofactor: cof F_iJ = SIGN_iJ F_kL with k ≠ i, L ≠ J."""

IDENTITY = np.einsum("ik,JL->iJkL", np.eye(2), np.eye(2))
"""∂F/∂F."""


def mooney_rivlin(material: Material, F, cof, J, first, theta):
    """∂ψ/∂F, ∂ψ/∂θ and ∂²ψ/∂θ² of ψ = A(I(θ/J)^(2/3) − 3) + C(θ⁻⁴ − 1) + D(θ² − 1)²,
    the Mooney–Rivlin law with B = 0 [Pa]."""
    a, b, c, d = material.rubber
    if material.law != "mooney_rivlin" or b != 0.0:
        raise ValueError(f"{material.name}: only the Mooney–Rivlin law with B = 0 is supported")
    scale = a * (theta / J) ** (2.0 / 3.0)
    stress = 2.0 * scale[..., None, None] * (F - (first / (3.0 * J))[..., None, None] * cof)
    by_theta = 2.0 / 3.0 * scale * first / theta - 4.0 * c * theta**-5
    by_theta += 4.0 * d * theta * (theta**2 - 1.0)
    curvature = -2.0 / 9.0 * scale * first / theta**2 + 20.0 * c * theta**-6
    return stress, by_theta, curvature + 4.0 * d * (3.0 * theta**2 - 1.0)


def mooney_rivlin_tangent(material: Material, F, cof, J, first, theta):
    """∂²ψ/∂F∂F (e, q, i, J, k, L) [Pa] of the same ψ at constant θ."""
    scale = (material.rubber[0] * (theta / J) ** (2.0 / 3.0))[..., None, None, None, None]
    inverse = cof / J[..., None, None]
    first = first[..., None, None, None, None]
    mixed = _outer(F, inverse)
    tangent = -4.0 / 3.0 * (mixed + mixed.transpose(0, 1, 4, 5, 2, 3))
    tangent += 4.0 / 9.0 * first * _outer(inverse, inverse) + 2.0 * IDENTITY
    tangent += 2.0 / 3.0 * first * _transposed(inverse)
    return scale * tangent


def neo_hookean_stress(material: Material, F, cof, J):
    """P = μF + (λ ln J − μ) F⁻ᵀ [Pa] of ψ = μ(I − 3)/2 − μ ln J + λ(ln J)²/2."""
    if material.law != "neo_hookean_log_j":
        raise ValueError(
            f"{material.name}: of compressible laws only neo_hookean_log_j is supported"
        )
    mu, lame = material.shear_modulus, material.lame_modulus
    return mu * F + ((lame * np.log(J) - mu) / J)[..., None, None] * cof


def neo_hookean_tangent(material: Material, F, cof, J):
    """∂P/∂F (e, q, i, J, k, L) [Pa] of the same ψ."""
    mu, lame = material.shear_modulus, material.lame_modulus
    inverse = cof / J[..., None, None]
    factor = (mu - lame * np.log(J))[..., None, None, None, None]
    return mu * IDENTITY + lame * _outer(inverse, inverse) + factor * _transposed(inverse)


def _outer(a, b) -> np.ndarray:
    """a_iJ b_kL."""
    return a[..., :, :, None, None] * b[..., None, None, :, :]


def _transposed(inverse) -> np.ndarray:
    """g_iL g_kJ = −∂g_iJ/∂F_kL of g = F⁻ᵀ."""
    return inverse[..., :, None, None, :] * inverse.swapaxes(-1, -2)[..., None, :, :, None]
