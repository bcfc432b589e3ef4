"""Kinematics: how the unknowns give F, and how they relate to displacements in space.

Each class has the number of `components` per node, F = `deformation_gradient(u, domain)`
(3 × 3) and `volume_factor(domain)` = dV/dx, which is also dA/ds; the other methods convert
between the mesh with its unknowns and residuals, and positions, displacements and forces in
space.
"""

from dataclasses import dataclass

import numpy as np
import ufl

from ..shared.measurements import resultant


def invariants(F):
    """I = tr C, II = (I² − C:C)/2 and J = det F, with C = FᵀF."""
    C = F.T * F
    return ufl.tr(C), (ufl.tr(C) ** 2 - ufl.tr(C * C)) / 2, ufl.det(F)


@dataclass(frozen=True)
class Solid:
    """Three dimensions; the unknowns are the displacements."""

    components = 3
    quadrature_degree = 4

    def deformation_gradient(self, u, domain):
        return ufl.Identity(3) + ufl.grad(u)

    def volume_factor(self, domain):
        return 1.0

    def positions(self, points: np.ndarray) -> np.ndarray:
        """Positions (n, 3) [m] of mesh points (n, 3), which are padded with zeros."""
        return points

    def mesh_points(self, positions: np.ndarray) -> np.ndarray:
        """Mesh points (n, 3) of positions (n, 3) [m]."""
        return positions

    def unknowns(self, positions, displacements):
        """Unknowns (n, components) of displacements (n, 3) [m] at positions (n, 3)."""
        return displacements

    def displacements(self, positions, unknowns):
        """Displacements (n, 3) [m] of unknowns (n, components) at positions (n, 3)."""
        return unknowns

    def resultant(self, positions, unknowns, residuals, about):
        """Force [N] and moment [N·m] of residuals (n, components) at displaced nodes."""
        return resultant(positions, self.displacements(positions, unknowns), residuals, about)

    def means(self, masses, positions, unknowns):
        """Centre of mass (3,) [m] and its displacement (3,) [m] for nodal masses [kg]."""
        fractions = masses / masses.sum()
        return fractions @ positions, fractions @ self.displacements(positions, unknowns)


@dataclass(frozen=True)
class PlaneStrain(Solid):
    """A slice of `thickness` [m] at `z` [m] that keeps its thickness."""

    thickness: float
    z: float
    components = 2

    def deformation_gradient(self, u, domain):
        h = ufl.grad(u)
        return ufl.as_matrix([[1 + h[0, 0], h[0, 1], 0], [h[1, 0], 1 + h[1, 1], 0], [0, 0, 1]])

    def volume_factor(self, domain):
        return self.thickness

    def positions(self, points):
        return np.column_stack([points[:, :2], np.full(len(points), self.z)])

    def mesh_points(self, positions):
        return np.column_stack([positions[:, :2], np.zeros(len(positions))])

    def unknowns(self, positions, displacements):
        return displacements[:, :2]

    def displacements(self, positions, unknowns):
        return np.column_stack([unknowns, np.zeros(len(unknowns))])


@dataclass(frozen=True)
class Axisymmetric(Solid):
    """A body of revolution about z whose motion is the same at all angles, with twist.

    Mesh points are (R, Z); unknowns are (u_r, φ, u_z): the point (R, Θ, Z) moves to
    (R + u_r, Θ + φ, Z + u_z). In the basis e_r, e_θ, e_z turned by φ,
    F = [[∂r/∂R, 0, ∂r/∂Z], [r ∂φ/∂R, r/R, r ∂φ/∂Z], [∂z/∂R, 0, ∂z/∂Z]].
    """

    components = 3
    quadrature_degree = 6

    def deformation_gradient(self, u, domain):
        radius = ufl.SpatialCoordinate(domain)[0]
        h, r = ufl.grad(u), radius + u[0]
        return ufl.as_matrix(
            [
                [1 + h[0, 0], 0, h[0, 1]],
                [r * h[1, 0], r / radius, r * h[1, 1]],
                [h[2, 0], 0, 1 + h[2, 1]],
            ]
        )

    def volume_factor(self, domain):
        return 2.0 * np.pi * ufl.SpatialCoordinate(domain)[0]

    def positions(self, points):
        return np.column_stack([points[:, 0], np.zeros(len(points)), points[:, 1]])

    def mesh_points(self, positions):
        radius = np.hypot(positions[:, 0], positions[:, 1])
        return np.column_stack([radius, positions[:, 2], np.zeros(len(positions))])

    def unknowns(self, positions, displacements):
        """On the axis, where the angle is undefined, that of the nearest node off it is used."""
        moved = positions + displacements
        radius = np.hypot(moved[:, 0], moved[:, 1])
        angle = np.arctan2(moved[:, 1], moved[:, 0])
        on_axis = positions[:, 0] < 1e-9 * positions[:, 0].max()
        for node in np.flatnonzero(on_axis):
            distance = np.linalg.norm(positions - positions[node], axis=1)
            angle[node] = angle[np.argmin(np.where(on_axis, np.inf, distance))]
        return np.column_stack([radius - positions[:, 0], angle, displacements[:, 2]])

    def displacements(self, positions, unknowns):
        radius = np.hypot(positions[:, 0], positions[:, 1])
        start = np.arctan2(positions[:, 1], positions[:, 0])
        r, angle = radius + unknowns[:, 0], start + unknowns[:, 1]
        moved = np.column_stack([r * np.cos(angle), r * np.sin(angle)])
        return np.column_stack([moved - positions[:, :2], unknowns[:, 2]])

    def resultant(self, positions, unknowns, residuals, about):
        """Integrated around the axis, only the axial force and the torque remain."""
        force = np.array([0.0, 0.0, residuals[:, 2].sum()])
        torque = np.array([0.0, 0.0, residuals[:, 1].sum()])
        return force, torque + np.cross(-np.asarray(about, float), force)

    def means(self, masses, positions, unknowns):
        """The centre of mass stays on the axis by symmetry."""
        fractions = masses / masses.sum()
        axial = np.array([0.0, 0.0, 1.0])
        return fractions @ positions[:, 2] * axial, fractions @ unknowns[:, 2] * axial
