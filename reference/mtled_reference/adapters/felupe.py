"""Solves a job with FElupe: python -m mtled_reference.adapters.felupe JOB ANSWER

Static boxes of one neo-Hookean material without loads, by trilinear hexahedra, with three fields
where ν ≥ 0.45 and the law has an isochoric split.
"""

import felupe
import numpy as np
from scipy.interpolate import RegularGridInterpolator

try:
    from pypardiso import spsolve
except ImportError:
    from scipy.sparse.linalg import spsolve

from ..shared.case import Case
from ..shared.selection import selected
from .cases import counts, read
from .files import Refused, answer

LOAD_STEPS = (5, 20)
"""Numbers of load steps, tried in turn."""
RESIDUAL = 1e-6
"""Of Newton's method, over the forces [–]."""
NEARLY_INCOMPRESSIBLE = 0.45


def solve(job: dict) -> dict:
    """The answer to a job."""
    case = read(job)
    _refuse_others(case, job)
    low, high, numbers = counts(case, job["spacing_m"], 1)
    mesh = felupe.Cube(a=low, b=high, n=tuple(n + 1 for n in numbers))
    region = felupe.RegionHexahedron(mesh)
    for steps in LOAD_STEPS:
        field = felupe.FieldContainer([felupe.Field(region, dim=3)])
        solid, method = _solid(job["problem"]["regions"][0]["material"], field)
        try:
            return _solved(case, job, field, solid, steps) | {"method": method}
        except (felupe.NewtonConvergenceError, ValueError, FloatingPointError) as error:
            failure = error
    raise Refused(f"no convergence: {failure}", "not_converged")


def _refuse_others(case: Case, job: dict) -> None:
    """Refuses what is not solved here."""
    if case.dimension != 3 or "box" not in case.shape:
        raise Refused("bodies other than boxes")
    if not case.is_static:
        raise Refused("motion in time")
    if case.obstacles or case.body_forces or case.tractions:
        raise Refused("contact, body forces and tractions")
    if len(case.regions) > 1 or any(probe.positions is None for probe in case.probes):
        raise Refused("several regions, centres of mass")
    if any(p.rotation or p.formula for p in case.prescriptions):
        raise Refused("rotations and formulas")


def _solid(material: dict, field):
    """The body and what it is made of."""
    mu, bulk = material["shear_modulus_pa"], material["bulk_modulus_pa"]
    if material["law"] == "neo_hookean_log_j":
        law = felupe.NeoHookeCompressible(mu=mu, lmbda=material["lame_modulus_pa"])
        return felupe.SolidBody(law, field), "trilinear hexahedra"
    if material["strain_energy"] != "mu/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)^2":
        raise Refused(f"the law {material['law']}")
    if material["poisson_ratio"] < NEARLY_INCOMPRESSIBLE:
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


def _solved(case: Case, job: dict, field, solid, steps: int) -> dict:
    """Probes and reactions after load steps."""
    points = field.region.mesh.points
    full, fixed, owned = _supports(case, points)
    free = np.flatnonzero(~fixed.ravel())
    for step in range(1, steps + 1):
        felupe.newtonraphson(
            items=[solid],
            dof0=np.flatnonzero(fixed.ravel()),
            dof1=free,
            ext0=(step / steps * full)[fixed],
            solver=spsolve,
            tol=RESIDUAL,
            verbose=0,
        )
    u = field[0].values
    forces = solid.assemble.vector(field).toarray().reshape(-1, 3)
    return {
        "displacements_m": {p.name: [_at(p.positions, points, u)] for p in case.probes},
        "reactions_n": {n: [(mine * forces).sum(axis=0).tolist()] for n, mine in owned.items()},
        "unknowns": len(free),
    }


def _at(positions: np.ndarray, points: np.ndarray, u: np.ndarray) -> list:
    """Displacements at positions, trilinear between the points of the grid."""
    axes = [np.unique(points[:, k]) for k in range(3)]
    order = np.lexsort(points.T[::-1])
    values = u[order].reshape(*map(len, axes), 3)
    return RegularGridInterpolator(axes, values)(positions).tolist()


if __name__ == "__main__":
    answer("FElupe", lambda: felupe.__version__, solve)
