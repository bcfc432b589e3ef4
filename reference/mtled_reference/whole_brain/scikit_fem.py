"""The whole brain with scikit-fem: tetrahedra P2, constant p and θ."""

from importlib import metadata

import numpy as np
import scipy.sparse as sp
import skfem
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet

from ..scikit_fem.factorisation import Factorisation
from ..scikit_fem.kernel import Elements as Batch
from ..scikit_fem.kernel import evaluate
from ..scikit_fem.solve import packages
from ..shared.case import Case
from ..shared.materials import THREE_FIELDS
from .mesh import Tetrahedra, quadratic
from .run import solved_mesh

ORDER = 2
"""Degree of polynomials that the quadrature takes exactly, with four points."""
BATCH = 3000
"""Elements evaluated at a time."""


class Elements:
    """The tetrahedra of all regions with their forces and stiffness."""

    def __init__(self, case: Case, mesh: Tetrahedra):
        self.mesh = mesh
        at, weights = get_quadrature(RefTet, ORDER)
        values, slopes = quadratic(at.T)
        self.batches = []
        self.node_volumes = np.zeros((len(case.regions), len(mesh.nodes)))
        for index, region in enumerate(case.regions):
            cells = mesh.cells[mesh.region == index]
            jacobian = np.einsum("qaj,eai->eqij", slopes, mesh.nodes[cells], optimize=True)
            volumes = np.linalg.det(jacobian) * weights
            inverse = np.linalg.inv(jacobian)
            gradients = np.einsum("qaj,eqji->eqai", slopes, inverse, optimize=True)
            np.add.at(self.node_volumes[index], cells, np.einsum("eq,qa->ea", volumes, values))
            constant = np.ones((*volumes.shape, 1))
            functions = constant if region.material.is_nearly_incompressible else None
            whole = Batch(region.material, cells, gradients, volumes, functions)
            self.batches += [whole.part(n, n + BATCH) for n in range(0, len(cells), BATCH)]
        self.node_volumes_3 = np.repeat(self.node_volumes.sum(axis=0), 3)
        self.factors, self.pattern = Factorisation(), None

    def at_rest(self) -> np.ndarray:
        """The unknowns without load."""
        return np.zeros(self.mesh.nodes.size)

    def force(self, u: np.ndarray) -> np.ndarray:
        """Internal forces [N]."""
        force = np.zeros_like(self.mesh.nodes)
        for batch in self.batches:
            np.add.at(force, batch.nodes, evaluate(batch, u.reshape(-1, 3), False).residual)
        return force.ravel()

    def energy(self, u: np.ndarray) -> float:
        """Strain energy [J]."""
        field = u.reshape(-1, 3)
        return float(sum(evaluate(batch, field, False).energy.sum() for batch in self.batches))

    def stiffness(self, u: np.ndarray) -> sp.csr_matrix:
        """∂force/∂u [N/m]."""
        size = self.mesh.nodes.size
        total = sp.csr_matrix((size, size))
        for batch in self.batches:
            tangent = evaluate(batch, u.reshape(-1, 3), True).tangent
            dofs = (3 * batch.nodes[:, :, None] + np.arange(3)).reshape(len(batch.nodes), -1)
            rows = np.repeat(dofs, dofs.shape[1], axis=1).ravel()
            columns = np.tile(dofs, dofs.shape[1]).ravel()
            total = total + sp.csr_matrix((tangent.ravel(), (rows, columns)), (size, size))
        return total

    def smallest_J(self, u: np.ndarray) -> float:
        """Smallest det F at the quadrature points [–]."""
        field, smallest = u.reshape(-1, 3), np.inf
        for batch in self.batches:
            F = np.einsum("eak,eqai->eqki", field[batch.nodes], batch.gradients, optimize=True)
            smallest = min(smallest, np.linalg.det(F + np.eye(3)).min())
        return float(smallest)

    def solved(self, matrix: sp.csr_matrix, right: np.ndarray) -> np.ndarray:
        """The solution of a symmetric system. The contact changes the pattern, so that each
        matrix is analysed anew."""
        self.factors.release()
        self.factors = Factorisation()
        upper = sp.triu(matrix, format="csr")
        upper.sort_indices()
        self.factors.factorise(upper)
        return self.factors.solve(right)


def provenance(method: dict) -> dict:
    """How the case was solved; `method` is what both codes have in common."""
    return {
        "version": skfem.__version__,
        "formulation": f"{THREE_FIELDS}; ventricles u alone",
        "element": "P2 / P0",
        "mesh_family": method["mesh_family"],
        "solver": f"{method['solver']}, {Factorisation().name}",
        "packages": packages() | {"tetgen": metadata.version("tetgen")},
    }


def solve_mesh(case: Case, level: int, progress) -> dict:
    """The result on the mesh of a level, as described in mtled_reference/solve.py."""
    result = solved_mesh(case, level, Elements, progress)
    return result | {"solution": provenance(result["solution"])}
