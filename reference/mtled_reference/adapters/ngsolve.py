"""Solves a job with NGSolve: python -m mtled_reference.adapters.ngsolve JOB ANSWER

NGSolve 6.2.2608, pip install ngsolve; its mesh generator Netgen comes along. Boxes get even
hexahedra, other bodies tetrahedra with edges of twice the spacing, curved at the surface, in
plane strain triangles. Displacements are of order 2; where ν ≥ 0.45 there are three fields, p
and θ of order 1 and continuous (Taylor and Hood, Comput. Fluids 1, 73, 1973). Motion in time is
by the trapezoidal rule. Refused are contact, supports of the volume, formulas, regions of
different laws, and motion of nearly incompressible tissue.
"""

import ngsolve as ngs
import numpy as np

from ..shared.measurements import in_space
from .cases import read_without_contact
from .files import Refused, answer
from .ngsolve_model import DIRECT, Model, NoConvergence

FIRST_STEP, SHORTEST_STEP = 0.25, 1.0 / 256.0
"""Of the loads [–]; a step that fails is halved."""
STEPS_PER_INSTANT = 2
"""In time at the coarsest level; twice as many two levels further."""


class Recorder:
    """What an answer has, from the model at the instants of a job."""

    def __init__(self, model: Model):
        self.model, self.case = model, model.case
        self.content = {"displacements_m": {}, "reactions_n": {}, "strain_energy_j": []}
        self.points = {
            probe.name: [self._point(p) for p in probe.positions]
            for probe in self.case.probes
            if probe.positions is not None
        }

    def _point(self, position: np.ndarray):
        """The place of a position in the mesh; curved facets may leave it out by little."""
        middle = self.model.mesh.ngmesh.Coordinates().mean(axis=0)
        position = position[: len(middle)]
        for shift in (0.0, 1e-9, 1e-6, 1e-4, 1e-3):
            point = self.model.mesh(*(position + shift * (middle - position)))
            if point.nr >= 0:
                return point
        raise Refused("a probe outside the mesh", "resolution")

    def record(self, residual: np.ndarray) -> None:
        """Adds an instant."""
        model, content = self.model, self.content
        for probe in self.case.probes:
            if probe.positions is None:
                rows = [self._mean(probe.centre_of_mass)]
            else:
                rows = [model.motion(point) for point in self.points[probe.name]]
            rows = in_space(np.array(rows)).tolist()
            content["displacements_m"].setdefault(probe.name, []).append(rows)
        for row, _, mine in model.supports:
            force = model.reaction(mine, residual)
            content["reactions_n"].setdefault(row.name, []).append(force)
        content["strain_energy_j"].append(float(model.stiffness.Energy(model.u.vec)))

    def _mean(self, name: str) -> np.ndarray:
        """Displacement of the centre of mass of a region, of all of them for `body`."""
        regions = self.case.regions
        names = [region.name for region in regions]
        if name not in names and name != "body":
            raise Refused(f"no region {name}")
        inside = [float(name not in names or other == name) for other in names]
        density = self.model.density * self.model.by_cell(inside)
        mass = ngs.Integrate(density, self.model.mesh)
        return np.array(ngs.Integrate(density * self.model.motion, self.model.mesh)) / mass


def solve(job: dict) -> dict:
    """The answer to a job."""
    case = read_without_contact(job)
    # Idle threads of NGSolve wait actively.
    ngs.SetNumThreads(job["threads"])
    model = Model(case, job)
    recorder = Recorder(model)
    try:
        (_static if case.is_static else _dynamic)(model, recorder, job)
    except NoConvergence:
        raise Refused("Newton's method does not end", "not_converged") from None
    unknowns = int(model.free.sum())
    method = f"{model.element}, {DIRECT[model.mixed]}"
    return recorder.content | {"unknowns": unknowns, "method": method}


def _static(model: Model, recorder: Recorder, job: dict) -> None:
    end, done, step = model.case.time.load_end, 0.0, FIRST_STEP
    while done < 1.0:
        now, before = min(1.0, done + step), model.u.vec.FV().NumPy().copy()
        try:
            residual = model.newton(model.load(end, now), model.prescribed(end, now))
            done = now
        except NoConvergence:
            step /= 2.0
            model.u.vec.FV().NumPy()[:] = before
            if step < SHORTEST_STEP:
                raise
    recorder.record(residual)


def _dynamic(model: Model, recorder: Recorder, job: dict) -> None:
    """Newmark's method with β = 1/4, γ = 1/2 from rest."""
    if model.mixed:
        raise Refused("motion of nearly incompressible tissue")
    model.mass.Assemble()
    instants, substeps = job["instants_s"], round(STEPS_PER_INSTANT * 2 ** (job["level"] / 2))
    x, free = model.u.vec.FV().NumPy(), ngs.BitArray(list(model.free))
    velocity, damping, t = np.zeros_like(x), model.case.time.damping, 0.0
    right = model.u.vec.CreateVector()
    right.FV().NumPy()[:] = model.load(0.0, 1.0) - model.forces()
    result = (model.mass.mat.Inverse(free, DIRECT[False]) * right).Evaluate()
    acceleration = result.FV().NumPy().copy()
    for instant in instants:
        dt = (instant - t) / substeps
        for _ in range(substeps):
            t += dt
            # a + c v at the end = inertia (u - predictor).
            last, inertia = x.copy(), 4.0 / dt**2 + 2.0 * damping / dt
            pull = (4.0 / dt + damping) * velocity + acceleration
            predictor = last + pull / inertia
            residual = model.newton(
                model.load(t, 1.0), model.prescribed(t, 1.0), (inertia, predictor)
            )
            moved = 2.0 / dt * (x - last) - velocity
            acceleration = 2.0 / dt * (moved - velocity) - acceleration
            velocity = moved
        recorder.record(residual)


if __name__ == "__main__":
    answer("NGSolve", lambda: ngs.__version__, solve)
