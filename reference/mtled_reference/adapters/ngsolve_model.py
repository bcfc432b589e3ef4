"""A case on a mesh of NGSolve: spaces, forms, supports, loads and Newton's method."""

from dataclasses import replace

import ngsolve as ngs
import numpy as np
from ngsolve.meshes import MakeStructured3DMesh

from ..shared.case import Case
from ..shared.materials import strain_energy, three_field_energy
from ..shared.selection import selected
from .bodies import Surface, mesh
from .cases import counts, is_even
from .files import Refused

RESIDUAL = 1e-8
"""Of Newton's method, over the internal forces [–]."""
ITERATIONS = 12
DIRECT = {False: "sparsecholesky", True: "umfpack"}
"""Linear solvers, without and with three fields."""


class NoConvergence(Exception):
    """Newton's method did not end."""


class Model:
    """A case on a mesh. `u` has all unknowns, `free` those that are not prescribed."""

    def __init__(self, case: Case, job: dict):
        self.case, d = case, case.dimension
        self.mesh, self.element = _mesh(case, job["spacing_m"])
        surface = Surface(case, self.mesh.ngmesh, job["spacing_m"])
        order_2 = ngs.VectorH1(self.mesh, order=2)
        self.mixed = any(region.material.is_nearly_incompressible for region in case.regions)
        if self.mixed:
            scalar = ngs.H1(self.mesh, order=1)
            self.space = order_2 * scalar * scalar
            self.element += ", three fields"
        else:
            self.space = order_2
        self.u, self.lift = ngs.GridFunction(self.space), ngs.GridFunction(order_2)
        self.motion = self.u.components[0] if self.mixed else self.u
        if self.mixed:
            self.u.components[2].Set(1.0)
        self._materials()
        self._forms(surface)
        self.offsets = [order_2.Range(i).start for i in range(d)]
        self.free = np.array(list(self.space.FreeDofs()))
        self.supports = [self._support(row, surface) for row in case.prescriptions]

    def _materials(self) -> None:
        """The region of each cell and a material whose constants are fields."""
        case, regions = self.case, self.case.regions
        cells = np.array([[v.nr for v in cell.vertices] for cell in self.mesh.Elements()])
        centres = case.positions(self.mesh.ngmesh.Coordinates()[cells].mean(axis=1))
        hits = [selected(region.selector, centres, 0.0) for region in regions]
        if not np.any(hits, axis=0).all():
            raise Refused("parts of the body in no region")
        if len({(region.material.law, region.material.volumetric) for region in regions}) > 1:
            raise Refused("regions of different laws")
        self.owners = np.argmax(hits, axis=0)
        constant = ngs.L2(self.mesh, order=0)

        def by_cell(values):
            if len(regions) == 1:
                return ngs.CF(values[0])
            function = ngs.GridFunction(constant)
            function.vec.FV().NumPy()[:] = np.array(values)[self.owners]
            return function

        rows, self.by_cell = [region.material for region in regions], by_cell
        self.density = by_cell([row.density for row in rows])
        self.material = replace(
            rows[0],
            shear_modulus=by_cell([row.shear_modulus for row in rows]),
            bulk_modulus=by_cell([row.bulk_modulus for row in rows]),
            rubber=tuple(by_cell([row.rubber[i] for row in rows]) for i in range(4)),
        )

    def _forms(self, surface: Surface) -> None:
        case, d = self.case, self.case.dimension
        trial, test = self.space.TnT()
        u, v = (trial[0], test[0]) if self.mixed else (trial, test)
        F = ngs.Id(d) + ngs.Grad(u)
        C, J = F.trans * F, ngs.Det(F)
        extra = 3 - d
        first = ngs.Trace(C) + extra
        second = 0.5 * (first**2 - ngs.InnerProduct(C, C) - extra)
        if self.mixed:
            _, p, theta = trial
            energy = three_field_energy(self.material, first, second, J, theta, ngs.log)
            energy += p * (J - theta)
        else:
            energy = strain_energy(self.material, first, second, J, ngs.log)
        t = case.thickness
        self.stiffness = ngs.BilinearForm(self.space, symmetric=True)
        self.stiffness += ngs.Variation((t * energy).Compile() * ngs.dx(bonus_intorder=2))
        self.mass = ngs.BilinearForm(self.space, symmetric=True)
        self.mass += t * self.density * ngs.InnerProduct(u, v) * ngs.dx
        self.loads = []
        for force in case.uniform_body_forces():
            form = ngs.LinearForm(self.space)
            form += t * self.density * ngs.InnerProduct(ngs.CF(force.acceleration[:d]), v) * ngs.dx
            self.loads.append((force.amplitude, form.Assemble().vec.FV().NumPy()))
        for row in case.tractions:
            where = self._boundary(surface.chosen(row.name, row.selector))
            form = ngs.LinearForm(self.space)
            form += t * ngs.InnerProduct(ngs.CF(row.traction[:d]), v) * ngs.ds(definedon=where)
            self.loads.append((row.amplitude, form.Assemble().vec.FV().NumPy()))

    def _boundary(self, numbers: list[int]):
        names = self.mesh.GetBoundaries()
        return self.mesh.Boundaries("|".join(names[number - 1] for number in numbers))

    def _support(self, row, surface: Surface):
        """A support with its boundary, its unknowns and those of them at corners."""
        if row.of != "surface" or row.formula:
            raise Refused(f"{row.name}: supports of the volume, formulas")
        where = self._boundary(surface.chosen(row.name, row.selector))
        scalar = ngs.H1(self.mesh, order=2)
        on = np.flatnonzero(list(scalar.GetDofs(where)))
        mine = {}
        for i in row.components(self.case.dimension):
            numbers = on + self.offsets[i]
            mine[i] = numbers[self.free[numbers]]
            self.free[numbers] = False
        return row, where, mine

    def prescribed(self, t: float, scale: float):
        """Numbers and values of the prescribed unknowns at time t [s]."""
        numbers, found = [np.empty(0, int)], [np.empty(0)]
        for row, where, mine in self.supports:
            factor = scale * row.amplitude(t)
            if row.rotation:
                field = _rotated(row.rotation, factor, self.case)
            else:
                values = tuple((c or 0.0) * factor for c in row.displacement)
                field = ngs.CF(values[: len(self.offsets)])
            self.lift.Set(field, definedon=where)
            for own in mine.values():
                numbers.append(own)
                found.append(self.lift.vec.FV().NumPy()[own].copy())
        return np.concatenate(numbers), np.concatenate(found)

    def load(self, t: float, scale: float) -> np.ndarray:
        """Forces of the loads at time t [s]."""
        total = np.zeros(self.space.ndof)
        for amplitude, vector in self.loads:
            total += scale * amplitude(t) * vector
        return total

    def forces(self) -> np.ndarray:
        """Internal forces."""
        result = self.u.vec.CreateVector()
        self.stiffness.Apply(self.u.vec, result)
        return result.FV().NumPy().copy()

    def newton(self, load, prescribed, inertia=None) -> np.ndarray:
        """Solves for the equilibrium with `load` [N] and `prescribed` unknowns; returns what the
        supports exert. `inertia` is a factor of the mass matrix and a predictor."""
        x, (numbers, values) = self.u.vec.FV().NumPy(), prescribed
        move = np.zeros_like(x)
        move[numbers] = values - x[numbers]
        free = ngs.BitArray(list(self.free))
        step, right = self.u.vec.CreateVector(), self.u.vec.CreateVector()
        for _ in range(ITERATIONS):
            inner = self.forces()
            residual = inner - load
            if inertia:
                step.FV().NumPy()[:] = x - inertia[1]
                right.data = inertia[0] * self.mass.mat * step
                residual += right.FV().NumPy()
            size = np.linalg.norm(residual[self.free])
            if not np.isfinite(size):
                break
            scale = max(np.linalg.norm(inner), np.linalg.norm(load))
            if not move.any() and size <= RESIDUAL * scale:
                return residual
            self.stiffness.AssembleLinearization(self.u.vec)
            matrix = self.stiffness.mat
            if inertia:
                matrix.AsVector().data += inertia[0] * self.mass.mat.AsVector()
            step.FV().NumPy()[:] = move
            right.data = matrix * step
            right.FV().NumPy()[:] += residual
            inverse = matrix.Inverse(free, DIRECT[self.mixed])
            step.data -= inverse * right
            x += step.FV().NumPy()
            move[:] = 0.0
        raise NoConvergence

    def reaction(self, mine: dict, residual: np.ndarray) -> list[float]:
        """The force of a support: its unknowns at corners, whose functions are 1 in sum."""
        corners = {i: own[own < self.offsets[i] + self.mesh.nv] for i, own in mine.items()}
        return [float(residual[corners[i]].sum()) if i in mine else 0.0 for i in range(3)]


def _mesh(case: Case, spacing: float):
    """A mesh for elements of order 2 whose nodes have a spacing [m], and its name."""
    if is_even(case):
        low, high, numbers = counts(case, spacing, 2)
        size = high - low
        box = MakeStructured3DMesh(
            hexes=True,
            **dict(zip(("nx", "ny", "nz"), numbers)),
            mapping=lambda *at: tuple(low + size * np.array(at)),
        )
        return box, "even hexahedra Q2"
    body = ngs.Mesh(mesh(case, 2.0 * spacing)).Curve(2)
    return body, "triangles P2" if case.dimension == 2 else "tetrahedra P2 by Netgen"


def _rotated(rotation, factor: float, case: Case):
    """Displacements by a rotation as a field."""
    if case.dimension == 2:
        raise Refused("rotations in plane strain")
    arm = ngs.CF((ngs.x, ngs.y, ngs.z)) - ngs.CF(tuple(rotation.point))
    axis = ngs.CF(tuple(np.array(rotation.axis) / np.linalg.norm(rotation.axis)))
    angle = factor * rotation.angle
    across = arm - ngs.InnerProduct(arm, axis) * axis
    return (np.cos(angle) - 1.0) * across + np.sin(angle) * ngs.Cross(axis, arm)
