"""Planes of symmetry: a part of the body is meshed, the rest is its mirror image."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Mirror:
    """The plane x_axis = place [m]; the mesh lies on the side `side` (+1 or −1).

    The plane moves along its normal by the mean displacement of the two conditions
    in `between`, or is fixed if there are none.
    """

    axis: int
    place: float
    side: int = 1
    between: tuple[str, str] | None = None

    def shift(self, case, t: float, fraction: float) -> float:
        """Displacement [m] of the plane along its normal at a fraction of the loads."""
        if self.between is None:
            return 0.0
        rows = [row for row in case.prescriptions if row.name in self.between]
        total = sum(row.displacement[self.axis] * row.amplitude(t) * fraction for row in rows)
        return total / len(rows)

    def positions(self, positions: np.ndarray) -> np.ndarray:
        """Mirrored positions (n, 3) [m]."""
        return _reflected(positions, self.axis, self.place)

    def displacements(self, displacements: np.ndarray, shift: float) -> np.ndarray:
        """Mirrored displacements (n, 3) [m]."""
        return _reflected(displacements, self.axis, shift)

    def forces(self, forces: np.ndarray) -> np.ndarray:
        """Mirrored forces (n, 3) [N]."""
        return _reflected(forces, self.axis, 0.0)


def _reflected(vectors: np.ndarray, axis: int, place: float) -> np.ndarray:
    vectors = vectors.copy()
    vectors[:, axis] = 2.0 * place - vectors[:, axis]
    return vectors


def unfolded(mirrors, shifts, positions, displacements, forces):
    """Nodes of the whole body; each mirror doubles those of the mirrors before it."""
    for mirror, shift in zip(mirrors, shifts):
        positions = np.concatenate([positions, mirror.positions(positions)])
        displacements = np.concatenate([displacements, mirror.displacements(displacements, shift)])
        forces = np.concatenate([forces, mirror.forces(forces)])
    return positions, displacements, forces


def folded(mirrors, positions: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Positions mirrored to the side of the mesh, and which ones each mirror moved."""
    moved = []
    for mirror in mirrors:
        beyond = mirror.side * (positions[:, mirror.axis] - mirror.place) < 0.0
        positions = np.where(beyond[:, None], mirror.positions(positions), positions)
        moved.append(beyond)
    return positions, moved


def folded_back(mirrors, shifts, moved, displacements: np.ndarray) -> np.ndarray:
    """Displacements at the positions before `folded` from those at the folded ones."""
    for mirror, shift, beyond in zip(mirrors, shifts, moved):
        mirrored = mirror.displacements(displacements, shift)
        displacements = np.where(beyond[:, None], mirrored, displacements)
    return displacements
