"""A case on a mesh: function spaces, energy and what follows from it.

With u alone the energy is ∫ ψ(F) dV; with the fields u, p, θ it is
∫ ψ((θ/J)^(1/3) F) + p (J − θ) dV. UFL differentiates both.
"""

from dataclasses import dataclass, field, replace

import numpy as np
import ufl
from dolfinx import fem

from . import fenicsx_versions as versions
from .case import Case
from .fenicsx_kinematics import Solid
from .fenicsx_mirror import Mirror
from .materials import strain_energy, three_field_energy
from .selection import selected

CONSTANTS = ("density", "shear_modulus", "bulk_modulus")


@dataclass
class Recipe:
    """A mesh of a case: `cell` and `order` of its geometry, points [m] and cells,
    kinematics, planes of symmetry, and a length [m] for the size of its cells."""

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
    """Of u."""
    three_fields: bool | None = None
    """Whether p and θ are fields of their own; None leaves it to the materials."""
    quadrature_degree: int | None = None
    """None leaves it to the kinematics."""
    compiler_flags: tuple[str, ...] = ()


class Model:
    """Spaces, coefficients and forms. `unknown` holds all fields; `fields` are the
    places of u's components (nodes, components) in it."""

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
            self.u_space, places = self.space, np.arange(len(self.unknown.x.array))
        else:
            inside = versions.discontinuous_element(cell, degree - 1)
            element = versions.mixed_element([u_element, inside, inside])
            self.space = versions.function_space(self.domain, element)
            self.unknown = fem.Function(self.space)
            self.u_space, places = self.space.sub(0).collapse()
            ratio_space, ratio_places = self.space.sub(2).collapse()
            one = fem.Function(ratio_space)
            one.interpolate(lambda x: np.ones(x.shape[1]))
            self.unknown.x.array[np.asarray(ratio_places)] = one.x.array
        self.fields = np.asarray(places, dtype=np.int32).reshape(-1, self.kinematics.components)
        self.points = self.u_space.tabulate_dof_coordinates()
        self.positions = self.kinematics.positions(self.points)

    def _make_materials(self) -> None:
        """Constants per cell, so that all regions share one form."""
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
        """The first region that holds each position."""
        held = [selected(r.selector, positions, 0.0) for r in self.case.regions]
        if not np.all(np.any(held, axis=0)):
            raise ValueError("a cell belongs to no region")
        return np.argmax(held, axis=0)

    def _make_forms(self) -> None:
        weight = self.kinematics.weight(self.domain)
        degree = self.recipe.quadrature_degree or self.kinematics.quadrature_degree
        dx = ufl.Measure("dx", self.domain, metadata={"quadrature_degree": degree})
        parts = ufl.split(self.unknown) if self.three_fields else [self.unknown]
        F = self.kinematics.gradient(parts[0], self.domain)
        C, J = F.T * F, ufl.det(F)
        first, second = ufl.tr(C), (ufl.tr(C) ** 2 - ufl.tr(C * C)) / 2
        if self.three_fields:
            p, theta = parts[1:]
            psi = three_field_energy(self.material, first, second, J, theta, ufl.ln)
            energy = (psi + p * (J - theta)) * weight * dx
        else:
            psi = strain_energy(self.material, first, second, J, ufl.ln)
            energy = psi * weight * dx
        residual = ufl.derivative(energy, self.unknown)
        self.residual_form = self._form(residual)
        self.jacobian_form = self._form(ufl.derivative(residual, self.unknown))
        self.energy_form = self._form(psi * weight * dx)
        self._make_load_forms(weight, dx)

    def _form(self, expression):
        return versions.form(expression, self.recipe.compiler_flags)

    def _make_load_forms(self, weight, dx) -> None:
        """∫ χ ρ a·v dV with χ = 1 in chosen cells and a a constant vector."""
        v = ufl.TestFunction(self.u_space)
        self.chosen = fem.Function(self.cell_space)
        self.direction = fem.Constant(self.domain, np.zeros(self.kinematics.components))
        density = self.constants["density"]
        self.mass_force_form = self._form(
            self.chosen * density * ufl.inner(self.direction, v) * weight * dx
        )
        if not self.case.is_static:
            w = ufl.TrialFunction(self.u_space)
            self.mass_form = self._form(density * ufl.inner(w, v) * weight * dx)

    def mass_force(self, direction: np.ndarray, regions: list[int] | None = None) -> np.ndarray:
        """Nodal forces (nodes, components) [N] of an acceleration [m/s²] on regions."""
        self.chosen.x.array[:] = 1.0 if regions is None else np.isin(self.owner, regions)
        self.direction.value[:] = direction
        forces = versions.assemble_vector(self.mass_force_form)
        return forces.reshape(-1, self.kinematics.components)

    def u(self) -> np.ndarray:
        """The unknowns of the nodes (nodes, components)."""
        return self.unknown.x.array[self.fields]

    def strain_energy(self) -> float:
        """∫ ψ dV of the meshed part [J]."""
        return float(fem.assemble_scalar(self.energy_form))
