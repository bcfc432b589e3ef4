"""Energy, residual and tangent of hyperelastic elements, in batches.

Displacement form: W(u) = ∫ ψ(F) dV.
Three-field form: W(u) = ∫ ψ((θ/J)^(1/3) F) dV, where θ is the L² projection of
J = det F on the discontinuous linear functions of each element. This is the
functional of u, p, θ with p and θ eliminated: it is stationary in p where
∫ q (J − θ) dV = 0, and in θ where p is the projection of ∂ψ/∂θ
(Simo, Taylor and Pister, Comput. Methods Appl. Mech. Eng. 51, 177, 1985).
"""

from dataclasses import dataclass

import numpy as np

from ..shared.materials import Material, strain_energy, three_field_energy
from .jet import log, variables

LEVI_CIVITA = np.zeros((3, 3, 3))
for _i, _j, _k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    LEVI_CIVITA[_i, _j, _k], LEVI_CIVITA[_i, _k, _j] = 1.0, -1.0

SECOND_OF_DETERMINANT = np.einsum("ikm,jln->ijklmn", LEVI_CIVITA, LEVI_CIVITA)
"""∂²J/∂F_ij ∂F_kl = ε_ikm ε_jln F_mn."""


@dataclass(frozen=True)
class Elements:
    """A batch of e elements of one material with a nodes and q points in d
    dimensions: nodes (e, a), shape gradients (e, q, a, d) [1/m], volumes of the
    points (e, q) [m³], and the functions of p and θ (e, q, m), or None."""

    material: Material
    nodes: np.ndarray
    gradients: np.ndarray
    volumes: np.ndarray
    pressure_functions: np.ndarray | None

    def part(self, start: int, end: int) -> "Elements":
        """Some of the elements."""
        functions = self.pressure_functions
        return Elements(
            self.material,
            self.nodes[start:end],
            self.gradients[start:end],
            self.volumes[start:end],
            None if functions is None else functions[start:end],
        )


@dataclass(frozen=True)
class State:
    """Energies (e,) [J], residuals (e, a, d) [N] and tangents (e, ad, ad) [N/m] or None
    of the elements at some displacements."""

    energy: np.ndarray
    residual: np.ndarray
    tangent: np.ndarray | None


def evaluate(elements: Elements, displacements: np.ndarray, with_tangent: bool) -> State:
    """The state of the elements at nodal displacements (n, d) [m]."""
    kinematics = _Kinematics(elements, displacements[elements.nodes])
    volumes, G = elements.volumes, elements.gradients
    d = G.shape[-1]
    N = elements.pressure_functions
    if N is None:
        psi, slopes, curvatures = _energy(elements.material, kinematics, None)
        pressure = 0.0
    else:
        projection = _projection(N, volumes)
        theta = _project(projection, N, volumes, kinematics.J)
        psi, slopes, curvatures = _energy(elements.material, kinematics, theta)
        pressure = _project(projection, N, volumes, slopes[3])
    volumetric = slopes[2] + pressure
    stress = kinematics.combination([slopes[0], slopes[1], volumetric])
    weighted = volumes[..., None, None] * stress[..., :d, :d]
    residual = np.einsum("eqki,eqai->eak", weighted, G, optimize=True)
    energy = (volumes * psi).sum(axis=1)
    if not with_tangent:
        return State(energy, residual, None)
    moduli = kinematics.moduli([slopes[0], slopes[1], volumetric], curvatures, d)
    tangent = _contract(G, moduli * volumes[..., None, None, None, None])
    if N is not None:
        tangent += _volumetric_tangent(elements, kinematics, projection, curvatures)
    return State(energy, residual, tangent)


class _Kinematics:
    """F, its invariants and their derivatives at the quadrature points."""

    def __init__(self, elements: Elements, u: np.ndarray):
        e, q, _, d = elements.gradients.shape
        self.F = np.zeros((e, q, 3, 3))
        self.F[..., range(3), range(3)] = 1.0
        self.F[..., :d, :d] += np.einsum("eak,eqai->eqki", u, elements.gradients, optimize=True)
        F = self.F
        self.cofactor = 0.5 * np.einsum(
            "ijklmn,eqkl,eqmn->eqij", SECOND_OF_DETERMINANT, F, F, optimize=True
        )
        self.J = (F[..., 0, :] * self.cofactor[..., 0, :]).sum(axis=-1)
        if not np.all(self.J > 0.0):
            raise FloatingPointError("an element is inverted")
        self.C = np.matmul(F.swapaxes(-1, -2), F)
        self.first = (F * F).sum(axis=(-1, -2))
        self.second = 0.5 * (self.first**2 - (self.C * self.C).sum(axis=(-1, -2)))
        self.FC = np.matmul(F, self.C)

    def derivatives(self) -> np.ndarray:
        """∂(I, II, J)/∂F as (3, e, q, 3, 3)."""
        of_second = 2.0 * (self.first[..., None, None] * self.F - self.FC)
        return np.stack([2.0 * self.F, of_second, self.cofactor])

    def combination(self, slopes) -> np.ndarray:
        """Σ slope_α ∂α/∂F over α = I, II, J: (e, q, 3, 3)."""
        return sum(s[..., None, None] * D for s, D in zip(slopes, self.derivatives()))

    def moduli(self, slopes, curvatures, d: int) -> np.ndarray:
        """∂P/∂F, (e, q, d, d, d, d) with indices k i l j of P_ki and F_lj."""
        e, q = self.J.shape
        D = self.derivatives()[..., :d, :d].reshape(3, e, q, d * d)
        weighted = np.einsum("abeq,beqx->eqax", curvatures[:3, :3], D, optimize=True)
        A = np.matmul(np.moveaxis(D, 0, -1), weighted).reshape(e, q, d, d, d, d)
        identity = np.eye(d)
        same = np.einsum("kl,ij->kilj", identity, identity)
        A += 2.0 * slopes[0][..., None, None, None, None] * same
        of_J = SECOND_OF_DETERMINANT[:d, :d, :d, :d].reshape(d**4, 9)
        scaled = slopes[2][..., None, None] * self.F
        A += np.matmul(scaled.reshape(e * q, 9), of_J.T).reshape(A.shape)
        if np.any(slopes[1]):
            A += slopes[1][..., None, None, None, None] * self._second_of_second(d, same)
        return A

    def _second_of_second(self, d: int, same: np.ndarray) -> np.ndarray:
        """∂²II/∂F∂F = 2 (2 F_ki F_lj + I δ_kl δ_ij − δ_kl C_ji − F_kj F_li − b_kl δ_ij),
        b = F Fᵀ."""
        F, C, identity = self.F[..., :d, :d], self.C[..., :d, :d], np.eye(d)
        b = np.matmul(self.F, self.F.swapaxes(-1, -2))[..., :d, :d]
        result = 2.0 * np.einsum("eqki,eqlj->eqkilj", F, F)
        result += self.first[..., None, None, None, None] * same
        result -= np.einsum("kl,eqji->eqkilj", identity, C)
        result -= np.einsum("eqkj,eqli->eqkilj", F, F)
        result -= np.einsum("eqkl,ij->eqkilj", b, identity)
        return 2.0 * result


def _energy(material: Material, kinematics: _Kinematics, theta) -> tuple:
    """ψ with its gradient and Hessian in I, II, J (and θ)."""
    arguments = [kinematics.first, kinematics.second, kinematics.J]
    shape = kinematics.J.shape
    if theta is None:
        jet = strain_energy(material, *variables(*map(np.ravel, arguments)), log)
    else:
        if not np.all(theta > 0.0):
            raise FloatingPointError("the volume ratio θ of an element is not positive")
        jets = variables(*map(np.ravel, arguments + [theta]))
        jet = three_field_energy(material, *jets, log)
    count = len(jet.gradient)
    return (
        jet.value.reshape(shape),
        jet.gradient.reshape(count, *shape),
        jet.hessian.reshape(count, count, *shape),
    )


def _projection(N: np.ndarray, volumes: np.ndarray) -> np.ndarray:
    """Inverse of ∫ N_i N_j dV: (e, m, m)."""
    return np.linalg.inv(np.matmul(N.swapaxes(1, 2), volumes[..., None] * N))


def _project(inverse, N, volumes, values) -> np.ndarray:
    """The L² projection of values (e, q) on the functions N, at the points."""
    integrals = np.einsum("eqm,eq->em", N, volumes * values)
    return np.einsum("eqm,emn,en->eq", N, inverse, integrals, optimize=True)


def _contract(G: np.ndarray, moduli: np.ndarray) -> np.ndarray:
    """Σ_q G_ai A_kilj G_bj as (e, ak, bl)."""
    e, q, a, d = G.shape
    inner = np.ascontiguousarray(moduli.transpose(0, 1, 3, 2, 4, 5)).reshape(e, q, d**3, d)
    inner = np.matmul(inner, G.swapaxes(-1, -2)).reshape(e, q * d, d * d * a)
    left = np.ascontiguousarray(G.transpose(0, 2, 1, 3)).reshape(e, a, q * d)
    result = np.matmul(left, inner).reshape(e, a, d, d, a)
    return result.transpose(0, 1, 2, 4, 3).reshape(e, a * d, a * d)


def _volumetric_tangent(elements, kinematics, inverse, curvatures) -> np.ndarray:
    """Terms of the tangent from θ(u): ψ_Fθ : δF δθ and its transpose, and ψ_θθ δθ δθ."""
    G, N, volumes = elements.gradients, elements.pressure_functions, elements.volumes
    e, q, a, d = G.shape

    def moment(tensor: np.ndarray) -> np.ndarray:
        """∫ N_m tensor : ∇v as (e, m, ad)."""
        along = np.matmul(G, tensor[..., :d, :d].swapaxes(-1, -2)).reshape(e, q, a * d)
        return np.matmul((volumes[..., None] * N).swapaxes(1, 2), along)

    change = np.matmul(inverse, moment(kinematics.cofactor))
    mixed = moment(kinematics.combination([curvatures[0, 3], curvatures[1, 3], curvatures[2, 3]]))
    square = np.matmul(N.swapaxes(1, 2), (volumes * curvatures[3, 3])[..., None] * N)
    cross = np.matmul(mixed.swapaxes(1, 2), change)
    return (
        cross + cross.swapaxes(1, 2) + np.matmul(change.swapaxes(1, 2), np.matmul(square, change))
    )
