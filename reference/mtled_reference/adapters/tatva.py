"""Solves a job with tatva: python -m mtled_reference.adapters.tatva JOB ANSWER

tatva 0.11.6 on JAX 0.10.2, pip install tatva; meshes of bodies other than boxes need pip install
netgen-mesher. Equilibria in 3-D of all laws of the bundled cases: tatva differentiates the strain
energy. Boxes get even trilinear hexahedra (Hexahedron8); where ν ≥ 0.45 the volume ratio is
replaced by its mean over the element (Simo, Taylor and Pister, Comput. Methods Appl. Mech. Eng. 51,
177, 1985). Other bodies get linear tetrahedra (Tetrahedron4), the only ones that tatva has in
3-D; they lock near ν = 0.5, so that nearly incompressible tissue is refused there. Linear systems
are solved by SuperLU of SciPy.
"""

import os
from dataclasses import replace
from functools import partial
from importlib.metadata import version

import jax
import jax.numpy as jnp
import numpy as np
from scipy.sparse.linalg import splu
from tatva import Mesh, Operator, element, lifter, sparse

from ..shared.materials import strain_energy, three_field_energy
from . import elements
from .cases import read_without_contact
from .files import Refused, answer
from .nodal import Nodal

ONE_THREAD = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
RESIDUAL = 1e-8
"""Of Newton's method, over the forces [–]."""
ITERATIONS = 12
FIRST_STEP, SHORTEST_STEP = 0.25, 1.0 / 256.0
"""Of the loads [–]; a step that fails is halved."""
TYPES = {
    id(elements.HEXAHEDRON_8): element.Hexahedron8,
    id(elements.TETRAHEDRON_4): element.Tetrahedron4,
}


class NoConvergence(Exception):
    """Newton's method did not end."""


def solve(job: dict) -> dict:
    """The answer to a job."""
    if job["threads"] == 1:
        os.environ.setdefault("XLA_FLAGS", ONE_THREAD)
    jax.config.update("jax_enable_x64", True)
    case = read_without_contact(job)
    if not case.is_static:
        raise Refused("motion in time")
    if len({(r.material.law, r.material.volumetric) for r in case.regions}) > 1:
        raise Refused("regions of different laws")
    model = Nodal(case, job["spacing_m"], 1)
    mixed = any(region.material.is_nearly_incompressible for region in case.regions)
    if mixed and model.element.simplex:
        raise Refused("nearly incompressible tissue in tetrahedra of 4 nodes")
    kind = TYPES[id(model.element)]
    mesh = Mesh(jnp.array(model.points), jnp.array(model.cells))
    energy = _energy(model, Operator(mesh, kind()), mixed)
    try:
        u, forces = _equilibrium(model, mesh, energy)
    except NoConvergence:
        raise Refused("Newton's method does not end", "not_converged") from None
    end = case.time.load_end
    content = model.answer([(u, forces - model.loads(end))])
    method = f"{kind.__name__}{', mean volume ratio' if mixed else ''}, SuperLU"
    return content | {"strain_energy_j": [float(energy(u.ravel()))], "method": method}


def _energy(model: Nodal, operator: Operator, mixed: bool):
    """The strain energy [J] as a function of displacements in one row."""
    rows = [region.material for region in model.case.regions]

    def by_cell(values):
        return jnp.array(values)[model.owners][:, None]

    material = replace(
        rows[0],
        shear_modulus=by_cell([row.shear_modulus for row in rows]),
        bulk_modulus=by_cell([row.bulk_modulus for row in rows]),
        rubber=tuple(by_cell([row.rubber[i] for row in rows]) for i in range(4)),
    )

    @jax.jit
    def energy(u):
        F = jnp.eye(3) + operator.grad(u.reshape(-1, 3))
        C = jnp.swapaxes(F, -1, -2) @ F
        first, J = jnp.trace(C, axis1=-2, axis2=-1), jnp.linalg.det(F)
        second = 0.5 * (first**2 - (C**2).sum(axis=(-2, -1)))
        if not mixed:
            return operator.integrate(strain_energy(material, first, second, J, jnp.log))
        volumes = operator.integrate_per_element(jnp.ones_like(J))
        theta = (operator.integrate_per_element(J) / volumes)[:, None]
        return operator.integrate(three_field_energy(material, first, second, J, theta, jnp.log))

    return energy


def _equilibrium(model: Nodal, mesh: Mesh, energy):
    """Displacements and internal forces (n, 3) at the end of loading."""
    end, fixed = model.case.time.load_end, np.flatnonzero(model.fixed)
    held = lifter.Lifter(
        model.points.size, lifter.Fixed(jnp.array(fixed), lifter.RuntimeValue("u"))
    )
    gradient = jax.jit(jax.grad(energy))
    reduced = lifter.lifted(gradient, output="dual")
    pattern = held.reduce_sparsity(sparse.pattern_from_mesh(mesh, 3))
    matrix = sparse.ColoredMatrix.from_csr(pattern)
    tangent = sparse.jacfwd(lambda x, values: reduced(held.at["u"].set(values), x), matrix)
    loads, free = model.loads(end).ravel(), ~model.fixed.ravel()
    x, values, done, step = np.zeros(free.sum()), np.zeros(len(fixed)), 0.0, FIRST_STEP
    while done < 1.0:
        now = min(1.0, done + step)
        try:
            after = model.prescribed(end, now).ravel()[fixed]
            x = _newton(gradient, tangent, (free, x, values, after), now * loads)
            values, done = after, now
        except NoConvergence:
            step /= 2.0
            if step < SHORTEST_STEP:
                raise
    u = _full(free, x, values)
    return u.reshape(-1, 3), np.array(gradient(u)).reshape(-1, 3)


def _full(free: np.ndarray, x: np.ndarray, values: np.ndarray) -> np.ndarray:
    u = np.empty(len(free))
    u[free], u[~free] = x, values
    return u


@partial(jax.jit, static_argnums=0)
def _carried(gradient, u, move):
    """Change of the forces [N] by a small motion."""
    return jax.jvp(gradient, (u,), (move,))[1]


def _newton(gradient, tangent, state: tuple, loads: np.ndarray) -> np.ndarray:
    """The free unknowns when the prescribed ones go from `before` to `after`. The first iteration
    carries the body along linearly."""
    free, x, before, after = state
    u = _full(free, x, before)
    move = _full(free, np.zeros_like(x), after - before)
    for _ in range(ITERATIONS):
        forces = np.array(gradient(u))
        residual = (forces - loads)[free]
        if not np.isfinite(residual).all():
            break
        size = max(np.linalg.norm(forces), np.linalg.norm(loads))
        if not move.any() and np.linalg.norm(residual) <= RESIDUAL * size:
            return u[free]
        if move.any():
            residual = residual + np.array(_carried(gradient, u, move))[free]
        K = tangent(jnp.array(u[free]), jnp.array(u[~free])).to_csr()
        u = u + move
        u[free] -= splu(K.tocsc()).solve(residual)
        move[:] = 0.0
    raise NoConvergence


if __name__ == "__main__":
    answer("tatva", lambda: version("tatva"), solve)
