"""Probes, centres of mass, reactions and energies, recorded for the reference file."""

import numpy as np

from ..shared.measurements import Measurements, in_space, resultant
from .model import Model
from .probes import located
from .symmetry import folded, folded_mean, images


class Recorder:
    """Collects the quantities of a case in `measurements`."""

    def __init__(self, model: Model):
        self.model, self.measurements = model, Measurements()
        self.points = {}
        self.centres = {}
        for probe in model.case.probes:
            if probe.positions is None:
                masses = np.asarray(model.masses[probe.centre_of_mass].sum(axis=1)).ravel()
                self.centres[probe.name] = masses / masses.sum()
            else:
                here, signs = folded(model.symmetry, probe.positions[:, : model.d])
                self.points[probe.name] = (*located(model, here), signs)
        for name, fractions in self.centres.items():
            mean = folded_mean(model.symmetry, fractions @ model.nodes, True)
            self.measurements.centre(name, model.case.positions(mean[None]))

    def record(self, u, reactions, strain_energy: float, kinetic_energy: float | None = None):
        """Records one instant from displacements (n, d) [m], reactions (n, d) [N] and the
        energies of the meshed part [J]."""
        model, into = self.model, self.measurements
        for name, (nodes, shapes, signs) in self.points.items():
            into.displacement(name, signs * np.einsum("pa,pad->pd", shapes, u[nodes]))
        for name, fractions in self.centres.items():
            into.displacement(name, folded_mean(model.symmetry, fractions @ u, False))
        for prescription in model.case.prescriptions:
            into.reaction(prescription.name, *self._reaction(prescription, u, reactions))
        copies = 2 ** len(model.symmetry)
        into.strain_energy(strain_energy * copies)
        if kinetic_energy is not None:
            into.kinetic_energy(kinetic_energy * copies)

    def _reaction(self, prescription, u, reactions) -> tuple[np.ndarray, np.ndarray]:
        """Force [N] and moment [N·m] of a support, from the prescribed components."""
        model = self.model
        nodes = model.supports[prescription.name]
        forces = np.zeros((len(nodes), model.d))
        components = prescription.components(model.d)
        forces[:, components] = reactions[np.ix_(nodes, components)]
        here = in_space(model.case.positions(model.nodes[nodes] + u[nodes]))
        positions, forces = images(model.symmetry, here, forces)
        return resultant(positions, np.zeros_like(positions), forces, model.case.moment_about)
