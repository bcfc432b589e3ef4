"""The run of a whole brain on one mesh and the values that are recorded, with either code."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..shared.case import Case
from ..shared.measurements import Measurements, resultant
from .contact import Wall
from .equilibrium import Balance
from .image import read_label_map
from .loads import body_forces
from .mesh import Tetrahedra, tetrahedra
from .probes import Interpolation

EDGES = (0.022, 0.0175, 0.014)
"""Edges of the surface [m], by level."""
PENALTY = 3e7
"""Parameter ε of the contact [Pa/m]."""
METHOD = {
    "mesh_family": "tetrahedra by TetGen inside a relaxed surface net; midpoints of the surface "
    "on the level; edges halved along the ventricles and the tumour; same meshes for both codes",
    "solver": "Newton, residual 1e-6 of the forces; contact by augmented Lagrangian, ε = 3e7 Pa/m and "
    "two augmentations, at twelve points per facet",
}


@dataclass
class Solved:
    """The unknowns `u` in equilibrium on the mesh of a level, and the Newton iterations on it
    and on coarser meshes."""

    level: int
    mesh: Tetrahedra
    elements: object
    balance: Balance
    u: np.ndarray
    iterations: int

    def smooth_displacements(self, points: np.ndarray) -> np.ndarray:
        """Displacements (n, 3) [m] at points (n, 3) [m] by the cubic polynomial nearest to
        those of all nodes: smooth enough to invert no cell of another mesh."""
        field = self.u[: self.mesh.nodes.size].reshape(-1, 3)
        fit = np.linalg.lstsq(_cubics(self.mesh.nodes), field, rcond=None)[0]
        return _cubics(points) @ fit


def _cubics(points: np.ndarray) -> np.ndarray:
    """Products (n, 20) of at most three coordinates in units of 0.1 m."""
    powers = [(a, b, c) for a, b, c in np.ndindex(4, 4, 4) if a + b + c <= 3]
    return np.stack([np.prod((10.0 * points) ** power, axis=1) for power in powers], axis=1)


def solutions(case: Case, level: int, elements_of, progress, first=0) -> Iterator[Solved]:
    """The solutions from a first mesh to that of a level. Without prescribed displacements,
    which hold the body, each starts from the one before."""
    last = None
    for coarse in range(first, level + 1):
        mesh = tetrahedra(case, EDGES[coarse])
        elements = elements_of(case, mesh)
        balance = balance_of(case, mesh, elements, Wall(case, mesh, PENALTY), progress)
        start = None
        if last is not None and not case.prescriptions:
            start = elements.from_displacements(last.smooth_displacements(mesh.nodes))
        u = balance.solve(start)
        before = last.iterations if last else 0
        last = Solved(coarse, mesh, elements, balance, u, before + balance.iterations)
        yield last


def solved_mesh(case: Case, level: int, elements_of, progress) -> dict:
    """Instants [s] and what is stored of the mesh of a level, with the solution method."""
    first = level if case.prescriptions else 0
    *_, last = solutions(case, level, elements_of, progress, first)
    return result_of(case, last)


def result_of(case: Case, solved: Solved) -> dict:
    """What is stored of a solution; `augmentation_effect_m` is the largest displacement by the
    last augmentation of the contact."""
    mesh, elements, u = solved.mesh, solved.elements, solved.u
    wall, loads = solved.balance.wall, solved.balance.loads
    values = recorded(case, mesh, elements, wall, u, loads)
    stored = {
        "size_m": mesh.edge,
        "elements": len(mesh.cells),
        "unknowns": int(u.size),
        "load_steps": solved.balance.load_steps,
        "newton_iterations": solved.iterations,
        "penalty_pa_per_m": PENALTY,
        "penetration_m": wall.penetration(u[: mesh.nodes.size]),
        "augmentation_effect_m": float(f"{solved.balance.last_change:.3g}"),
        "smallest_J": elements.smallest_J(u),
        "load_n": float(np.linalg.norm(loads.reshape(-1, 3).sum(axis=0))),
        "region_volumes_m3": [float(f"{v:.6g}") for v in elements.node_volumes.sum(axis=1)],
    }
    return {
        "times_s": [case.time.load_end],
        "mesh": stored | {"values": values},
        "solution": dict(METHOD),
    }


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
        index = names.index(probe.centre_of_mass)
        centre, displacement = mean_over(case, mesh, elements.node_volumes[index], index, field)
        values.centre(probe.name, centre)
        values.displacement(probe.name, displacement)
    for prescription in case.prescriptions:
        reaction = elements.force(u)[:n] - wall.force(u[:n]) - loads
        reaction = np.where(np.repeat(mesh.constrained, 3), reaction, 0.0).reshape(-1, 3)
        force, moment = resultant(mesh.nodes, field, reaction, case.moment_about)
        values.reaction(prescription.name, force, moment)
    values.contact(wall.name, wall.resultant(u[:n]))
    values.strain_energy(elements.energy(u))
    return values.values


def mean_over(case: Case, mesh: Tetrahedra, volumes, index: int, field: np.ndarray):
    """Centre of mass (3,) [m] of a region and its displacement (3,) [m]: over the centres of
    the voxels with its label, since cells follow the borders of the labels roughly only; over
    the cells for the region of all the rest."""
    selector = case.regions[index].selector
    if selector == "all":
        weights = volumes / volumes.sum()
        return weights @ mesh.nodes, weights @ field
    image = read_label_map(case.folder / case.shape["label_map"]["file"])
    chosen = np.argwhere(image.labels == selector["label"]["value"])
    points = image.corner + image.voxel * chosen
    return points.mean(axis=0), Interpolation(mesh, points)(field).mean(axis=0)
