"""Prescribed displacements and loads of a case in the unknowns of a model."""

import numpy as np
import ufl
from dolfinx import fem, mesh

from ..shared.selection import selected
from . import versions
from .kinematics import Axisymmetric
from .mirror import Mirror
from .model import ON_BOUNDARY, Model


class Conditions:
    """Prescribed displacements, body forces and tractions of a model."""

    def __init__(self, model: Model):
        self.model, self.case = model, model.case
        self.tolerance = ON_BOUNDARY * float(np.ptp(model.positions, axis=0).max())
        self.boundary = self._boundary_nodes()
        self.nodes = {row.name: self._nodes_of(row) for row in self.case.prescriptions}
        self._check_mirrors()
        self._tractions = [(row, self._traction(row)) for row in self.case.tractions]
        self._body_forces = [
            (row, model.mass_force(self._in_unknowns(row.acceleration)))
            for row in self.case.uniform_body_forces()
        ]

    def _in_unknowns(self, vector) -> np.ndarray:
        """The components of a uniform force per mass or area along the unknowns."""
        kinematics = self.model.kinematics
        if isinstance(kinematics, Axisymmetric) and np.any(np.asarray(vector)[:2]):
            raise ValueError("a body of revolution takes forces along its axis only")
        return np.asarray(vector, float)[: kinematics.components]

    def _symmetry_planes(self) -> list[Mirror]:
        """The mirrors, and the axis of revolution: boundaries of the mesh, not of the body."""
        planes = list(self.model.recipe.mirrors)
        if isinstance(self.model.kinematics, Axisymmetric):
            planes.append(Mirror(0, 0.0))
        return planes

    def _on_plane(self, plane: Mirror, positions: np.ndarray) -> np.ndarray:
        return np.abs(positions[:, plane.axis] - plane.place) <= self.tolerance

    def _facets(self, predicate) -> np.ndarray:
        """Boundary facets whose corners all satisfy a predicate on positions."""
        model = self.model

        def marked(x):
            return predicate(model.kinematics.positions(x.T))

        return mesh.locate_entities_boundary(model.domain, model.domain.topology.dim - 1, marked)

    def _boundary_nodes(self) -> np.ndarray:
        """Whether each node lies on the surface of the whole body."""
        domain = self.model.domain
        facets = versions.exterior_facets(domain)
        for plane in self._symmetry_planes():
            facets = np.setdiff1d(facets, self._facets(lambda x, p=plane: self._on_plane(p, x)))
        nodes = fem.locate_dofs_topological(
            self.model.u_space, domain.topology.dim - 1, facets.astype(np.int32)
        )
        on_surface = np.zeros(len(self.model.positions), dtype=bool)
        on_surface[nodes] = True
        return on_surface

    def constrained_by(self, row, positions: np.ndarray) -> np.ndarray:
        """Which positions on the surface of the whole body a prescription selects."""
        return selected(row.selector, positions, self.tolerance)

    def _nodes_of(self, row) -> np.ndarray:
        """The nodes that a prescription constrains."""
        inside = selected(row.selector, self.model.positions, self.tolerance)
        if row.of == "surface":
            inside &= self.boundary
        return np.flatnonzero(inside)

    def _check_mirrors(self) -> None:
        """Refuses conditions that are no mirror images of themselves or of one another."""
        surface = np.flatnonzero(self.boundary)
        positions = self.model.positions[surface]
        constrained, values = self._constrained_at(positions)
        for mirror in self.model.recipe.mirrors:
            image, image_values = self._constrained_at(mirror.positions(positions))
            shift = mirror.shift(self.case, self.case.time.load_end, 1.0)
            expected = mirror.displacements(values, shift)
            difference = np.where(constrained, expected - image_values, 0.0)
            largest = np.abs(difference).max(initial=0.0)
            if np.any(constrained != image) or largest > self.tolerance:
                raise ValueError(f"the conditions are not symmetric about axis {mirror.axis}")

    def _constrained_at(self, positions: np.ndarray):
        """Which components are prescribed at surface positions, and their values."""
        constrained = np.zeros((len(positions), 3), dtype=bool)
        values = np.zeros((len(positions), 3))
        for row in self.case.prescriptions:
            inside = self.constrained_by(row, positions)
            prescribed = row.values(positions, row.amplitude(self.case.time.load_end))
            for i in row.components(3 if self.case.dimension == 3 else 2):
                constrained[inside, i] = True
                values[inside, i] = prescribed[inside, i]
        return constrained, values

    def _traction(self, row) -> np.ndarray:
        """Nodal forces (nodes, components) [N] of a dead traction."""
        model = self.model
        ds = model.boundary_measure(f"traction {row.name}", row.selector)
        force = fem.Constant(model.domain, self._in_unknowns(row.traction))
        v = ufl.TestFunction(model.u_space)
        form = fem.form(ufl.inner(force, v) * model.kinematics.volume_factor(model.domain) * ds)
        return versions.assemble_vector(form).reshape(-1, model.kinematics.components)

    def external_forces(self, t: float, fraction: float = 1.0) -> np.ndarray:
        """A fraction of the nodal forces (nodes, components) [N] at time t [s]."""
        total = np.zeros(self.model.fields.shape)
        for row, forces in self._body_forces + self._tractions:
            total += fraction * row.amplitude(t) * forces
        return total

    def prescribed(self, t: float, fraction: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
        """Indices of the prescribed unknowns at time t [s], and their values at a
        fraction of the amplitude."""
        model, kinematics = self.model, self.model.kinematics
        values = np.full(model.fields.shape, np.nan)
        for plane in self._symmetry_planes():
            on = self._on_plane(plane, model.positions)
            values[on, plane.axis] = plane.shift(self.case, t, fraction)
        for row in self.case.prescriptions:
            nodes = self.nodes[row.name]
            positions = model.positions[nodes]
            displacements = row.values(positions, fraction * row.amplitude(t))
            moved = kinematics.unknowns(positions, displacements)
            for i in row.components(kinematics.components):
                values[nodes, i] = moved[:, i]
        known = ~np.isnan(values)
        return model.fields[known].astype(np.int32), values[known]

    def reaction_mask(self, row) -> np.ndarray:
        """1 where a condition prescribes a component of a node, else 0 (nodes, components)."""
        mask = np.zeros(self.model.fields.shape)
        for i in row.components(self.model.kinematics.components):
            mask[self.nodes[row.name], i] = 1.0
        return mask
