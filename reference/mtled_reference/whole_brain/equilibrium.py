"""Equilibrium of the body with the skull: Newton's method with load steps.

A body that touches nothing yet has free rigid motions. Then its mass is held back by
springs to where the last solution was: R(u) + κ V (u − u_last) = 0 with the volumes V of
the nodes and a stiffness κ [N/m⁴] that falls from one solution to the next, last to zero.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from ..shared.errors import NotConverged
from .contact import Wall

RESIDUAL = 1e-6
"""Largest norm of the residual at free unknowns over that of the acting forces [–]."""
ITERATIONS = 40
HALVINGS = 8
GROWTH = 2.0
"""A correction is halved, twice at most, where it makes the residual this many times as large."""
SPRINGS = (1e6, 2e5, 4e4, 8e3, 1e3)
"""Stiffnesses κ [N/m⁴] in turn; each is solved roughly."""
AUGMENTATIONS = 2
"""Number of times that the pressures become the multipliers."""
INTERIM = 1e-4
"""Residual [–] of all solutions but the last."""
ROUGH = 1e-2
"""Residual [–] at which a solution with springs is left."""
STEPS = (0.5, 1.0)
"""Fractions of the prescribed displacements in turn."""


@dataclass
class Balance:
    """Elements, skull, loads (3 n,) [N] and prescribed unknowns with their values [m].

    `elements` has force(u), stiffness(u) (CSR) and solved(matrix, right), and may have more
    unknowns than the displacements, which come first. `progress` is called with the iteration,
    the fraction of the load, κ, the residual and the penetration [m].
    """

    elements: object
    wall: Wall
    loads: np.ndarray
    prescribed: np.ndarray
    values: np.ndarray
    progress: object
    iterations: int = 0
    load_steps: int = 0
    last_change: float = 0.0
    """Largest displacement [m] by the last augmentation."""

    def solve(self) -> np.ndarray:
        """The unknowns in equilibrium."""
        u = self._first()
        for turn in range(AUGMENTATIONS):
            before = u
            self.wall.augment(u[: self.loads.size])
            last = turn + 1 == AUGMENTATIONS
            u = self._newton(u, 1.0, 0.0, RESIDUAL if last else INTERIM)
        change = (u - before)[: self.loads.size].reshape(-1, 3)
        self.last_change = float(np.linalg.norm(change, axis=1).max())
        return u

    def _first(self) -> np.ndarray:
        """The equilibrium without multipliers."""
        u = self.elements.at_rest()
        if self.prescribed.size:
            for fraction in STEPS:
                u = self._newton(u, fraction, 0.0, INTERIM)
            return u
        for kappa in SPRINGS:
            u = self._newton(u, 1.0, kappa, ROUGH)
        return self._newton(u, 1.0, 0.0, INTERIM)

    def _residual(self, u, held, kappa):
        n = self.loads.size
        force = self.elements.force(u)
        contact = self.wall.force(u[:n])
        force[:n] -= contact + self.loads
        force[:n] += kappa * self.elements.node_volumes_3 * (u[:n] - held)
        scale = np.linalg.norm(contact) + np.linalg.norm(self.loads)
        return force, scale

    def _newton(self, u, fraction, kappa, tolerance) -> np.ndarray:
        n = self.loads.size
        held, target = u[:n].copy(), fraction * self.values
        free = np.ones(u.size, bool)
        free[self.prescribed] = False
        residual, scale = self._residual(u, held, kappa)
        self.load_steps += 1
        for iteration in range(ITERATIONS):
            norm = np.linalg.norm(residual[free])
            scale += np.linalg.norm(residual[self.prescribed])
            moved = np.abs(u[self.prescribed] - target).max(initial=0.0) < 1e-12
            relative = norm / max(scale, 1e-30)
            self.progress(iteration, fraction, kappa, relative, self.wall.penetration(u[:n]))
            if moved and iteration and norm <= tolerance * scale:
                return u
            change = self._correction(u, residual, target, kappa, free)
            u, residual, scale = self._advance(
                u, change, held, kappa, norm if moved else np.inf, free
            )
            self.iterations += 1
        raise NotConverged(f"residual {norm / scale:.1e} after {ITERATIONS} iterations")

    def _correction(self, u, residual, target, kappa, free) -> np.ndarray:
        n = self.loads.size
        matrix = self.elements.stiffness(u)
        extra = self.wall.stiffness(u[:n]) + sp.diags(kappa * self.elements.node_volumes_3)
        extra.resize(matrix.shape)
        matrix = (matrix + extra).tocsr()
        change = np.zeros(u.size)
        change[self.prescribed] = target - u[self.prescribed]
        right = -(residual + matrix @ change)[free]
        change[free] = self.elements.solved(matrix[free][:, free], right)
        return change

    def _advance(self, u, change, held, kappa, norm, free):
        """Adds the correction, halved while it inverts a cell or the residual grows too much."""
        fraction, best = 1.0, None
        for _ in range(HALVINGS):
            trial = u + fraction * change
            try:
                residual, scale = self._residual(trial, held, kappa)
            except FloatingPointError:
                fraction *= 0.5
                continue
            size = np.linalg.norm(residual[free])
            if best is None or size < best[0]:
                best = (size, trial, residual, scale)
            if size < GROWTH * norm:
                break
            fraction *= 0.5
            if fraction < 0.2:
                break
        if best is None:
            raise NotConverged("every step inverts a cell")
        return best[1:]
