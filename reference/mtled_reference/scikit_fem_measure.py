"""What is read off displacements on a mesh: probes, centres of mass, reactions."""

import numpy as np
from scipy.spatial import KDTree

from .measure import Measurements, in_space, resultant
from .scikit_fem_model import Model
from .scikit_fem_symmetry import folded, folded_mean, images

CANDIDATES = 12
"""Elements, nearest by their centres, in which a point is sought."""

OVERSHOOT = 0.02
"""How far outside its element a point may lie, in reference coordinates; points
on a curved boundary do, by a little [–]."""


class Observer:
    """Reads the probes of a case off nodal displacements."""

    def __init__(self, model: Model):
        self.model = model
        self.points = {}
        self.centres = {}
        for probe in model.case.probes:
            if probe.positions is None:
                weight = np.asarray(model.masses[self._region(probe)].sum(axis=1)).ravel()
                self.centres[probe.name] = weight / weight.sum()
            else:
                here, signs = folded(model.symmetry, probe.positions[:, : model.d])
                self.points[probe.name] = (*located(model, here), signs)

    @staticmethod
    def _region(probe) -> str:
        return probe.centre_of_mass

    def record_centres(self, into: Measurements) -> None:
        """Records the reference centres of mass."""
        model = self.model
        for name, weights in self.centres.items():
            mean = folded_mean(model.symmetry, weights @ model.nodes, True)
            into.centre(name, model.case.positions(mean[None]))

    def record(self, into: Measurements, u, reactions, strain_energy: float) -> None:
        """Records one instant from displacements (n, d) [m], forces of the supports
        (n, d) [N] and the strain energy of the part that is meshed [J]."""
        model = self.model
        for name, (nodes, shapes, signs) in self.points.items():
            into.displacement(name, signs * np.einsum("pa,pad->pd", shapes, u[nodes]))
        for name, weights in self.centres.items():
            into.displacement(name, folded_mean(model.symmetry, weights @ u, False))
        for prescription in model.case.prescriptions:
            into.reaction(prescription.name, *self._reaction(prescription, u, reactions))
        into.strain_energy(strain_energy * self.images)

    @property
    def images(self) -> int:
        """How many mirror images make up the body."""
        return 2 ** len(self.model.symmetry)

    def _reaction(self, prescription, u, reactions) -> tuple[np.ndarray, np.ndarray]:
        """Force and moment of a support in the components that it prescribes."""
        model = self.model
        nodes = model.supports[prescription.name]
        forces = np.zeros((len(nodes), model.d))
        held = prescription.components(model.d)
        forces[:, held] = reactions[np.ix_(nodes, held)]
        here = in_space(model.case.positions(model.nodes[nodes] + u[nodes]))
        positions, forces = images(model.symmetry, here, forces)
        return resultant(positions, np.zeros_like(positions), forces, model.case.moment_about)


def located(model: Model, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (p, a) and shape functions (p, a) of the elements around points (p, d)."""
    dofs = model.basis.element_dofs.T
    centres = model.nodes[dofs].mean(axis=1)
    count = min(CANDIDATES, len(centres))
    candidates = KDTree(centres).query(points, k=count)[1].reshape(len(points), count)
    elements = candidates.ravel()
    wanted = np.repeat(points, count, axis=0)
    reference, shapes = _inverse_map(model, elements, wanted)
    outside = np.maximum(-reference, reference - 1.0).max(axis=1)
    missed = np.einsum("pa,pad->pd", shapes, model.nodes[dofs[elements]]) - wanted
    size = np.ptp(model.nodes, axis=0).max()
    outside[~(np.linalg.norm(missed, axis=1) < 1e-9 * size)] = np.inf
    outside = outside.reshape(len(points), count)
    best = outside.argmin(axis=1)
    if np.any(outside[np.arange(len(points)), best] > OVERSHOOT):
        raise ValueError("a probe lies outside the mesh")
    chosen = np.arange(len(points)) * count + best
    return dofs[elements[chosen]], shapes[chosen]


def _inverse_map(model: Model, elements, wanted) -> tuple[np.ndarray, np.ndarray]:
    """Newton for the reference coordinates (p, d) at which elements reach positions."""
    corners = model.nodes[model.basis.element_dofs.T[elements]]
    reference = np.full(wanted.shape, 0.5)
    for _ in range(20):
        shapes, slopes = _shapes(model, reference)
        gap = wanted - np.einsum("pa,pad->pd", shapes, corners)
        jacobian = np.einsum("pai,pad->pdi", slopes, corners)
        step = np.linalg.solve(jacobian, gap[..., None])[..., 0]
        reference = np.clip(reference + step, -1.0, 2.0)
        if np.abs(step).max() < 1e-12:
            break
    return reference, _shapes(model, reference)[0]


def _shapes(model: Model, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions (p, a) and their reference gradients (p, a, d)."""
    element = model.basis.elem
    pairs = [element.lbasis(reference.T, i) for i in range(model.basis.Nbfun)]
    values = np.stack([np.broadcast_to(pair[0], len(reference)) for pair in pairs], axis=1)
    return values, np.stack([np.asarray(pair[1]).T for pair in pairs], axis=1)
