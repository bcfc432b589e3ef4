"""Solves a job with FElupe: python -m mtled_reference.adapters.felupe JOB ANSWER

Static boxes of one neo-Hookean material under dead tractions at most, by trilinear hexahedra, with three fields
where ν ≥ 0.45 and the law has an isochoric split. With --element such a box is solved as in a race:
trilinear hexahedra Q1, with three fields Q1/P0.
"""

from dataclasses import dataclass

import felupe
import numpy as np
from scipy.interpolate import RegularGridInterpolator

try:
    from pypardiso import spsolve
except ImportError:
    from scipy.sparse.linalg import spsolve

from ..shared.case import Case
from ..shared.materials import Material
from ..shared.selection import selected
from .cases import counts, is_even, read
from .files import Quick, Refused, answer

LOAD_STEPS = (5, 20)
"""Numbers of load steps, tried in turn."""
RESIDUAL = 1e-6
"""Of Newton's method, over the forces [–]."""
THREE_FIELDS = {"Q1": False, "Q1/P0": True}
"""Whether p and θ are fields of an element."""
FACES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
"""Corners of the faces of a hexahedron."""
FAILURES = (felupe.NewtonConvergenceError, ValueError, FloatingPointError)


def solve(job: dict, element: str | None) -> dict:
    """The answer to a job."""
    case = read(job)
    _refuse_others(case, job)
    material = case.regions[0].material
    if element is not None:
        quick = Quick(FAILURES)
        three_fields = THREE_FIELDS[element]
        body = quick.solved(
            lambda parts: _equilibrium(case, job, material, three_fields, parts, quick.RESIDUAL)
        )
        return _answered(case, body) | {"apart_cpu_s": quick.apart_s()}
    three_fields = (
        material.law != "neo_hookean_log_j" and material.is_nearly_incompressible
    )
    for steps in LOAD_STEPS:
        try:
            body = _equilibrium(case, job, material, three_fields, steps, RESIDUAL)
            return _answered(case, body)
        except FAILURES as error:
            failure = error
    raise Refused(f"no convergence: {failure}", "not_converged")


def _refuse_others(case: Case, job: dict) -> None:
    """Refuses what is not solved here."""
    if case.dimension != 3 or "box" not in case.shape:
        raise Refused("bodies other than boxes")
    if not case.is_static:
        raise Refused("motion in time")
    if case.obstacles or case.body_forces:
        raise Refused("contact and body forces")
    if case.tractions and not is_even(case):
        raise Refused("tractions on parts that no even mesh follows")
    if len(case.regions) > 1 or any(probe.positions is None for probe in case.probes):
        raise Refused("several regions, centres of mass")
    if any(p.rotation for p in case.prescriptions):
        raise Refused("rotations")


def _solid(material: Material, three_fields: bool, field):
    """The body and what it is made of."""
    mu, bulk = material.shear_modulus, material.bulk_modulus
    if material.law == "neo_hookean_log_j" and not three_fields:
        law = felupe.NeoHookeCompressible(mu=mu, lmbda=material.lame_modulus)
        return felupe.SolidBody(law, field), "trilinear hexahedra"
    if not material.is_quadratic_isochoric:
        raise Refused(f"the law {material.law}")
    if not three_fields:
        return felupe.SolidBody(felupe.NeoHooke(mu=mu, bulk=bulk), field), "trilinear hexahedra"
    solid = felupe.SolidBodyNearlyIncompressible(felupe.NeoHooke(mu=mu), field, bulk=bulk)
    return solid, "trilinear hexahedra Q1/P0, three fields"


def _supports(case: Case, points: np.ndarray):
    """Prescribed displacements at the end (n, 3) [m], where they are, and those of each
    support; where two prescribe a component the first counts."""
    tolerance = 1e-6 * np.ptp(points, axis=0).max()
    outside = (points == points.min(axis=0)) | (points == points.max(axis=0))
    full, fixed, owned = np.zeros_like(points), np.zeros(points.shape, dtype=bool), {}
    for row in case.prescriptions:
        nodes = selected(row.selector, points, tolerance)
        if row.of == "surface":
            nodes &= outside.any(axis=1)
        components = np.isin(np.arange(3), row.components(3))
        mine = nodes[:, None] & components & ~fixed
        values = row.values(points, row.amplitude(case.time.load_end))
        full[mine], fixed = values[mine], fixed | mine
        owned[row.name] = mine
    return full, fixed, owned


@dataclass(frozen=True)
class Body:
    """A body in equilibrium, and which components of which nodes are held by whom."""

    field: felupe.FieldContainer
    solid: object
    method: str
    free: np.ndarray
    owned: dict


def _equilibrium(
    case: Case, job: dict, material: Material, three_fields: bool, steps: int, residual: float
) -> Body:
    """The body after load steps."""
    low, high, numbers = counts(case, job["spacing_m"], 1)
    mesh = felupe.Cube(a=low, b=high, n=tuple(n + 1 for n in numbers))
    field = felupe.FieldContainer([felupe.Field(felupe.RegionHexahedron(mesh), dim=3)])
    solid, method = _solid(material, three_fields, field)
    full, fixed, owned = _supports(case, mesh.points)
    free = np.flatnonzero(~fixed.ravel())
    loads = _loads(case, mesh)
    loaded = np.flatnonzero(np.any(loads != 0.0, axis=1))
    load = felupe.PointLoad(field, loaded, loads[loaded])
    for step in range(1, steps + 1):
        load.update(step / steps * loads[loaded])
        felupe.newtonraphson(
            items=[solid, load] if len(loaded) else [solid],
            dof0=np.flatnonzero(fixed.ravel()),
            dof1=free,
            ext0=(step / steps * full)[fixed],
            solver=spsolve,
            tol=residual,
            verbose=0,
        )
    return Body(field, solid, method, free, owned)


def _answered(case: Case, body: Body) -> dict:
    """Probes and reactions."""
    u, points = body.field[0].values, body.field.region.mesh.points
    forces = body.solid.assemble.vector(body.field).toarray().reshape(-1, 3)
    reactions = {n: [(mine * forces).sum(axis=0).tolist()] for n, mine in body.owned.items()}
    return {
        "displacements_m": {p.name: [_at(p.positions, points, u)] for p in case.probes},
        "reactions_n": reactions,
        "unknowns": len(body.free),
        "method": body.method,
    }


def _loads(case: Case, mesh: felupe.Mesh) -> np.ndarray:
    """Nodal forces (n, 3) [N] of dead tractions at the end: a corner of a rectangle gets a quarter of
    its force."""
    points, forces = mesh.points, np.zeros_like(mesh.points)
    facets = np.concatenate([mesh.cells[:, face] for face in FACES])
    _, first, times = np.unique(np.sort(facets), axis=0, return_index=True, return_counts=True)
    outside = facets[first[times == 1]]
    for row in case.tractions:
        inside = selected(row.selector, points, 1e-6 * np.ptp(points, axis=0).max())
        loaded = outside[inside[outside].all(axis=1)]
        a, b, _, d = points[loaded].swapaxes(0, 1)
        areas = np.linalg.norm(np.cross(b - a, d - a), axis=1)
        force = np.array(row.traction) * row.amplitude(case.time.load_end)
        np.add.at(forces, loaded, 0.25 * areas[:, None, None] * force)
    return forces


def _at(positions: np.ndarray, points: np.ndarray, u: np.ndarray) -> list:
    """Displacements at positions, trilinear between the points of the grid."""
    axes = [np.unique(points[:, k]) for k in range(3)]
    order = np.lexsort(points.T[::-1])
    values = u[order].reshape(*map(len, axes), 3)
    return RegularGridInterpolator(axes, values)(positions).tolist()


if __name__ == "__main__":
    answer("FElupe", lambda: felupe.__version__, solve, tuple(THREE_FIELDS))
