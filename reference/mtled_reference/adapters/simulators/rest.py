"""Rest by motion that is stopped whenever the kinetic energy has passed a peak (Barnes, Int. J.
Space Struct. 14, 89, 1999)."""

from collections.abc import Callable

import numpy as np

from ..files import Refused


def at_rest(
    advance: Callable[[float], np.ndarray],
    stop: Callable[[], None],
    masses: np.ndarray,
    ramp: int,
    steps: int,
    change_at_rest: float,
) -> np.ndarray:
    """Displacements (n, 3) [m] at rest. `advance` makes a step with loads and supports times a
    scale, which grows to 1 in `ramp` steps, and returns displacements; `stop` takes all velocity
    away. At rest the change in a step over the largest displacement is at most `change_at_rest`."""
    u, energy = np.zeros((len(masses), 3)), 0.0
    for step in range(1, steps + 1):
        new = advance(min(1.0, step / ramp))
        change, last, u = new - u, energy, new
        energy = (masses[:, None] * change**2).sum()
        if step > ramp and energy < last:
            stop()
            energy = 0.0
        if step > ramp and np.abs(change).max() <= change_at_rest * np.abs(u).max():
            return u
    raise Refused(f"no rest after {steps} steps", "not_converged")
