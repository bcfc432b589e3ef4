"""The run of a whole brain on one mesh and the values that are recorded, with either code."""

import numpy as np

from ..shared.case import Case
from ..shared.measurements import Measurements, resultant
from .contact import Wall
from .equilibrium import Balance
from .loads import body_forces
from .mesh import Tetrahedra, tetrahedra
from .probes import Interpolation

EDGES = (0.018, 0.0145, 0.0117)
"""Edges of the surface [m], by level."""
PENALTY = 1e7
"""Penalty ε of the contact [Pa/m]."""


def solved_mesh(case: Case, level: int, elements_of, progress) -> dict:
    """Instants [s] and what is stored of the mesh of a level; the solutions on coarser meshes
    are the starts. On the coarsest mesh, the largest change of the displacements with a third
    of the penalty is stored as `penalty_effect_m`."""
    start, iterations = None, 0
    for coarse in range(level + 1):
        mesh = tetrahedra(case, EDGES[coarse])
        elements = elements_of(case, mesh)
        wall = Wall(case, mesh, PENALTY)
        balance = balance_of(case, mesh, elements, wall, progress)
        if start is not None:
            start = elements.from_displacements(start(mesh.nodes))
        u = balance.solve(start)
        iterations += balance.iterations
        field = u[: mesh.nodes.size].reshape(-1, 3)
        start = Field(mesh, field)
    values = recorded(case, mesh, elements, wall, u, balance.loads)
    stored = {
        "size_m": EDGES[level],
        "elements": len(mesh.cells),
        "unknowns": int(u.size),
        "load_steps": balance.load_steps,
        "newton_iterations": iterations,
        "penalty_pa_per_m": PENALTY,
        "penetration_m": wall.penetration(u[: mesh.nodes.size]),
        "smallest_J": elements.smallest_J(u),
        "load_n": float(np.linalg.norm(balance.loads.reshape(-1, 3).sum(axis=0))),
        "region_volumes_m3": [float(f"{v:.6g}") for v in elements.node_volumes.sum(axis=1)],
    }
    if level == 0:
        wall.penalty = PENALTY / 3.0
        softer = recorded(case, mesh, elements, wall, balance.solve(u), balance.loads)
        stored["penalty_effect_m"] = largest_change(values, softer)
    solution = {
        "mesh_family": "tetrahedra by TetGen inside a relaxed surface net; midpoints of the surface "
        "on the level; edges halved along the ventricles and the tumour; same meshes for both codes",
        "solver": "Newton, residual 1e-8 of the forces; contact by penalty ε = 1e7 Pa/m at twelve "
        "points per facet",
    }
    return {
        "times_s": [case.time.load_end],
        "mesh": stored | {"values": values},
        "solution": solution,
    }


class Field:
    """Displacements of a mesh, to be interpolated at the nodes of another."""

    def __init__(self, mesh: Tetrahedra, field: np.ndarray):
        self.mesh, self.field = mesh, field

    def __call__(self, points: np.ndarray) -> np.ndarray:
        return Interpolation(self.mesh, points)(self.field)


def balance_of(case: Case, mesh: Tetrahedra, elements, wall: Wall, progress) -> Balance:
    """Loads and prescribed displacements at the end of loading."""
    end = case.time.load_end
    nodes = np.flatnonzero(mesh.constrained)
    values = np.zeros((0, 3))
    if case.prescriptions:
        (prescription,) = case.prescriptions
        values = prescription.values(mesh.nodes[nodes], prescription.amplitude(end))
    prescribed = (3 * nodes[:, None] + np.arange(3)).ravel()
    loads = body_forces(case, mesh)

    def report(iteration, entry):
        fraction, kappa, residual, penetration = entry
        message = f"{iteration}: load {fraction:g}, springs {kappa:g}, residual {residual:.1e}"
        progress(0.0, f"{message}, penetration {1e6 * penetration:.1f} um")

    return Balance(elements, wall, loads, prescribed, values.ravel(), report)


def recorded(case: Case, mesh: Tetrahedra, elements, wall: Wall, u, loads) -> dict:
    """The values of a solution by their keys in the reference file."""
    n = mesh.nodes.size
    field = u[:n].reshape(-1, 3)
    values = Measurements()
    names = [region.name for region in case.regions]
    for probe in case.probes:
        if probe.centre_of_mass is None:
            values.displacement(probe.name, Interpolation(mesh, probe.positions)(field))
            continue
        weights = elements.node_volumes[names.index(probe.centre_of_mass)]
        weights = weights / weights.sum()
        values.centre(probe.name, weights @ mesh.nodes)
        values.displacement(probe.name, weights @ field)
    for prescription in case.prescriptions:
        reaction = elements.force(u)[:n] - wall.force(u[:n]) - loads
        reaction = np.where(np.repeat(mesh.constrained, 3), reaction, 0.0).reshape(-1, 3)
        force, moment = resultant(mesh.nodes, field, reaction, case.moment_about)
        values.reaction(prescription.name, force, moment)
    values.contact(wall.name, wall.resultant(u[:n]))
    values.strain_energy(elements.energy(u))
    return values.values


def largest_change(values: dict, others: dict) -> float:
    """Largest distance [m] between the displacements of two solutions."""
    keys = [key for key in values if key.startswith("displacement/")]
    changes = [np.array(values[key]) - np.array(others[key]) for key in keys]
    return float(f"{max(np.linalg.norm(change, axis=1).max() for change in changes):.3g}")
