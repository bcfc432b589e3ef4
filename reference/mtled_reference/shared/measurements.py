"""Values of a solution that are stored: probes, reactions and energies, as plain lists."""

from dataclasses import dataclass, field

import numpy as np

from .case import Case

INSTANTS = 40
"""Instants of a history, equally spaced, the last at the end."""


def recorded_times(case: Case, instants: int = INSTANTS) -> list[float]:
    """Instants of the values [s]: the end of loading, or a history without t = 0."""
    if case.is_static:
        return [case.time.load_end]
    return [case.time.end * (n + 1) / instants for n in range(instants)]


def in_space(vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 2) or (n, 3) as (n, 3), with z = 0 where it is missing."""
    vectors = np.atleast_2d(vectors)
    missing = 3 - vectors.shape[1]
    return np.pad(vectors, ((0, 0), (0, missing)))


def resultant(positions, displacements, forces, about) -> tuple[np.ndarray, np.ndarray]:
    """Force Σ f [N] and moment Σ (X + u − about) × f [N·m] of nodal forces (n, 3)
    at displaced positions."""
    arms = in_space(positions) + in_space(displacements) - about
    forces = in_space(forces)
    return forces.sum(axis=0), np.cross(arms, forces).sum(axis=0)


@dataclass
class Measurements:
    """Values over the recorded times, by the keys of the reference file."""

    values: dict[str, list] = field(default_factory=dict)

    def centre(self, probe: str, position: np.ndarray) -> None:
        """Reference centre of mass of a probe [m]."""
        self.values[f"centre/{probe}"] = rounded(in_space(position))

    def displacement(self, probe: str, displacements: np.ndarray) -> None:
        """Displacements (n, 2 or 3) [m] of a probe's positions at one instant."""
        self._append(f"displacement/{probe}", in_space(displacements))

    def reaction(self, condition: str, force: np.ndarray, moment: np.ndarray) -> None:
        """Force [N] and moment [N·m] that a support exerts on the body."""
        self._append(f"force/{condition}", in_space(force))
        self._append(f"moment/{condition}", in_space(moment))

    def contact(self, obstacle: str, force: np.ndarray) -> None:
        """Force [N] that an obstacle exerts on the body."""
        self._append(f"contact/{obstacle}", in_space(force))

    def strain_energy(self, energy: float) -> None:
        """∫ ψ dV [J]."""
        self._append("strain_energy", energy)

    def kinetic_energy(self, energy: float) -> None:
        """∫ ρ v²/2 dV [J]."""
        self._append("kinetic_energy", energy)

    def _append(self, key: str, numbers) -> None:
        self.values.setdefault(key, []).append(rounded(numbers))


ZERO_BELOW = 1e-30
"""Smaller numbers are written as 0; all quantities of the cases are far larger."""


def rounded(numbers) -> list[float]:
    """A flat list of numbers with 9 significant digits; an error if one is not finite."""
    flat = np.ravel(np.asarray(numbers, dtype=float))
    if not np.all(np.isfinite(flat)):
        raise ValueError("a value is not finite")
    return [nine_digits(number) if abs(number) > ZERO_BELOW else 0.0 for number in flat]


def nine_digits(number: float) -> float:
    """The number rounded to 9 significant digits."""
    return float(f"{number:.9g}")
