"""Solves a job with Newton: python -m mtled_reference.adapters.simulators.newton JOB ANSWER

Newton 1.8.0 on Warp 1.19.0, pip install newton, on the processor; meshes of bodies other than boxes
need pip install netgen-mesher. Equilibria in 3-D, in the idiom of the simulator: particles at the
nodes of linear tetrahedra, six in each cell of an even grid in boxes, moved by SolverVBD (Chen et
al., ACM Trans. Graph. 43, 116, 2024) in single precision. Supports are particles without mass; one
that prescribes some of the components cannot be stated. Loads are forces on particles.

The material is Newton's only one for solids, the stable neo-Hookean energy (Smith, De Goes and
Kim, ACM Trans. Graph. 37, 12, 2018) with the Lamé moduli of the job at small strain. A body at rest
is found as in `rest.py`. The first run of all compiles kernels for ten seconds.
"""

import newton
import numpy as np
import warp as wp

from ..cases import read_without_contact
from ..files import Refused, answer
from ..nodal import Nodal
from .rest import at_rest

STEPS_PER_WAVE = 32
"""Steps in the time of a shear wave through the body."""
RAMP = 2 * STEPS_PER_WAVE
"""Steps in which loads and supports grow."""
ITERATIONS = 20
"""Of the solver in a step."""
STEPS = 2000
AT_REST = 2e-6
"""Change of the displacements in a step, over the largest one [–]: about what single precision
can tell."""


def solve(job: dict) -> dict:
    """The answer to a job."""
    wp.config.quiet = True
    wp.init()
    case = read_without_contact(job)
    if not case.is_static:
        raise Refused("motion in time")
    model = Nodal(case, job["spacing_m"], 1, simplices=True)
    held = model.fixed.all(axis=1)
    if (model.fixed.any(axis=1) & ~held).any():
        raise Refused("supports that leave components free")
    with wp.ScopedDevice("cpu"):
        u = _rest(model, job, held)
    content = model.answer([(u, None)])
    del content["reactions_n"]
    return content | {"method": "SolverVBD, linear tetrahedra, single precision"}


def _builder(model: Nodal, held: np.ndarray):
    """Particles and tetrahedra."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    materials = [region.material for region in model.case.regions]
    builder.add_soft_mesh(
        pos=wp.vec3(),
        rot=wp.quat_identity(),
        scale=1.0,
        vel=wp.vec3(),
        vertices=[wp.vec3(*point) for point in model.points],
        indices=model.cells.ravel().tolist(),
        density=0.0,
        k_mu=np.array([m.shear_modulus for m in materials])[model.owners],
        k_lambda=np.array([m.lame_modulus for m in materials])[model.owners],
        k_damp=0.0,
        add_surface_mesh_edges=False,
    )
    builder.particle_mass = np.where(held, 0.0, model.masses()).tolist()
    builder.color()
    return builder


def _rest(model: Nodal, job: dict, held: np.ndarray) -> np.ndarray:
    """Displacements (n, 3) [m] at rest."""
    end, material = model.case.time.load_end, model.case.regions[0].material
    wave = np.ptp(model.points, axis=0).max() / np.sqrt(material.shear_modulus / material.density)
    body = _builder(model, held).finalize()
    solver = newton.solvers.SolverVBD(
        model=body, iterations=ITERATIONS, particle_enable_self_contact=False
    )
    before, after, control = body.state(), body.state(), body.control()
    loads, u = model.loads(end), np.zeros_like(model.points)

    def advance(scale: float) -> np.ndarray:
        nonlocal before, after, u
        start = u.copy()
        start[held] = model.prescribed(end, scale)[held]
        before.particle_q.assign((model.points + start).astype(np.float32))
        before.particle_f.assign((scale * loads).astype(np.float32))
        solver.step(before, after, control, None, wave / STEPS_PER_WAVE)
        before, after = after, before
        u = before.particle_q.numpy() - model.points
        if not np.isfinite(u).all():
            raise Refused("positions that are not finite", "not_converged")
        return u

    def stop() -> None:
        before.particle_qd.zero_()

    return at_rest(advance, stop, model.masses(), RAMP, STEPS, AT_REST)


if __name__ == "__main__":
    answer("Newton", lambda: newton.__version__, solve)
