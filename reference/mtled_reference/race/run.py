"""What a run of the race returns, and the clock that times it.

The module of each code has `run(problem, element, cells, steps, clock)`, which returns a
`Run` and stops the clock when the displacements are known.
"""

import time
from dataclasses import dataclass

import numpy as np

from ..shared.resources import processor_time

RESIDUAL = 1e-4
"""Largest norm of the residual over that of the acting forces [–]: a hundredth of the
differences between the discretisations."""


@dataclass(frozen=True)
class Run:
    """Displacements (n, 3) [m] at the lattice, with version, solver and counts."""

    version: str
    solver: str
    unknowns: int
    elements: int
    newton_iterations: int
    displacement: np.ndarray


class Clock:
    """Processor time of this process and its children [s], less the time `apart`."""

    def __init__(self):
        self.apart = 0.0
        self.begin = processor_time()
        self.wall = time.monotonic()
        self.cpu_s = self.wall_s = None

    def stop(self) -> None:
        """Ends the measurement."""
        self.cpu_s = processor_time() - self.begin - self.apart
        self.wall_s = time.monotonic() - self.wall
