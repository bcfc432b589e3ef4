"""Which mesh a job gets: an even one of the wanted spacing, or one of those of the references."""

import numpy as np

from .. import LEVELS
from ..shared.case import Case, case_of
from ..shared.selection import bounding_box, radii_of_quarter_ring, selected
from .files import Refused

EVEN = {"all", "plane", "half_space", "box"}
"""Selections whose borders an even mesh of a box can follow."""
OF_MATERIALS = ("fibres", "sheets", "active_stress", "prony")
"""Keys of materials that no adapter of this folder solves."""
COMPOSED = ("union", "intersection")
"""Selections that others make up."""


def read(job: dict, pressures_on_rings: bool = False) -> Case:
    """The case of a job; refuses what no adapter of this folder solves, and pressures that follow
    the surface, on a quarter of a ring at rest only if the adapter does not solve them there."""
    problem = job["problem"]
    for material in problem["material"].values():
        for key in OF_MATERIALS:
            if key in material:
                raise Refused(f"materials with {key}")
    try:
        case = case_of(problem, job["case"])
    except ValueError as error:
        raise Refused(str(error)) from None
    if case.pressures and not (pressures_on_rings and case.is_static and _is_ring(case)):
        raise Refused("pressures")
    return case


def read_without_contact(job: dict) -> Case:
    """The case of a job; refuses also contact, supports that are released, body forces on parts
    and selections that are not known."""
    case = read(job)
    if case.obstacles:
        raise Refused("contact")
    if any(region.material.law == "linear_elastic" for region in case.regions):
        raise Refused("the law linear_elastic")
    if any(np.isfinite(row.release) for row in case.prescriptions):
        raise Refused("supports that are released")
    if any(force.selector != "all" for force in case.body_forces):
        raise Refused("body forces on a part of the body")
    for row in (*case.prescriptions, *case.regions, *case.tractions):
        try:
            selected(row.selector, np.zeros((1, 3)), 0.0)
        except ValueError as error:
            raise Refused(str(error)) from None
    return case


def is_even(case: Case) -> bool:
    """Whether the case is the equilibrium of a box whose selections are parallel to it."""
    selectors = [p.selector for p in case.prescriptions] + [r.selector for r in case.regions]
    selectors += [traction.selector for traction in case.tractions]
    kinds = {kind for selector in selectors for kind in _kinds(selector)}
    on_all = all(force.selector == "all" for force in case.body_forces)
    is_box = case.dimension == 3 and "box" in case.shape
    return case.is_static and is_box and on_all and kinds <= EVEN


def _kinds(selector) -> set[str]:
    """The kinds of selections that a selection is made of."""
    if isinstance(selector, str):
        return {selector}
    kind, content = next(iter(selector.items()))
    return set().union(*map(_kinds, content)) if kind in COMPOSED else {kind}


def counts(case: Case, spacing: float, degree: int) -> tuple[np.ndarray, np.ndarray, list[int]]:
    """Lowest and highest corner of a box [m] and numbers of elements of a degree along its axes
    whose nodes have the wanted spacing [m]."""
    low, high = bounding_box(case.shape)
    return low, high, [max(1, round(length / (degree * spacing))) for length in high - low]


def counts_of_ring(case: Case, spacing: float, degree: int) -> tuple:
    """Inner and outer radius [m] of a quarter of a ring in plane strain, and numbers of elements of a
    degree across it and around whose nodes have the wanted spacing [m]."""
    if not (case.is_static and _is_ring(case)):
        raise Refused("bodies without an even mesh")
    radii = radii_of_quarter_ring(case.shape)
    lengths = radii[1] - radii[0], 0.25 * np.pi * (radii[0] + radii[1])
    return radii, tuple(max(1, round(length / (degree * spacing))) for length in lengths)


def _is_ring(case: Case) -> bool:
    """Whether the body is a quarter of a ring in plane strain."""
    return case.dimension == 2 and radii_of_quarter_ring(case.shape) is not None


def reference_level(job: dict) -> int:
    """The mesh of the stored reference for a job, from 0, the coarsest."""
    if job["level"] not in LEVELS:
        raise Refused("there are three meshes of this case", "resolution")
    return job["level"]
