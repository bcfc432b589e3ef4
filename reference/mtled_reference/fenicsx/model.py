"""A case on a mesh: function spaces, strain energy and its derivatives.

With u alone the energy is ∫ ψ(F) dV; with the fields u, p, θ it is
∫ ψ((θ/J)^(1/3) F) + p (J − θ) dV. UFL differentiates both.
"""

from dataclasses import dataclass, field, replace

import numpy as np
import ufl
from dolfinx import fem, mesh

from ..shared.case import Case
from ..shared.materials import strain_energy, three_field_energy
from ..shared.selection import selected
from . import versions
from .kinematics import PlaneStrain, Solid, invariants
from .mirror import Mirror

ON_BOUNDARY = 1e-6
"""Tolerance of selections over the size of the body [–]."""
CONSTANTS = ("density", "shear_modulus", "bulk_modulus")


@dataclass
class Recipe:
    """A mesh of a case: `cell` and `order` of its geometry, points [m] and cells,
    kinematics, planes of symmetry, and the nominal size [m] of a cell."""

    cell: str
    order: int
    points: np.ndarray
    cells: np.ndarray
    size: float
    family: str
    kinematics: Solid = field(default_factory=Solid)
    mirrors: tuple[Mirror, ...] = ()
    load_steps: int = 4
    time_step: float = 0.0
    degree: int = 2
    """Degree of u."""
    three_fields: bool | None = None
    """Whether p and θ are unknown fields; None: if a material is nearly incompressible."""
    quadrature_degree: int | None = None
    """None: that of the kinematics."""
    compiler_flags: tuple[str, ...] = ()


class Model:
    """Spaces, coefficients and forms. `unknown` has all unknown fields; `fields` has
    the indices of the components of u (nodes, components) in it."""

    def __init__(self, case: Case, recipe: Recipe):
        self.case, self.recipe = case, recipe
        self.kinematics = recipe.kinematics
        self.domain = versions.create_mesh(recipe.cell, recipe.order, recipe.points, recipe.cells)
        self.three_fields = recipe.three_fields
        if self.three_fields is None:
            self.three_fields = any(r.material.is_nearly_incompressible for r in case.regions)
        self._make_spaces()
        self._make_materials()
        self._make_forms()

    def _make_spaces(self) -> None:
        cell, degree = self.recipe.cell, self.recipe.degree
        u_element = versions.vector_element(cell, degree, self.kinematics.components)
        if not self.three_fields:
            self.space = versions.function_space(self.domain, u_element)
            self.unknown = fem.Function(self.space)
            self.u_space, dofs = self.space, np.arange(len(self.unknown.x.array))
        else:
            inside = versions.discontinuous_element(cell, degree - 1)
            element = versions.mixed_element([u_element, inside, inside])
            self.space = versions.function_space(self.domain, element)
            self.unknown = fem.Function(self.space)
            self.u_space, dofs = self.space.sub(0).collapse()
            ratio_space, ratio_dofs = self.space.sub(2).collapse()
            one = fem.Function(ratio_space)
            one.interpolate(lambda x: np.ones(x.shape[1]))
            self.unknown.x.array[np.asarray(ratio_dofs)] = one.x.array
        self.fields = np.asarray(dofs, dtype=np.int32).reshape(-1, self.kinematics.components)
        self.points = self.u_space.tabulate_dof_coordinates()
        self.positions = self.kinematics.positions(self.points)

    def _make_materials(self) -> None:
        """Material constants as functions per cell, so that all regions share one form."""
        first = self.case.regions[0].material
        if any(r.material.law != first.law for r in self.case.regions):
            raise ValueError("the regions have different laws")
        self.cell_space = versions.function_space(self.domain, ("DG", 0))
        centres = self.cell_space.tabulate_dof_coordinates()
        self.owner = self._owners(self.kinematics.positions(centres))
        self.constants = {name: fem.Function(self.cell_space) for name in CONSTANTS}
        for name, function in self.constants.items():
            values = np.array([getattr(r.material, name) for r in self.case.regions])
            function.x.array[:] = values[self.owner]
        rubber = tuple(fem.Constant(self.domain, c) if c else 0.0 for c in first.rubber)
        self.material = replace(first, rubber=rubber, **self.constants)

    def _owners(self, positions: np.ndarray) -> np.ndarray:
        """The first region that contains each position."""
        inside = [selected(r.selector, positions, 0.0) for r in self.case.regions]
        if not np.all(np.any(inside, axis=0)):
            raise ValueError("a cell belongs to no region")
        return np.argmax(inside, axis=0)

    def _make_forms(self) -> None:
        factor = self.kinematics.volume_factor(self.domain)
        degree = self.recipe.quadrature_degree or self.kinematics.quadrature_degree
        dx = ufl.Measure("dx", self.domain, metadata={"quadrature_degree": degree})
        parts = ufl.split(self.unknown) if self.three_fields else [self.unknown]
        F = self.kinematics.deformation_gradient(parts[0], self.domain)
        first, second, J = invariants(F)
        if self.three_fields:
            p, theta = parts[1:]
            psi = three_field_energy(self.material, first, second, J, theta, ufl.ln)
            energy = (psi + p * (J - theta)) * factor * dx
        else:
            psi = strain_energy(self.material, first, second, J, ufl.ln)
            energy = psi * factor * dx
        residual = ufl.derivative(energy + self._energy_of_contact(), self.unknown)
        residual = residual + self._work_of_pressures(F, factor)
        self.residual_form = self._form(residual)
        self.jacobian_form = self._form(ufl.derivative(residual, self.unknown))
        self.energy_form = self._form(psi * factor * dx)
        self._make_load_forms(factor, dx)

    def _work_of_pressures(self, F, factor):
        """∫ p v · cof F N dA in plane strain. Its derivative is symmetric where the ends of the curve
        stay on axes."""
        self.pressures, work = [], 0
        v = ufl.TestFunction(self.space)
        v = ufl.split(v)[0] if self.three_fields else v
        for row in self.case.pressures:
            if not (isinstance(self.kinematics, PlaneStrain) and self.case.is_static):
                raise ValueError("pressures are solved in equilibria in plane strain only")
            pressure = fem.Constant(self.domain, 0.0)
            plane = ufl.as_matrix([[F[0, 0], F[0, 1]], [F[1, 0], F[1, 1]]])
            outward = ufl.cofac(plane) * ufl.FacetNormal(self.domain)
            ds = self.boundary_measure(f"pressure {row.name}", row.selector)
            work = work + pressure * ufl.inner(v, outward) * factor * ds
            self.pressures.append((pressure, row))
        return work

    def boundary_measure(self, what: str, selector):
        """Integrates over the boundary facets whose corners lie in the selection of a load."""
        dimension = self.domain.topology.dim - 1
        tolerance = ON_BOUNDARY * float(np.ptp(self.positions, axis=0).max())

        def marked(x):
            return selected(selector, self.kinematics.positions(x.T), tolerance)

        facets = np.sort(mesh.locate_entities_boundary(self.domain, dimension, marked))
        if len(facets) == 0:
            raise ValueError(f"no boundary facet in {what}")
        ones = np.ones(len(facets), np.int32)
        tags = mesh.meshtags(self.domain, dimension, facets.astype(np.int32), ones)
        return ufl.Measure("ds", self.domain, subdomain_data=tags)(1)

    def load_pressures(self, t: float, fraction: float) -> None:
        """Sets pressures to a fraction of those at a time [s]."""
        for pressure, row in self.pressures:
            pressure.value = fraction * row.pressure * row.amplitude(t)

    def _energy_of_contact(self):
        """What a body that touches nothing does not have."""
        return 0

    def _form(self, expression):
        return versions.form(expression, self.recipe.compiler_flags)

    def _make_load_forms(self, factor, dx) -> None:
        """∫ χ ρ a·v dV with χ = 1 in chosen cells and a uniform acceleration a."""
        v = ufl.TestFunction(self.u_space)
        self.chosen = fem.Function(self.cell_space)
        self.direction = fem.Constant(self.domain, np.zeros(self.kinematics.components))
        density = self.constants["density"]
        self.mass_force_form = self._form(
            self.chosen * density * ufl.inner(self.direction, v) * factor * dx
        )
        if not self.case.is_static:
            w = ufl.TrialFunction(self.u_space)
            self.mass_form = self._form(density * ufl.inner(w, v) * factor * dx)

    def mass_force(self, direction: np.ndarray, regions: list[int] | None = None) -> np.ndarray:
        """Nodal forces (nodes, components) [N] of an acceleration [m/s²] of some regions."""
        self.chosen.x.array[:] = 1.0 if regions is None else np.isin(self.owner, regions)
        self.direction.value[:] = direction
        forces = versions.assemble_vector(self.mass_force_form)
        return forces.reshape(-1, self.kinematics.components)

    def u(self) -> np.ndarray:
        """The nodal values of u (nodes, components)."""
        return self.unknown.x.array[self.fields]

    def displacement(self, place, within: float = 1e-9) -> np.ndarray:
        """u (components,) of the node at a reference position, up to a distance [m]."""
        count = self.positions.shape[1]
        distances = np.linalg.norm(self.positions - np.asarray(place)[:count], axis=1)
        if distances.min() > within:
            raise ValueError(f"no node lies at {place}")
        return self.u()[int(np.argmin(distances))]

    def strain_energy(self) -> float:
        """∫ ψ dV of the meshed part [J]."""
        return float(fem.assemble_scalar(self.energy_form))
