"""Motion by the implicit midpoint rule with the consistent mass.

The unknown is the displacement in the middle of a step, u_m = (u_n + u_{n+1})/2:
M [(4/Δt²)(u_m − u_n − Δt v_n/2) + c (2/Δt)(u_m − u_n)] + f_int(u_m) = f_ext(t_m)
with the damping c [1/s]; then u_{n+1} = 2u_m − u_n and v_{n+1} = 2v_m − v_n, where
v_m = 2(u_m − u_n)/Δt.
"""

import numpy as np

from ..shared.errors import NotConverged
from . import versions
from .newton import ITERATIONS

RESIDUAL = 1e-9
"""Largest norm of the residual at free unknowns over that of the acting forces [–].
Rounding errors of the stiff internal forces are not far below."""
SLOW = 0.15
"""The matrix is factorised again where an iteration leaves more of the residual [–]."""


class Midpoint:
    """Steps of the midpoint rule; a factorisation is kept while Newton converges fast."""

    def __init__(self, model, conditions, newton, time_step: float):
        if model.three_fields:
            raise ValueError("motion with three fields is not supported")
        self.model, self.conditions, self.newton, self.dt = model, conditions, newton, time_step
        self.mass = versions.new_matrix(model.mass_form)
        versions.assemble_matrix(self.mass, model.mass_form)
        self.velocity = np.zeros(len(model.unknown.x.array))
        self.damping = model.case.time.damping
        self.factorised = False

    def _times_mass(self, values: np.ndarray) -> np.ndarray:
        vector, product = self.mass.createVecRight(), self.mass.createVecLeft()
        vector.array[:] = values
        self.mass.mult(vector, product)
        result = product.array.copy()
        vector.destroy()
        product.destroy()
        return result

    def kinetic_energy(self) -> float:
        """vᵀ M v / 2 [J] of the meshed part."""
        return 0.5 * float(self.velocity @ self._times_mass(self.velocity))

    def step(self, t: float) -> np.ndarray:
        """Steps from t to t + Δt; returns the reactions (nodes, components) [N] at the middle."""
        unknown, dt = self.model.unknown.x.array, self.dt
        start = unknown.copy()
        middle = t + 0.5 * dt
        fixed, before = self.conditions.prescribed(t)
        _, after = self.conditions.prescribed(t + dt)
        load = self.newton.load(self.conditions.external_forces(middle))
        unknown += 0.5 * dt * self.velocity
        unknown[fixed] = 0.5 * (before + after)
        reactions = self._balance(start, fixed, load)
        rate = 2.0 * (unknown - start) / dt
        unknown[:] = 2.0 * unknown - start
        self.velocity = 2.0 * rate - self.velocity
        return reactions[self.model.fields]

    def _residual(self, start: np.ndarray, load: np.ndarray) -> np.ndarray:
        moved = self.model.unknown.x.array - start
        inertia = (4.0 / self.dt**2) * (moved - 0.5 * self.dt * self.velocity)
        inertia += self.damping * (2.0 / self.dt) * moved
        return self.newton.internal_forces() + self._times_mass(inertia) - load

    def _balance(self, start, fixed, load) -> np.ndarray:
        """Newton's method; returns the residual, which is the reaction where prescribed."""
        newton, unknown = self.newton, self.model.unknown.x.array
        error = np.inf
        for _ in range(ITERATIONS):
            residual = self._residual(start, load)
            if not np.all(np.isfinite(residual)):
                raise NotConverged("the residual is not finite")
            reactions = residual.copy()
            residual[fixed] = 0.0
            previous, error = error, np.linalg.norm(residual)
            scale = max(np.linalg.norm(load), np.linalg.norm(reactions[fixed]))
            if error <= RESIDUAL * scale:
                return reactions
            if not self.factorised or (np.isfinite(previous) and error > SLOW * previous):
                self._factorise(fixed)
            newton.rhs.array[:] = -residual
            newton.solver.solve(newton.rhs, newton.step)
            unknown += newton.step.array
            newton.iterations += 1
        raise NotConverged(f"residual {error:.1e} of {scale:.1e} after {ITERATIONS} iterations")

    def _factorise(self, fixed) -> None:
        newton = self.newton
        versions.assemble_matrix(newton.matrix, self.model.jacobian_form)
        factor = 4.0 / self.dt**2 + 2.0 * self.damping / self.dt
        newton.matrix.axpy(factor, self.mass)
        newton.matrix.zeroRowsColumns(fixed, 1.0)
        newton.solver.setUp()
        self.factorised = True


def solve_dynamic(midpoint, recorder, times: list[float], progress) -> int:
    """Integrates to the end of `times` [s] and records at each; returns the number of steps.

    The reaction at an instant is the mean of those half a step before and after.
    """
    dt = midpoint.dt
    every = round(times[0] / dt)
    if abs(every * dt - times[0]) > 1e-9 * dt:
        raise ValueError("the recorded instants are not multiples of the time step")
    steps = every * len(times)
    before = midpoint.step(0.0)
    model = midpoint.model
    for n in range(1, steps + 1):
        state = model.unknown.x.array.copy(), midpoint.kinetic_energy()
        after = midpoint.step(n * dt)
        if n % every == 0:
            next_state = model.unknown.x.array.copy()
            model.unknown.x.array[:] = state[0]
            recorder.record(n * dt, 0.5 * (before + after), state[1])
            model.unknown.x.array[:] = next_state
            progress(n / steps, f"time {n * dt:.3g} s of {times[-1]:.3g} s")
        before = after
    return steps
