"""The run of a whole brain on one mesh and the values that are recorded, with either code."""

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
    "mesh_family": "tetrahedra by TetGen inside a relaxed surface net, midpoints of the surface on "
    "the level, edges halved along ventricles and tumour; same meshes for both codes",
    "solver": "Newton, residual 1e-6 of the forces; augmented Lagrangian contact, ε = 3e7 Pa/m and "
    "two augmentations, at twelve points per facet",
}


@dataclass
class Solved:
    """The unknowns `u` in equilibrium on a mesh."""

    mesh: Tetrahedra
    elements: object
    balance: Balance
    u: np.ndarray


def solved_mesh(case: Case, level: int, elements_of, progress) -> dict:
    """Instants [s] and what is stored of the mesh of a level, with the solution method."""
    mesh = tetrahedra(case, EDGES[level])
    elements = elements_of(case, mesh)
    balance = balance_of(case, mesh, elements, Wall(case, mesh, PENALTY), progress)
    u = balance.solve()
    return result_of(case, Solved(mesh, elements, balance, u))


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
        "newton_iterations": solved.balance.iterations,
        "penalty_pa_per_m": PENALTY,
        "penetration_m": short(wall.penetration(u[: mesh.nodes.size])),
        "augmentation_effect_m": short(solved.balance.last_change),
        "smallest_J": short(elements.smallest_J(u)),
        "load_n": short(np.linalg.norm(loads.reshape(-1, 3).sum(axis=0))),
        "region_volumes_m3": [short(v) for v in elements.node_volumes.sum(axis=1)],
    }
    return {
        "times_s": [case.time.load_end],
        "mesh": stored | {"values": values},
        "solution": dict(METHOD),
    }


def short(number: float) -> float:
    """The number rounded to four significant digits."""
    return float(f"{number:.4g}")


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

    def report(iteration, fraction, kappa, residual, penetration):
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
