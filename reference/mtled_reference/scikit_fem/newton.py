"""Newton's method with load steps."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..shared.errors import NotConverged
from .factorisation import Factorisation
from .model import Model

RESIDUAL = 1e-10
"""Largest norm of the residual over that of the internal forces [–]."""

ROUND_OFF = 1e-8
"""A residual that stagnates is accepted below this [–]: rounding errors are large in
slender bodies, which are stiff along and soft across."""

MAX_ITERATIONS = 20

KEEP = 1e-4
"""Below this residual [–] a factorisation is kept while it reduces the residual tenfold."""

SMALLEST_STEP = 1.0 / 512.0
"""Smallest load step over the load [–]; a smaller one means failure."""


@dataclass
class StaticSolution:
    """Displacements (n, d) [m], reactions of the supports (n, d) [N], strain energy [J],
    and the numbers of load steps and Newton iterations."""

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
    """Equilibrium at the end of loading.

    Newton's method starts from a guess (n, d) [m] if there is one, and takes
    proportional load steps if that fails. A step starts from the extrapolation of the
    last one; if that fails, from where the last one ended; if that fails, it is halved.
    """
    end = model.case.time.load_end
    full = model.prescribed(lambda amplitude: amplitude(end))
    loads = model.loads(lambda amplitude: amplitude(end))
    solved = None
    if guess is not None:
        progress(0.0, "from the solution of a coarser mesh")
        try:
            start = np.where(model.fixed, full, guess)
            model.fraction = 1.0
            u, iterations = _equilibrium(model, start, full, loads, factors, residual)
            solved = u, 1, iterations
        except (NotConverged, FloatingPointError):
            progress(0.0, "with load steps: no convergence from the coarser mesh")
    if solved is None:
        step = 1.0 / steps
        solved = _loaded(model, full, loads, step, progress, factors, residual, smallest_step)
    u, taken, iterations = solved
    energy, internal = model.internal(u)
    progress(1.0, "solved")
    return StaticSolution(u, internal - loads, energy, taken, iterations)


def _loaded(
    model, full, loads, step: float, progress, factors, residual: float, smallest_step: float
) -> tuple[np.ndarray, int, int]:
    """Displacements under the full load, with the numbers of load steps and iterations."""
    u, rate, load = np.zeros_like(full), np.zeros_like(full), 0.0
    taken = iterations = 0
    while load < 1.0 - 1e-12:
        target = min(1.0, load + step)
        progress(load, f"load {target:.3f}")
        model.fraction = target
        extrapolated = u + (target - load) * rate
        try:
            solution, used = _equilibrium(
                model, extrapolated, target * full, target * loads, factors, residual
            )
        except (NotConverged, FloatingPointError):
            if np.any(rate):
                rate = np.zeros_like(full)
                continue
            step *= 0.5
            if step < smallest_step:
                raise NotConverged(f"no equilibrium beyond {load:.4f} of the load") from None
            continue
        rate = (solution - u) / (target - load)
        u, load, taken, iterations = solution, target, taken + 1, iterations + used
    return u, taken, iterations


def _equilibrium(
    model, start, prescribed, loads, factors, tolerance: float
) -> tuple[np.ndarray, int]:
    """Newton's method from `start`; the first iteration moves the supports.

    Near the solution the factorisation is kept, since a new one costs more than
    another iteration.
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
        if _is_converged(norm, previous, float(np.linalg.norm(internal)), tolerance):
            return u, iteration
        if norm > KEEP * np.linalg.norm(internal) or norm > 0.1 * previous:
            factors.factorise(model.internal(u, True)[2])
        previous = norm
        u = u - _solved(model, factors, residual)
    raise NotConverged(f"residual too large after {MAX_ITERATIONS} iterations")


def _solved(model: Model, factors: Factorisation, forces: np.ndarray) -> np.ndarray:
    """Displacements (n, d) [m] that the matrix gives for forces on the free unknowns."""
    change = np.zeros(forces.size)
    change[model.free] = factors.solve(forces.ravel()[model.free])
    return change.reshape(forces.shape)


def _is_converged(norm: float, previous: float, size: float, tolerance: float) -> bool:
    """Whether the residual is below the tolerance, or as low as rounding errors allow;
    `size` is the norm of the internal forces."""
    return norm <= tolerance * size or (norm <= ROUND_OFF * size and norm > 0.3 * previous)
