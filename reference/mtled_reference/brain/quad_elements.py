"""Forces and stiffness of the brain slice on quadrilaterals with nine nodes.

Nearly incompressible regions have three fields u, p, θ, with p and θ linear in each
element and discontinuous between elements. Both are eliminated in each element,
θ = ΠJ and p = Π ∂ψ/∂θ with the L² projection Π; ψ is taken at (θ/J)^(1/3) F.
Other regions have displacements alone.
"""

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementQuad2

from ..shared.case import Case
from ..shared.materials import Material, strain_energy, three_field_energy
from .plane_laws import (
    SIGN,
    mooney_rivlin,
    mooney_rivlin_tangent,
    neo_hookean_stress,
    neo_hookean_tangent,
)
from .quads import Quads

ORDER = 5
"""Order of the quadrature: three points per direction."""


class Block:
    """The elements of one region, with φ and Grad φ at the quadrature points.

    Indices: e element, q quadrature point, a node, i and J of F. The volumes (e, q) [m³]
    are those of the quadrature points.
    """

    def __init__(self, basis: Basis, material: Material, thickness: float):
        self.material = material
        self.mixed = material.is_nearly_incompressible
        self.dofs = basis.element_dofs.T
        self.volume = basis.dx * thickness
        shapes = [shape[0] for shape in basis.basis]
        values = [np.broadcast_to(np.asarray(s), self.volume.shape) for s in shapes]
        self.phi = np.stack(values, axis=-1)
        self.node_volume = np.sum(self.phi * self.volume[..., None], axis=1)
        self.point = np.asarray(basis.global_coordinates()).transpose(1, 2, 0)
        self.grad_phi = np.stack([s.grad for s in shapes], axis=-1).transpose(1, 2, 3, 0).copy()
        weighted = self.grad_phi * self.volume[:, :, None, None]
        e, q, a, _ = weighted.shape
        self.weighted_grad_phi = weighted.transpose(0, 2, 1, 3).reshape(e, a, 2 * q)
        if self.mixed:
            self.projection = self._projection()

    def _projection(self) -> np.ndarray:
        """Π (e, q, q) on the linear functions."""
        middle = self.point.mean(axis=1, keepdims=True)
        arm = (self.point - middle) / np.ptp(self.point, axis=1, keepdims=True)
        linear = np.concatenate([np.ones_like(arm[..., :1]), arm], axis=2)
        weighted = (linear * self.volume[:, :, None]).transpose(0, 2, 1)
        return linear @ np.linalg.solve(weighted @ linear, weighted)

    def _mean(self, values: np.ndarray) -> np.ndarray:
        """Π of values (e, q)."""
        return (self.projection @ values[..., None])[..., 0]

    def _kinematics(self, u: np.ndarray):
        """F (e, q, 2, 2), its cofactor, J and I = tr C with F₃₃ = 1."""
        local = u.reshape(-1, 2)[self.dofs].transpose(0, 2, 1)
        F = local[:, None] @ self.grad_phi + np.eye(2)
        cof = F[..., ::-1, ::-1] * SIGN
        J = np.sum(F[..., 0, :] * cof[..., 0, :], axis=-1)
        if J.min() <= 0.0:
            raise FloatingPointError(f"{self.material.name}: an element is inverted")
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
        return float(np.sum(self.volume * psi))

    def force(self, u: np.ndarray) -> np.ndarray:
        """Nodal forces (e, a, i) [N]: ∫ (∂ψ/∂F + p cof F) · Grad φ_a dV."""
        F, cof, J, first = self._kinematics(u)
        if self.mixed:
            stress, by_theta, _ = mooney_rivlin(self.material, F, cof, J, first, self._mean(J))
            stress = stress + self._mean(by_theta)[..., None, None] * cof
        else:
            stress = neo_hookean_stress(self.material, F, cof, J)
        e, q = J.shape
        return self.weighted_grad_phi @ stress.transpose(0, 1, 3, 2).reshape(e, 2 * q, 2)

    def stiffness(self, u: np.ndarray) -> np.ndarray:
        """∂force/∂u (e, a, i, b, k) [N/m]."""
        F, cof, J, first = self._kinematics(u)
        if not self.mixed:
            return self._contracted(neo_hookean_tangent(self.material, F, cof, J))
        theta = self._mean(J)
        stress, by_theta, curvature = mooney_rivlin(self.material, F, cof, J, first, theta)
        tangent = mooney_rivlin_tangent(self.material, F, cof, J, first, theta)
        pressure = self._mean(by_theta)
        for i in (0, 1):
            for j in (0, 1):
                tangent[..., i, j, 1 - i, 1 - j] += SIGN[i, j] * pressure
        e, q = J.shape
        volume = (self.grad_phi @ cof.transpose(0, 1, 3, 2)).reshape(e, q, -1)
        theta_of_u = self.projection @ volume
        mixed = (2.0 / 3.0) * (self.grad_phi @ stress.transpose(0, 1, 3, 2)).reshape(e, q, -1)
        half = mixed / theta[..., None] + 0.5 * curvature[..., None] * theta_of_u
        cross = (half * self.volume[..., None]).transpose(0, 2, 1) @ theta_of_u
        nodes = self.grad_phi.shape[2]
        cross = (cross + cross.transpose(0, 2, 1)).reshape(e, nodes, 2, nodes, 2)
        return self._contracted(tangent) + cross

    def _contracted(self, tangent: np.ndarray) -> np.ndarray:
        """∫ Grad φ_a · 𝔸 · Grad φ_b dV from 𝔸 (e, q, i, J, k, L)."""
        e, q, nodes, _ = self.grad_phi.shape
        stiffness = np.empty((e, nodes, 2, nodes, 2))
        grad_phi = self.grad_phi.transpose(0, 1, 3, 2)
        for i in (0, 1):
            for k in (0, 1):
                part = (tangent[:, :, i, :, k, :] @ grad_phi).reshape(e, 2 * q, nodes)
                stiffness[:, :, i, :, k] = self.weighted_grad_phi @ part
        return stiffness


class QuadElements:
    """All elements of the slice, with what `run` in run.py needs."""

    def __init__(self, case: Case, quads: Quads):
        basis = Basis(quads.mesh, ElementQuad2(), intorder=ORDER)
        self.positions = basis.doflocs.T.copy()
        self.blocks, self.node_volumes, self.centres = [], [], []
        for index, region in enumerate(case.regions):
            part = basis.with_elements(np.nonzero(quads.region == index)[0])
            block = Block(part, region.material, case.thickness)
            count = len(self.positions)
            volumes = np.bincount(block.dofs.ravel(), block.node_volume.ravel(), count)
            moment = np.sum(block.volume[..., None] * block.point, axis=(0, 1))
            self.blocks.append(block)
            self.node_volumes.append(volumes)
            self.centres.append(moment / block.volume.sum())
        self.mass = sp.csr_matrix(sp.kron(self._mass(case), np.eye(2)))
        pairs = [2 * block.dofs[:, :, None] + np.arange(2) for block in self.blocks]
        self.dofs = dofs = [pair.reshape(len(pair), -1) for pair in pairs]
        self.rows = np.concatenate([np.repeat(d, d.shape[1], axis=1).ravel() for d in dofs])
        self.columns = np.concatenate([np.tile(d, (1, d.shape[1])).ravel() for d in dofs])

    def _mass(self, case: Case) -> sp.csr_matrix:
        """∫ ρ φ_a φ_b dV [kg]."""
        entries, rows, columns = [], [], []
        for block, region in zip(self.blocks, case.regions):
            weighted = block.phi * (region.material.density * block.volume)[..., None]
            entries.append((weighted.transpose(0, 2, 1) @ block.phi).ravel())
            nodes = block.dofs.shape[1]
            rows.append(np.repeat(block.dofs, nodes, axis=1).ravel())
            columns.append(np.tile(block.dofs, (1, nodes)).ravel())
        where = (np.concatenate(rows), np.concatenate(columns))
        count = len(self.positions)
        return sp.csr_matrix((np.concatenate(entries), where), (count, count))

    def force(self, u: np.ndarray) -> np.ndarray:
        """Internal forces [N]."""
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
