"""Forces and stiffness of the brain slice on quadrilaterals with nine nodes.

Nearly incompressible regions: three fields u, p, θ, with p and θ linear in each
element and not continuous; both are put in terms of u element by element,
θ = ΠJ and p = Π ∂ψ/∂θ with the L² projection Π. ψ is taken at (θ/J)^(1/3) F.
Other regions: displacements alone.
"""

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementQuad2

from .brain_quads import Quads
from .case import Case
from .materials import Material, strain_energy, three_field_energy

ORDER = 5
"""Of the quadrature: three points per direction."""


class Block:
    """The elements of one region. Indices: e element, q point, a node, i J of F."""

    def __init__(self, basis: Basis, material: Material, thickness: float):
        self.material = material
        self.mixed = material.is_nearly_incompressible
        self.dofs = basis.element_dofs.T
        self.weight = basis.dx * thickness
        shapes = [shape[0] for shape in basis.basis]
        values = [np.broadcast_to(np.asarray(s), self.weight.shape) for s in shapes]
        self.shape = np.stack(values, axis=-1)
        self.node_weight = np.sum(self.shape * self.weight[..., None], axis=1)
        self.point = np.asarray(basis.global_coordinates()).transpose(1, 2, 0)
        self.slope = np.stack([s.grad for s in shapes], axis=-1).transpose(1, 2, 3, 0).copy()
        weighted = self.slope * self.weight[:, :, None, None]
        e, q, a, _ = weighted.shape
        self.weighted = weighted.transpose(0, 2, 1, 3).reshape(e, a, 2 * q)
        if self.mixed:
            self.projection = self._projection()

    def _projection(self) -> np.ndarray:
        """Π (e, q, q) onto linear functions."""
        middle = self.point.mean(axis=1, keepdims=True)
        arm = (self.point - middle) / np.ptp(self.point, axis=1, keepdims=True)
        linear = np.concatenate([np.ones_like(arm[..., :1]), arm], axis=2)
        weighted = (linear * self.weight[:, :, None]).transpose(0, 2, 1)
        return linear @ np.linalg.solve(weighted @ linear, weighted)

    def _mean(self, values: np.ndarray) -> np.ndarray:
        """Π of values (e, q)."""
        return (self.projection @ values[..., None])[..., 0]

    def _kinematics(self, u: np.ndarray):
        """F (e, q, 2, 2), its cofactor, J and I = tr C with F₃₃ = 1."""
        local = u.reshape(-1, 2)[self.dofs].transpose(0, 2, 1)
        F = local[:, None] @ self.slope + np.eye(2)
        cof = F[..., ::-1, ::-1] * SIGN
        J = np.sum(F[..., 0, :] * cof[..., 0, :], axis=-1)
        if J.min() <= 0.0:
            raise FloatingPointError(f"{self.material.name}: an element is turned inside out")
        return F, cof, J, np.sum(F * F, axis=(2, 3)) + 1.0

    def energy(self, u: np.ndarray) -> float:
        """∫ ψ dV [J]."""
        F, _, J, first = self._kinematics(u)
        C = F.transpose(0, 1, 3, 2) @ F
        second = 0.5 * (first**2 - np.sum(C * C, axis=(2, 3)) - 1.0)
        if self.mixed:
            psi = three_field_energy(self.material, first, second, J, self._mean(J), np.log)
        else:
            psi = strain_energy(self.material, first, second, J, np.log)
        return float(np.sum(self.weight * psi))

    def force(self, u: np.ndarray) -> np.ndarray:
        """Nodal forces (e, a, i) [N]: ∫ (∂ψ/∂F + p cof F) · Grad φ_a dV."""
        F, cof, J, first = self._kinematics(u)
        if self.mixed:
            stress, by_theta, _ = rubber(self.material, F, cof, J, first, self._mean(J))
            stress = stress + self._mean(by_theta)[..., None, None] * cof
        else:
            stress = log_stress(self.material, F, cof, J)
        e, q = J.shape
        return self.weighted @ stress.transpose(0, 1, 3, 2).reshape(e, 2 * q, 2)

    def stiffness(self, u: np.ndarray) -> np.ndarray:
        """∂force/∂u (e, a, i, b, k) [N/m]."""
        F, cof, J, first = self._kinematics(u)
        if not self.mixed:
            return self._against(log_tangent(self.material, F, cof, J))
        theta = self._mean(J)
        stress, by_theta, curvature = rubber(self.material, F, cof, J, first, theta)
        tangent = rubber_tangent(self.material, F, cof, J, first, theta)
        pressure = self._mean(by_theta)
        for i in (0, 1):
            for j in (0, 1):
                tangent[..., i, j, 1 - i, 1 - j] += SIGN[i, j] * pressure
        e, q = J.shape
        volume = (self.slope @ cof.transpose(0, 1, 3, 2)).reshape(e, q, -1)
        theta_of_u = self.projection @ volume
        mixed = (2.0 / 3.0) * (self.slope @ stress.transpose(0, 1, 3, 2)).reshape(e, q, -1)
        half = mixed / theta[..., None] + 0.5 * curvature[..., None] * theta_of_u
        cross = (half * self.weight[..., None]).transpose(0, 2, 1) @ theta_of_u
        nodes = self.slope.shape[2]
        cross = (cross + cross.transpose(0, 2, 1)).reshape(e, nodes, 2, nodes, 2)
        return self._against(tangent) + cross

    def _against(self, tangent: np.ndarray) -> np.ndarray:
        """∫ Grad φ_a · 𝔸 · Grad φ_b dV from 𝔸 (e, q, i, J, k, L)."""
        e, q, nodes, _ = self.slope.shape
        stiffness = np.empty((e, nodes, 2, nodes, 2))
        slope = self.slope.transpose(0, 1, 3, 2)
        for i in (0, 1):
            for k in (0, 1):
                part = (tangent[:, :, i, :, k, :] @ slope).reshape(e, 2 * q, nodes)
                stiffness[:, :, i, :, k] = self.weighted @ part
        return stiffness


def rubber(material: Material, F, cof, J, first, theta):
    """∂ψ/∂F, ∂ψ/∂θ and ∂²ψ/∂θ² of ψ = A(I(θ/J)^(2/3) − 3) + C(θ⁻⁴ − 1) + D(θ² − 1)²,
    the Mooney–Rivlin law with B = 0 [Pa]."""
    a, b, c, d = material.rubber
    if material.law != "mooney_rivlin" or b != 0.0:
        raise ValueError(f"{material.name}: only the Mooney–Rivlin law with B = 0 is solved")
    scale = a * (theta / J) ** (2.0 / 3.0)
    stress = 2.0 * scale[..., None, None] * (F - (first / (3.0 * J))[..., None, None] * cof)
    by_theta = 2.0 / 3.0 * scale * first / theta - 4.0 * c * theta**-5
    by_theta += 4.0 * d * theta * (theta**2 - 1.0)
    curvature = -2.0 / 9.0 * scale * first / theta**2 + 20.0 * c * theta**-6
    return stress, by_theta, curvature + 4.0 * d * (3.0 * theta**2 - 1.0)


def rubber_tangent(material: Material, F, cof, J, first, theta):
    """∂²ψ/∂F∂F (e, q, i, J, k, L) of the same [Pa]."""
    scale = (material.rubber[0] * (theta / J) ** (2.0 / 3.0))[..., None, None, None, None]
    inverse = cof / J[..., None, None]
    first = first[..., None, None, None, None]
    mixed = outer(F, inverse)
    tangent = -4.0 / 3.0 * (mixed + mixed.transpose(0, 1, 4, 5, 2, 3))
    tangent += 4.0 / 9.0 * first * outer(inverse, inverse) + 2.0 * IDENTITY
    tangent += 2.0 / 3.0 * first * turned(inverse)
    return scale * tangent


def log_stress(material: Material, F, cof, J):
    """P = μF + (λ ln J − μ) F⁻ᵀ [Pa] of ψ = μ(I − 3)/2 − μ ln J + λ(ln J)²/2."""
    if material.law != "neo_hookean_log_j":
        raise ValueError(f"{material.name}: of compressible laws only neo_hookean_log_j is solved")
    mu, lame = material.shear_modulus, material.lame_modulus
    return mu * F + ((lame * np.log(J) - mu) / J)[..., None, None] * cof


def log_tangent(material: Material, F, cof, J):
    """∂P/∂F (e, q, i, J, k, L) of the same [Pa]."""
    mu, lame = material.shear_modulus, material.lame_modulus
    inverse = cof / J[..., None, None]
    factor = (mu - lame * np.log(J))[..., None, None, None, None]
    return mu * IDENTITY + lame * outer(inverse, inverse) + factor * turned(inverse)


SIGN = np.array([[1.0, -1.0], [-1.0, 1.0]])
IDENTITY = np.einsum("ik,JL->iJkL", np.eye(2), np.eye(2))


def outer(a, b) -> np.ndarray:
    """a_iJ b_kL."""
    return a[..., :, :, None, None] * b[..., None, None, :, :]


def turned(inverse) -> np.ndarray:
    """g_iL g_kJ of g = F⁻ᵀ: −∂g_iJ/∂F_kL."""
    return inverse[..., :, None, None, :] * inverse.swapaxes(-1, -2)[..., None, :, :, None]


class QuadElements:
    """All elements of the slice, as brain_motion.py and brain_record.py want them."""

    def __init__(self, case: Case, quads: Quads):
        basis = Basis(quads.mesh, ElementQuad2(), intorder=ORDER)
        self.positions = basis.doflocs.T.copy()
        self.blocks, self.shares, self.centres = [], [], []
        for index, region in enumerate(case.regions):
            part = basis.with_elements(np.nonzero(quads.region == index)[0])
            block = Block(part, region.material, case.thickness)
            share = np.bincount(block.dofs.ravel(), block.node_weight.ravel(), len(self.positions))
            moment = np.sum(block.weight[..., None] * block.point, axis=(0, 1))
            self.blocks.append(block)
            self.shares.append(share)
            self.centres.append(moment / block.weight.sum())
        self.mass = sp.csr_matrix(sp.kron(self._mass(case), np.eye(2)))
        pairs = [2 * block.dofs[:, :, None] + np.arange(2) for block in self.blocks]
        self.dofs = dofs = [pair.reshape(len(pair), -1) for pair in pairs]
        self.rows = np.concatenate([np.repeat(d, d.shape[1], axis=1).ravel() for d in dofs])
        self.columns = np.concatenate([np.tile(d, (1, d.shape[1])).ravel() for d in dofs])

    def _mass(self, case: Case) -> sp.csr_matrix:
        """∫ ρ φ_a φ_b dV [kg]."""
        entries, rows, columns = [], [], []
        for block, region in zip(self.blocks, case.regions):
            weighted = block.shape * (region.material.density * block.weight)[..., None]
            entries.append((weighted.transpose(0, 2, 1) @ block.shape).ravel())
            nodes = block.dofs.shape[1]
            rows.append(np.repeat(block.dofs, nodes, axis=1).ravel())
            columns.append(np.tile(block.dofs, (1, nodes)).ravel())
        where = (np.concatenate(rows), np.concatenate(columns))
        count = len(self.positions)
        return sp.csr_matrix((np.concatenate(entries), where), (count, count))

    def force(self, u: np.ndarray) -> np.ndarray:
        """Inner forces [N]."""
        total = np.zeros(len(u))
        for block, dofs in zip(self.blocks, self.dofs):
            total += np.bincount(dofs.ravel(), block.force(u).ravel(), len(u))
        return total

    def stiffness(self, u: np.ndarray) -> sp.csr_matrix:
        """∂force/∂u [N/m]."""
        entries = np.concatenate([block.stiffness(u).ravel() for block in self.blocks])
        return sp.csr_matrix((entries, (self.rows, self.columns)), (len(u), len(u)))

    def energy(self, u: np.ndarray) -> float:
        """Strain energy [J]."""
        return sum(block.energy(u) for block in self.blocks)
