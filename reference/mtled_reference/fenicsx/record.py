"""Probes, reactions and energies at an instant, recorded for the reference file."""

import numpy as np
from dolfinx import fem

from ..shared.measurements import Measurements
from .mirror import unfolded
from .probes import Locator, PointValues


class Recorder:
    """Collects the quantities of a case in `measurements`."""

    def __init__(self, model, conditions):
        self.model, self.conditions = model, conditions
        self.measurements = Measurements()
        locator = Locator(model)
        self.u = fem.Function(model.u_space)
        self.points, self.masses = {}, {}
        for probe in model.case.probes:
            if probe.centre_of_mass is None:
                self.points[probe.name] = PointValues(model, locator, probe.positions)
            else:
                self.masses[probe.name] = self._masses(probe.centre_of_mass)
        self._record_centres()

    def _masses(self, name: str) -> np.ndarray:
        """Nodal masses (nodes,) [kg] of a region; `body` stands for all regions."""
        model = self.model
        regions = [i for i, region in enumerate(model.case.regions) if region.name == name]
        if not regions and name != "body":
            raise ValueError(f"no region {name}")
        unit = np.zeros(model.kinematics.components)
        unit[-1] = 1.0
        return model.mass_force(unit, regions or None)[:, -1]

    def _record_centres(self) -> None:
        model = self.model
        for name, masses in self.masses.items():
            centre, _ = model.kinematics.means(masses, model.positions, model.u())
            for mirror in model.recipe.mirrors:
                centre = 0.5 * (centre + mirror.positions(centre[None])[0])
            self.measurements.centre(name, centre)

    def shifts(self, t: float) -> list[float]:
        """Displacements [m] of the planes of symmetry at time t [s]."""
        return [mirror.shift(self.model.case, t, 1.0) for mirror in self.model.recipe.mirrors]

    def record(self, t: float, reactions: np.ndarray, kinetic_energy: float | None = None) -> None:
        """Records the state of the model at time t [s], with reactions (nodes, components) [N]."""
        model, shifts = self.model, self.shifts(t)
        copies = 2.0 ** len(shifts)
        self.u.x.array[:] = model.u().ravel()
        for name, points in self.points.items():
            self.measurements.displacement(name, points.displacements(self.u, shifts))
        for name, masses in self.masses.items():
            _, mean = model.kinematics.means(masses, model.positions, model.u())
            for mirror, shift in zip(model.recipe.mirrors, shifts):
                mean = 0.5 * (mean + mirror.displacements(mean[None], shift)[0])
            self.measurements.displacement(name, mean)
        for row in model.case.prescriptions:
            self.measurements.reaction(row.name, *self._resultant(row, shifts, reactions))
        self.measurements.strain_energy(copies * model.strain_energy())
        if kinetic_energy is not None:
            self.measurements.kinetic_energy(copies * kinetic_energy)

    def _resultant(self, row, shifts, reactions: np.ndarray):
        """Force [N] and moment [N·m] of a condition on the whole body."""
        model, about = self.model, self.model.case.moment_about
        if not shifts:
            forces = self.conditions.reaction_mask(row) * reactions
            return model.kinematics.resultant(model.positions, model.u(), forces, about)
        nodes = np.flatnonzero(self.conditions.boundary)
        positions, displacements, forces = unfolded(
            model.recipe.mirrors, shifts, model.positions[nodes], model.u()[nodes], reactions[nodes]
        )
        forces = self.conditions.constrained_by(row, positions)[:, None] * forces
        free = [i for i in range(3) if i not in row.components(3)]
        forces[:, free] = 0.0
        return model.kinematics.resultant(positions, displacements, forces, about)
