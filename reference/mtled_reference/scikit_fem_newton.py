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

RESIDUAL = 1e-10
"""Newton has converged at this residual over the forces at work [–]."""

ROUND_OFF = 1e-8
"""A residual that no longer falls is accepted from here [–]: slender bodies are
stiff along and soft across."""

MAX_ITERATIONS = 20

KEEP = 1e-4
"""From this residual on [–] a matrix is kept while it reduces the residual tenfold."""

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
    model: Model,
    steps: int,
    progress: Callable[[float, str], None],
    factors: Factorisation,
    guess: np.ndarray | None = None,
    residual: float = RESIDUAL,
    smallest_step: float = SMALLEST_STEP,
) -> StaticSolution:
    """Equilibrium at the end of loading: from a guess (n, d) [m] if that leads to
    it, otherwise in proportional load steps. A step starts in the direction of the
    last one, or if that fails from where it ended; if that fails it is halved."""
    end = model.case.time.load_end
    full = model.prescribed(lambda amplitude: amplitude(end))
    loads = model.loads(lambda amplitude: amplitude(end))
    u, load, step = np.zeros_like(full), 0.0, 1.0 / steps
    taken = iterations = 0
    if guess is not None:
        progress(0.0, "from the solution of a coarser mesh")
        try:
            start = np.where(model.fixed, full, guess)
            u, iterations = _equilibrium(model, start, full, loads, factors, residual)
            load, taken = 1.0, 1
        except (NotConverged, FloatingPointError):
            progress(0.0, "with load steps, since the coarser mesh is no help")
    rate = np.zeros_like(full)
    while load < 1.0 - 1e-12:
        target = min(1.0, load + step)
        progress(load, f"load {target:.3f}")
        foreseen = u + (target - load) * rate
        try:
            found, used = _equilibrium(
                model, foreseen, target * full, target * loads, factors, residual
            )
        except (NotConverged, FloatingPointError):
            if np.any(rate):
                rate = np.zeros_like(full)
                continue
            step *= 0.5
            if step < smallest_step:
                raise NotConverged(f"no equilibrium beyond {load:.4f} of the load") from None
            continue
        rate = (found - u) / (target - load)
        u, load, taken, iterations = found, target, taken + 1, iterations + used
    energy, internal = model.internal(u)
    progress(1.0, "solved")
    return StaticSolution(u, internal - loads, energy, taken, iterations)


def _equilibrium(
    model, start, prescribed, loads, factors, wanted: float
) -> tuple[np.ndarray, int]:
    """Newton from `start`; the first iteration carries the change of the supports.

    Near the end the matrix is kept: solving again is cheaper than a new one.
    """
    free = model.free
    along = np.where(model.fixed, prescribed - start, 0.0)
    _, internal, tangent, product = model.internal(start, True, along)
    factors.factorise(tangent)
    u = start + along - _solved(model, factors, internal - loads + product)
    previous = np.inf
    for iteration in range(1, MAX_ITERATIONS):
        _, internal = model.internal(u)
        residual = internal - loads
        norm = float(np.linalg.norm(residual.ravel()[free]))
        if not np.isfinite(norm):
            raise NotConverged("the residual is not finite")
        if is_converged(norm, previous, float(np.linalg.norm(internal)), wanted):
            return u, iteration
        if norm > KEEP * np.linalg.norm(internal) or norm > 0.1 * previous:
            factors.factorise(model.internal(u, True)[2])
        previous = norm
        u = u - _solved(model, factors, residual)
    raise NotConverged(f"residual too large after {MAX_ITERATIONS} iterations")


def _solved(model: Model, factors: Factorisation, forces: np.ndarray) -> np.ndarray:
    """Displacements (n, d) by which the matrix balances forces on free unknowns."""
    change = np.zeros(forces.size)
    change[model.free] = factors.solve(forces.ravel()[model.free])
    return change.reshape(forces.shape)


def is_converged(norm: float, previous: float, size: float, wanted: float = RESIDUAL) -> bool:
    """Whether the residual of the free unknowns is small beside the forces inside,
    or small and as low as round-off lets it fall."""
    return norm <= wanted * size or (norm <= ROUND_OFF * size and norm > 0.3 * previous)
