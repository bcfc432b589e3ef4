"""A case on a mesh: elements, supports, loads and assembly."""

import numpy as np
import scipy.sparse as sparse
import skfem

from ..shared.case import Case, Prescription, Region
from ..shared.selection import selected
from .kernel import Elements, evaluate
from .pressures import Following, following
from .symmetry import Plane

ELEMENTS = {
    (2, 1): skfem.ElementQuad1,
    (2, 2): skfem.ElementQuad2,
    (3, 1): skfem.ElementHex1,
    (3, 2): skfem.ElementHex2,
}
"""Elements by dimension and degree."""

BATCH = 128
"""Number of elements evaluated at a time."""

ON_BOUNDARY = 1e-6
"""Tolerance of selections over the size of the body [–]."""


class Model:
    """Nodes, elements by material, supports and loads of a case on a mesh.

    In plane strain volumes and forces are those of the whole thickness. `degree` is that
    of u; `three_fields` is whether p and θ are independent fields, None if each
    material decides.
    """

    def __init__(
        self,
        case: Case,
        mesh: skfem.Mesh,
        symmetry: list[Plane],
        degree: int = 2,
        three_fields: bool | None = None,
    ):
        self.case, self.mesh, self.symmetry = case, mesh, symmetry
        self.d, self.degree, self.three_fields = mesh.dim(), degree, three_fields
        # One more Gauss point along each direction than the degree.
        self.basis = skfem.CellBasis(mesh, ELEMENTS[self.d, degree](), intorder=2 * degree)
        self.nodes = self.basis.doflocs.T.copy()
        self.tolerance = ON_BOUNDARY * np.ptp(self.nodes, axis=0).max()
        self.elements = self._elements()
        self.masses = {region.name: self._mass(n) for n, region in enumerate(case.regions)}
        self.boundary = self._boundary_facets()
        self.supports = {p.name: self.support_nodes(p) for p in case.prescriptions}
        self.fixed = self._fixed()
        self.free = ~self.fixed.ravel()
        self.following, self.fraction = following(self), 1.0
        loaded = [self.following] if self.following else []
        self.pattern = _Pattern([*self.elements, *loaded], self.free, self.d)

    def _elements(self) -> list[Elements]:
        """Elements by region; `self.owners` has the region of each element."""
        basis = self.basis
        centres = self.case.positions(np.asarray(basis.global_coordinates()).mean(axis=2).T)
        self.owners = np.full(len(centres), -1)
        for n, region in enumerate(self.case.regions):
            here = selected(region.selector, centres, self.tolerance)
            self.owners[(self.owners < 0) & here] = n
        if np.any(self.owners < 0):
            raise ValueError("an element belongs to no region")
        gradients = np.stack([b[0].grad.transpose(1, 2, 0) for b in basis.basis], axis=2)
        volumes = basis.dx * self.case.thickness
        linear = self._pressure_functions() if self.is_mixed else None
        groups = []
        for n, region in enumerate(self.case.regions):
            mine = np.flatnonzero(self.owners == n)
            mixed = self._is_mixed(region)
            groups.append(
                Elements(
                    region.material,
                    basis.element_dofs.T[mine],
                    gradients[mine],
                    volumes[mine],
                    linear[mine] if mixed else None,
                )
            )
        return groups

    @property
    def is_mixed(self) -> bool:
        """Whether a region has three fields u, p, θ."""
        return any(map(self._is_mixed, self.case.regions))

    def _is_mixed(self, region: Region) -> bool:
        if self.three_fields is not None:
            return self.three_fields
        return region.material.is_nearly_incompressible

    def _pressure_functions(self) -> np.ndarray:
        """Linear functions of p and θ: 1 and the scaled coordinates from the centre of the
        element, (e, q, 1 + d); only 1, (e, q, 1), where u is linear."""
        points = np.asarray(self.basis.global_coordinates()).transpose(1, 2, 0)
        if self.degree == 1:
            return np.ones_like(points[..., :1])
        arms = points - points.mean(axis=1, keepdims=True)
        arms /= np.abs(arms).max(axis=(1, 2), keepdims=True)
        return np.concatenate([np.ones_like(arms[..., :1]), arms], axis=2)

    def _mass(self, region: int) -> sparse.csr_matrix:
        """Consistent mass ∫ ρ N_a N_b dV of a region [kg], for one component."""
        mine = self.owners == region
        whole = [np.broadcast_to(b[0], self.basis.dx.shape) for b in self.basis.basis]
        shapes = np.stack(whole)[:, mine]
        density = self.case.regions[region].material.density
        masses = density * self.case.thickness * self.basis.dx[mine]
        blocks = np.einsum("aeq,eq,beq->eab", shapes, masses, shapes, optimize=True)
        nodes = self.basis.element_dofs.T[mine]
        rows = np.repeat(nodes[:, :, None], nodes.shape[1], axis=2)
        columns = rows.swapaxes(1, 2)
        shape = (len(self.nodes), len(self.nodes))
        return sparse.coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape).tocsr()

    @property
    def mass(self) -> sparse.csr_matrix:
        """Consistent mass of the body [kg], for one component."""
        return sum(self.masses.values())

    def _boundary_facets(self) -> tuple[np.ndarray, np.ndarray]:
        """Boundary facets off the symmetry planes, and the nodes on each (n, k)."""
        mesh, basis = self.mesh, self.basis
        facets = mesh.boundary_facets()
        corners = basis.nodal_dofs[0, mesh.facets[:, facets]].T
        nodes = [corners]
        if self.degree == 2:
            nodes.append(basis.facet_dofs[0, facets][:, None])
        if self.degree == 2 and self.d == 3:
            nodes.append(basis.edge_dofs[0, mesh.f2e[:, facets]].T)
        nodes = np.concatenate(nodes, axis=1)
        cut = np.zeros(len(facets), dtype=bool)
        for axis, coordinate in self.symmetry:
            cut |= np.all(np.abs(self.nodes[nodes, axis] - coordinate) < self.tolerance, axis=1)
        return facets[~cut], nodes[~cut]

    def facets_in(self, selector) -> tuple[np.ndarray, np.ndarray]:
        """Boundary facets with all nodes in a selection, and these nodes."""
        facets, nodes = self.boundary
        inside = selected(selector, self.case.positions(self.nodes), self.tolerance)
        whole = inside[nodes].all(axis=1)
        return facets[whole], nodes[whole]

    def support_nodes(self, prescription: Prescription) -> np.ndarray:
        """Nodes that a prescription constrains."""
        if prescription.of == "surface":
            nodes = np.unique(self.facets_in(prescription.selector)[1])
        else:
            positions = self.case.positions(self.nodes)
            nodes = np.flatnonzero(selected(prescription.selector, positions, self.tolerance))
        if not len(nodes):
            raise ValueError(f"the condition {prescription.name} constrains no node")
        return nodes

    def _fixed(self) -> np.ndarray:
        """Whether each component of each node is prescribed, (n, d)."""
        fixed = np.zeros(self.nodes.shape, dtype=bool)
        for prescription in self.case.prescriptions:
            for component in prescription.components(self.d):
                fixed[self.supports[prescription.name], component] = True
        for axis, coordinate in self.symmetry:
            fixed[np.abs(self.nodes[:, axis] - coordinate) < self.tolerance, axis] = True
        return fixed

    def prescribed(self, factor_of) -> np.ndarray:
        """Prescribed displacements (n, d) [m], 0 elsewhere; `factor_of` maps an amplitude to
        its factor."""
        values = np.zeros(self.nodes.shape)
        for prescription in self.case.prescriptions:
            nodes = self.supports[prescription.name]
            positions = self.case.positions(self.nodes[nodes])
            moved = prescription.values(positions, factor_of(prescription.amplitude))
            for component in prescription.components(self.d):
                values[nodes, component] = moved[:, component]
        return values

    def loads(self, factor_of) -> np.ndarray:
        """Nodal forces (n, d) [N] of body forces and tractions."""
        forces = np.zeros(self.nodes.shape)
        nodal_masses = np.asarray(self.mass.sum(axis=1)).ravel()
        for body in self.case.uniform_body_forces():
            acceleration = factor_of(body.amplitude) * np.array(body.acceleration[: self.d])
            forces += nodal_masses[:, None] * acceleration
        for traction in self.case.tractions:
            facets, _ = self.facets_in(traction.selector)
            if not len(facets):
                raise ValueError(f"the traction {traction.name} acts on no facet")
            surface = skfem.FacetBasis(self.mesh, self.basis.elem, facets=facets, intorder=4)
            area = skfem.LinearForm(lambda v, _: v).assemble(surface) * self.case.thickness
            force = factor_of(traction.amplitude) * np.array(traction.traction[: self.d])
            forces += area[:, None] * force
        return forces

    def internal(self, u: np.ndarray, with_tangent: bool = False, along: np.ndarray | None = None):
        """Strain energy [J] and internal forces (n, d) [N] at displacements u, with those of a
        fraction of the pressures that follow the body; on request
        also the upper triangle of the tangent at the free unknowns, and the product of
        the whole tangent with `along`."""
        energy, forces = 0.0, np.zeros(self.nodes.shape)
        product = np.zeros(self.nodes.shape)
        blocks = []
        for group in self.elements:
            for start in range(0, len(group.nodes), BATCH):
                part = group.part(start, start + BATCH)
                state = evaluate(part, u, with_tangent)
                energy += state.energy.sum()
                scatter(forces, part.nodes, state.residual)
                if with_tangent:
                    blocks.append(self.pattern.upper(state.tangent))
                    if along is not None:
                        moved = along[part.nodes].reshape(len(part.nodes), -1, 1)
                        change = np.matmul(state.tangent, moved).reshape(state.residual.shape)
                        scatter(product, part.nodes, change)
        if self.following:
            pressures, part = self.following, self.fraction * self.following.matrices
            scatter(forces, pressures.nodes, pressures.forces(part, self.nodes + u))
            if with_tangent:
                blocks.append(self.pattern.upper(part))
                if along is not None:
                    scatter(product, pressures.nodes, pressures.forces(part, along))
        if not with_tangent:
            return energy, forces
        return energy, forces, self.pattern.assemble(np.concatenate(blocks)), product


def scatter(total: np.ndarray, nodes: np.ndarray, contributions: np.ndarray) -> None:
    """Adds contributions (e, a, d) of elements to their nodes (e, a)."""
    for component in range(total.shape[1]):
        total[:, component] += np.bincount(
            nodes.ravel(), contributions[..., component].ravel(), minlength=len(total)
        )


class _Pattern:
    """The sparsity pattern of the upper triangle of the matrix of free unknowns, and the
    positions of the entries of element matrices in it."""

    def __init__(self, elements: list[Elements | Following], free: np.ndarray, d: int):
        number = np.where(free, np.cumsum(free) - 1, -1)
        nodes = np.concatenate([group.nodes for group in elements])
        unknowns = number[(d * nodes[:, :, None] + np.arange(d)).reshape(len(nodes), -1)]
        self.rows, self.columns = np.triu_indices(unknowns.shape[1])
        row, column = unknowns[:, self.rows], unknowns[:, self.columns]
        self.size = int(free.sum())
        low, high = np.minimum(row, column), np.maximum(row, column)
        key = np.where(low < 0, -1, low.astype(np.int64) * self.size + high)
        unique, slots = np.unique(key.ravel(), return_inverse=True)
        self.dropped = int(unique[0] < 0)
        unique = unique[self.dropped :]
        self.slots = slots.ravel().astype(np.int32)
        self.count = len(unique) + self.dropped
        self.indices = (unique % self.size).astype(np.int32)
        starts = np.searchsorted(unique // self.size, np.arange(self.size + 1))
        self.indptr = starts.astype(np.int32)

    def upper(self, tangents: np.ndarray) -> np.ndarray:
        """The upper triangles (e, k) of element matrices."""
        return tangents[:, self.rows, self.columns]

    def assemble(self, blocks: np.ndarray) -> sparse.csr_matrix:
        """The upper triangle of the matrix from those of the element matrices."""
        data = np.bincount(self.slots, blocks.ravel(), minlength=self.count)[self.dropped :]
        return sparse.csr_matrix((data, self.indices, self.indptr), (self.size, self.size))
