"""Manufactured solutions on the unit cube: displacement fields and their body forces.

They are those of `verify/src/exact/manufactured.rs`. The body force b = −Div P/ρ is
differentiated by complex steps, which is exact to round-off (Squire and Trapp, SIAM
Review 40, 110, 1998).
"""

from dataclasses import dataclass

import numpy as np

from ..shared.materials import Material

STEP = 1e-30
"""Step of the complex differentiation; its square is below round-off."""


@dataclass(frozen=True)
class Manufactured:
    """A displacement field, `general` or `nearly_isochoric`, in a material."""

    field: str
    material: Material

    def displacement(self, X: np.ndarray) -> np.ndarray:
        """u (n, 3) [m] at positions (n, 3) [m]."""
        return np.real(self._field(X)[0])

    def deformation_gradient(self, X: np.ndarray) -> np.ndarray:
        """F = I + Grad u, (n, 3, 3)."""
        return np.eye(3) + self._field(X)[1]

    def body_force(self, X: np.ndarray) -> np.ndarray:
        """b (n, 3) [N/kg] at positions (n, 3) [m]."""
        divergence = np.zeros((len(X), 3))
        for axis in range(3):
            moved = X.astype(complex)
            moved[:, axis] += 1j * STEP
            stress = first_piola_kirchhoff(self.material, self.deformation_gradient(moved))
            divergence += np.imag(stress[:, :, axis]) / STEP
        return -divergence / self.material.density

    def _field(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        u, gradient = general(X)
        if self.field == "general":
            return u, gradient
        ratio = self.material.shear_modulus / self.material.lame_modulus
        shear, shear_gradient = shears(X)
        return shear + ratio * u, shear_gradient + ratio * gradient


def general(X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """u = ½ (sin(πX)/10, Y²Z/2, X ln(1 + Y)/5) and Grad u."""
    x, y, z = X.T
    zero = np.zeros_like(x)
    u = np.stack([0.05 * np.sin(np.pi * x), 0.25 * y * y * z, 0.1 * x * np.log(1.0 + y)], axis=1)
    rows = [
        [0.05 * np.pi * np.cos(np.pi * x), zero, zero],
        [zero, 0.5 * y * z, 0.25 * y * y],
        [0.1 * np.log(1.0 + y), 0.1 * x / (1.0 + y), zero],
    ]
    return u, _stacked(rows)


def shears(X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Three shears, one after the other: x = X + Z sin(πY)/10, y = Y + Z x²/10,
    z = Z + y sin(πx)/10; u and Grad u."""
    X0, Y0, Z0 = X.T
    unit = np.eye(3)[:, None, :]
    sine, cosine = np.sin(np.pi * Y0), np.cos(np.pi * Y0)
    x = X0 + 0.1 * Z0 * sine
    dx = unit[0] + 0.1 * ((np.pi * Z0 * cosine)[:, None] * unit[1] + sine[:, None] * unit[2])
    y = Y0 + 0.1 * Z0 * x * x
    dy = unit[1] + 0.1 * ((x * x)[:, None] * unit[2] + (2.0 * Z0 * x)[:, None] * dx)
    sine, cosine = np.sin(np.pi * x), np.cos(np.pi * x)
    z = Z0 + 0.1 * y * sine
    dz = unit[2] + 0.1 * (sine[:, None] * dy + (np.pi * y * cosine)[:, None] * dx)
    moved = np.stack([x, y, z], axis=1)
    return moved - X, np.stack([dx, dy, dz], axis=1) - np.eye(3)


def first_piola_kirchhoff(material: Material, F: np.ndarray) -> np.ndarray:
    """P = ∂ψ/∂F (n, 3, 3) [Pa], F real or complex."""
    mu = material.shear_modulus
    J = np.linalg.det(F)[:, None, None]
    inverse = np.linalg.inv(F).swapaxes(1, 2)
    if material.law == "neo_hookean_log_j":
        return mu * F + (material.lame_modulus * np.log(J) - mu) * inverse
    if material.law == "neo_hookean_isochoric" and material.volumetric == "quadratic":
        first = np.sum(F * F, axis=(1, 2))[:, None, None]
        isochoric = mu * J ** (-2.0 / 3.0) * (F - first / 3.0 * inverse)
        return isochoric + material.bulk_modulus * (J - 1.0) * J * inverse
    raise ValueError(f"no manufactured solution for {material.law}")


def _stacked(rows) -> np.ndarray:
    return np.moveaxis(np.array(rows), -1, 0)
