"""Newton's method with load steps, and the sparse direct solver behind it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg

from .scikit_fem_model import Model

try:
    import pypardiso
except ImportError:
    pypardiso = None

RESIDUAL = 1e-9
"""Newton has converged at this residual over the forces at work [–]."""

MAX_ITERATIONS = 14
SMALLEST_STEP = 1.0 / 512.0
"""Of the load; a smaller step means failure."""


class NotConverged(RuntimeError):
    """Newton's method did not reach its residual."""


class Factorisation:
    """LDLᵀ of a symmetric matrix given by its upper triangle: PARDISO of the MKL
    where pypardiso is installed, SuperLU of SciPy otherwise (slower)."""

    def __init__(self):
        self._solver = pypardiso.PyPardisoSolver(mtype=-2) if pypardiso else None
        self._matrix = None

    @property
    def name(self) -> str:
        return "PARDISO (MKL)" if pypardiso else "SuperLU (SciPy)"

    def factorise(self, upper: sparse.csr_matrix) -> None:
        """Factorises; the pattern is analysed once."""
        self._matrix = upper
        if self._solver is None:
            full = (upper + sparse.triu(upper, 1).T).tocsc()
            self._factors = scipy.sparse.linalg.splu(full)
            return
        first = not np.any(self._solver.pt)
        self._call(12 if first else 22, np.zeros((upper.shape[0], 1)))

    def solve(self, right: np.ndarray) -> np.ndarray:
        """The solution for a right-hand side (n,)."""
        if self._solver is None:
            return self._factors.solve(right)
        return self._call(33, right[:, None]).ravel()

    def _call(self, phase: int, right: np.ndarray) -> np.ndarray:
        self._solver.set_phase(phase)
        return self._solver._call_pardiso(self._matrix, np.asfortranarray(right))


@dataclass
class StaticSolution:
    """Displacements (n, d) [m], forces of the supports (n, d) [N], strain energy
    [J] and how much work it was."""

    displacements: np.ndarray
    reactions: np.ndarray
    strain_energy: float
    load_steps: int
    newton_iterations: int


def solve_static(
    model: Model, steps: int, progress: Callable[[float, str], None], factors: Factorisation
) -> StaticSolution:
    """Equilibrium at the end of loading, reached in proportional load steps; a
    step that fails is halved."""
    end = model.case.time.load_end
    full = model.prescribed(lambda amplitude: amplitude(end))
    loads = model.loads(lambda amplitude: amplitude(end))
    u, load, step = np.zeros_like(full), 0.0, 1.0 / steps
    taken = iterations = 0
    while load < 1.0 - 1e-12:
        target = min(1.0, load + step)
        progress(load, f"load {target:.3f}")
        try:
            u, used = _equilibrium(model, u, target * full, target * loads, factors)
        except (NotConverged, FloatingPointError):
            step *= 0.5
            if step < SMALLEST_STEP:
                raise NotConverged(f"no equilibrium beyond {load:.4f} of the load") from None
            continue
        load, taken, iterations = target, taken + 1, iterations + used
    energy, internal = model.internal(u)
    progress(1.0, "solved")
    return StaticSolution(u, internal - loads, energy, taken, iterations)


def _equilibrium(model, start, prescribed, loads, factors) -> tuple[np.ndarray, int]:
    """Newton from `start`; the first step carries the change of the supports."""
    u = start.copy()
    free = model.free
    along = np.where(model.fixed, prescribed - u, 0.0)
    for iteration in range(MAX_ITERATIONS):
        _, internal, tangent, product = model.internal(u, True, along if iteration == 0 else None)
        residual = internal - loads
        if iteration > 0 and is_converged(residual, free, internal):
            return u, iteration
        factors.factorise(tangent)
        change = np.zeros(u.size)
        change[free] = -factors.solve((residual + product).ravel()[free])
        u = u + change.reshape(u.shape) + (along if iteration == 0 else 0.0)
        if not np.all(np.isfinite(u)):
            raise NotConverged("displacements are not finite")
    raise NotConverged(f"residual too large after {MAX_ITERATIONS} iterations")


def is_converged(residual: np.ndarray, free: np.ndarray, internal: np.ndarray) -> bool:
    """Whether the residual of the free unknowns is small beside the forces inside."""
    size = np.linalg.norm(internal)
    return float(np.linalg.norm(residual.ravel()[free])) <= RESIDUAL * size
