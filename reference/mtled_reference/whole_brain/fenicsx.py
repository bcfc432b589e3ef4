"""The whole brain with FEniCSx: Taylor–Hood tetrahedra P2 / P1 with a continuous pressure."""

from dataclasses import replace
from importlib import metadata

import numpy as np
import scipy.sparse as sp
import ufl
from dolfinx import fem
from scipy.spatial import cKDTree

from ..fenicsx import versions
from ..fenicsx.kinematics import Solid, invariants
from ..fenicsx.newton import Factors
from ..shared.case import Case
from ..shared.materials import strain_energy
from .mesh import Tetrahedra, smallest_determinant
from .run import solved_mesh

BASIX = [0, 1, 2, 3, 9, 8, 5, 7, 6, 4]
"""The nodes of a cell in the order of Basix: corners, then the edges 23, 13, 12, 03, 02, 01."""
QUADRATURE = 4
"""Degree of polynomials that the quadrature takes exactly."""
IDLE = 1e-6
"""Compressibility of the pressure in compressible regions, where it does nothing, over that of
nearly incompressible ones [–]."""


class Elements:
    """The tetrahedra with the energy ∫ ψ_iso(F) + p(J − 1) − p²/2K dV, where ψ_iso has no
    volumetric part; ventricles in displacements alone. Unknowns are u of all nodes of the mesh,
    x, y and z of each in turn, then p."""

    def __init__(self, case: Case, mesh: Tetrahedra):
        self.mesh, self.kinematics = mesh, Solid()
        self.domain = versions.create_mesh("tetrahedron", 2, mesh.nodes, mesh.cells[:, BASIX])
        self.space = versions.function_space(
            self.domain, versions.vector_element("tetrahedron", 2, 3)
        )
        self.pressures = versions.function_space(self.domain, ("Lagrange", 1))
        self.u, self.p = fem.Function(self.space), fem.Function(self.pressures)
        nodes = cKDTree(mesh.nodes).query(self.space.tabulate_dof_coordinates())[1]
        self.dofs = (3 * nodes[:, None] + np.arange(3)).ravel()
        if np.any(np.sort(self.dofs) != np.arange(mesh.nodes.size)):
            raise ValueError("the nodes of the mesh were not found again")
        order = np.argsort(self.dofs)
        self.permutation = sp.csr_matrix((np.ones(order.size), (np.arange(order.size), order)))
        self.cell_space = versions.function_space(self.domain, ("DG", 0))
        centres = self.cell_space.tabulate_dof_coordinates()
        middles = mesh.nodes[mesh.cells[:, :4]].mean(axis=1)
        self.region = mesh.region[cKDTree(middles).query(centres)[1]]
        self._make_forms(case)
        self._measure_regions(case)

    def _make_forms(self, case: Case) -> None:
        dx = ufl.Measure("dx", self.domain, metadata={"quadrature_degree": QUADRATURE})
        u, p = self.u, self.p
        first, second, J = invariants(self.kinematics.deformation_gradient(u, self.domain))
        self.of_region = [fem.Function(self.cell_space) for _ in case.regions]
        energy, stored = 0, 0
        stiffest = max(region.material.bulk_modulus for region in case.regions)
        for index, (region, chosen) in enumerate(zip(case.regions, self.of_region)):
            chosen.x.array[:] = self.region == index
            material, bulk = region.material, region.material.bulk_modulus
            if material.is_nearly_incompressible:
                free = replace(material, bulk_modulus=0.0)
                psi = strain_energy(free, first, second, J, ufl.ln)
                energy += chosen * (psi + p * (J - 1) - p**2 / (2 * bulk))
                stored += chosen * (psi + p**2 / (2 * bulk))
            else:
                psi = strain_energy(material, first, second, J, ufl.ln)
                energy += chosen * (psi - IDLE * p**2 / (2 * stiffest))
                stored += chosen * psi
        v, q = ufl.TestFunction(self.space), ufl.TestFunction(self.pressures)
        w, r = ufl.TrialFunction(self.space), ufl.TrialFunction(self.pressures)
        residuals = [ufl.derivative(energy * dx, u, v), ufl.derivative(energy * dx, p, q)]
        self.residuals = [versions.form(residual) for residual in residuals]
        pairs = {"uu": (0, u, w), "pu": (1, u, w), "pp": (1, p, r)}
        self.blocks = {
            name: versions.form(ufl.derivative(residuals[row], by, trial))
            for name, (row, by, trial) in pairs.items()
        }
        self.matrices = {name: versions.new_matrix(form) for name, form in self.blocks.items()}
        self.stored = versions.form(stored * dx)
        self.dx = dx

    def _measure_regions(self, case: Case) -> None:
        v = ufl.TestFunction(self.space)
        volumes = [
            versions.assemble_vector(versions.form(chosen * v[0] * self.dx))[::3]
            for chosen in self.of_region
        ]
        self.node_volumes = np.zeros((len(volumes), len(self.mesh.nodes)))
        self.node_volumes[:, self.dofs[::3] // 3] = volumes
        self.node_volumes_3 = np.repeat(self.node_volumes.sum(axis=0), 3)

    def _set(self, unknowns: np.ndarray) -> None:
        n = self.mesh.nodes.size
        self.u.x.array[:] = unknowns[:n][self.dofs]
        self.p.x.array[:] = unknowns[n:]

    def at_rest(self) -> np.ndarray:
        """The unknowns without load."""
        return np.zeros(self.mesh.nodes.size + len(self.p.x.array))

    def force(self, unknowns: np.ndarray) -> np.ndarray:
        """Internal forces [N] and, after them, the residuals of p [m³]."""
        self._set(unknowns)
        force = np.zeros(len(unknowns))
        force[self.dofs] = versions.assemble_vector(self.residuals[0])
        force[self.mesh.nodes.size :] = versions.assemble_vector(self.residuals[1])
        if not np.all(np.isfinite(force)):
            raise FloatingPointError("an element is inverted")
        return force

    def _block(self, name: str) -> sp.csr_matrix:
        matrix = self.matrices[name]
        versions.assemble_matrix(matrix, self.blocks[name])
        starts, columns, entries = matrix.getValuesCSR()
        return sp.csr_matrix((entries.copy(), columns.copy(), starts.copy()), matrix.getSize())

    def stiffness(self, unknowns: np.ndarray) -> sp.csr_matrix:
        """∂force/∂unknowns."""
        self._set(unknowns)
        P = self.permutation
        across = self._block("pu") @ P.T
        blocks = [[P @ self._block("uu") @ P.T, across.T], [across, self._block("pp")]]
        return sp.bmat(blocks, format="csr")

    def energy(self, unknowns: np.ndarray) -> float:
        """Strain energy [J]."""
        self._set(unknowns)
        return float(fem.assemble_scalar(self.stored))

    def smallest_J(self, unknowns: np.ndarray) -> float:
        """Smallest det F at the corners and the centres of the cells [–]."""
        return smallest_determinant(self.mesh, unknowns[: self.mesh.nodes.size].reshape(-1, 3))

    def solved(self, matrix: sp.csr_matrix, right: np.ndarray) -> np.ndarray:
        """The solution of a symmetric system."""
        factors = Factors(matrix, "cholesky")
        answer = factors.solve(right)
        factors.release()
        return answer


def provenance(method: dict) -> dict:
    """How the case was solved; `method` is what both codes have in common."""
    return {
        "version": versions.version(),
        "formulation": "two fields u, p: ψ_iso(F) + p(J − 1) − p²/2K; ventricles u alone",
        "element": "P2 / P1 continuous",
        "mesh_family": method["mesh_family"],
        "solver": f"{method['solver']}, MUMPS",
        "packages": versions.packages() | {"tetgen": metadata.version("tetgen")},
    }


def solve_mesh(case: Case, level: int, progress) -> dict:
    """The result on the mesh of a level, as described in mtled_reference/solve.py."""
    result = solved_mesh(case, level, Elements, progress)
    return result | {"solution": provenance(result["solution"])}
