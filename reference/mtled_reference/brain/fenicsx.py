"""The brain slice with FEniCSx: cubic triangles, displacements alone.

At ν = 0.49 cubic triangles lock only slightly, so that this code needs no three fields
and differs in formulation from the other one.
"""

import numpy as np
import scipy.sparse as sp
import ufl
from dolfinx import fem
from scipy.spatial import cKDTree

from ..fenicsx import versions
from ..fenicsx.kinematics import PlaneStrain, invariants
from ..fenicsx.newton import Factors
from ..shared.case import Case
from ..shared.materials import strain_energy
from .body import read_body
from .contact import quadratic
from .run import SOLVER, TIME_SCHEME, Outline, solved_mesh
from .triangles import Sizes, Triangles, triangulate

COARSEST = Sizes(far=0.02, outline=0.005, border=0.006, end=0.0035, growth=0.4)
"""Sizes of the triangles [m]."""
RATIO = 1.5
DEGREE = 3
QUADRATURE = 6
"""Degree of polynomials that the quadrature takes exactly."""


def quadratic_cells(triangles: Triangles) -> tuple[np.ndarray, np.ndarray]:
    """Points [m] and cells of order 2 in the order of Basix: corners, then the midpoints
    of the edges opposite to them."""
    midpoints, numbers, _ = triangles.midpoints()
    opposite = len(triangles.points) + numbers[:, [1, 2, 0]]
    return np.vstack([triangles.points, midpoints]), np.column_stack([triangles.corners, opposite])


class Elements:
    """The triangles, with what `run` in run.py needs."""

    def __init__(self, case: Case, triangles: Triangles):
        points, cells = quadratic_cells(triangles)
        self.domain = versions.create_mesh("triangle", 2, points, cells)
        element = versions.vector_element("triangle", DEGREE, 2)
        self.space = versions.function_space(self.domain, element)
        self.unknown = fem.Function(self.space)
        self.positions = self.space.tabulate_dof_coordinates()[:, :2].copy()
        self.cell_space = versions.function_space(self.domain, ("DG", 0))
        middles = triangles.points[triangles.corners].mean(axis=1)
        centres = self.cell_space.tabulate_dof_coordinates()[:, :2]
        self.region = triangles.region[cKDTree(middles).query(centres)[1]]
        self._make_forms(case)
        self._measure_regions(case)
        self.factors = None

    def _make_forms(self, case: Case) -> None:
        """∫ Σ χ_r ψ_r dV over the regions r, with χ_r = 1 in the cells of r."""
        dx = ufl.Measure("dx", self.domain, metadata={"quadrature_degree": QUADRATURE})
        kinematics = PlaneStrain(case.thickness, case.plane_z)
        F = kinematics.deformation_gradient(self.unknown, self.domain)
        first, second, J = invariants(F)
        self.of_region = [fem.Function(self.cell_space) for _ in case.regions]
        psi, density = 0, 0
        for index, (region, chosen) in enumerate(zip(case.regions, self.of_region)):
            chosen.x.array[:] = self.region == index
            psi += chosen * strain_energy(region.material, first, second, J, ufl.ln)
            density += chosen * region.material.density
        energy = case.thickness * psi * dx
        residual = ufl.derivative(energy, self.unknown)
        v, w = ufl.TestFunction(self.space), ufl.TrialFunction(self.space)
        self.energy_form = fem.form(energy)
        self.force_form = fem.form(residual)
        self.stiffness_form = fem.form(ufl.derivative(residual, self.unknown))
        self.matrix = versions.new_matrix(self.stiffness_form)
        mass = fem.form(case.thickness * density * ufl.inner(v, w) * dx)
        self.mass = self._csr(mass, versions.new_matrix(mass))
        self.dx = dx

    def _measure_regions(self, case: Case) -> None:
        """Volumes of the nodes in the regions [m³], and the centres of the regions [m]."""
        v = ufl.TestFunction(self.space)
        x = ufl.SpatialCoordinate(self.domain)
        self.node_volumes, self.centres = [], []
        for chosen in self.of_region:
            volume = case.thickness * chosen
            volumes = versions.assemble_vector(fem.form(volume * v[0] * self.dx))[::2]
            moment = [fem.assemble_scalar(fem.form(volume * x[axis] * self.dx)) for axis in (0, 1)]
            self.node_volumes.append(volumes)
            self.centres.append(np.array(moment) / volumes.sum())

    def _csr(self, form, matrix) -> sp.csr_matrix:
        versions.assemble_matrix(matrix, form)
        starts, columns, entries = matrix.getValuesCSR()
        return sp.csr_matrix((entries.copy(), columns.copy(), starts.copy()), matrix.getSize())

    def force(self, u: np.ndarray) -> np.ndarray:
        """Internal forces [N]."""
        self.unknown.x.array[:] = u
        force = versions.assemble_vector(self.force_form)
        if not np.all(np.isfinite(force)):
            raise FloatingPointError("an element is inverted")
        return force

    def stiffness(self, u: np.ndarray) -> sp.csr_matrix:
        """∂force/∂u [N/m]."""
        self.unknown.x.array[:] = u
        return self._csr(self.stiffness_form, self.matrix)

    def energy(self, u: np.ndarray) -> float:
        """Strain energy [J]."""
        self.unknown.x.array[:] = u
        return float(fem.assemble_scalar(self.energy_form))

    def factorised(self, matrix: sp.csr_matrix):
        """A function that solves with a matrix; that of the last matrix becomes invalid."""
        if self.factors:
            self.factors.release()
        self.factors = Factors(matrix, "lu")
        return self.factors.solve


def outline_of(triangles: Triangles, elements: Elements) -> Outline:
    """The nodes along the outline, found by their positions."""
    points, _ = quadratic_cells(triangles)
    ends = triangles.curve_edges[triangles.on_outline]
    middles = triangles.on_curves(0.5)[triangles.on_outline]
    geometry = np.stack([points[ends[:, 0]], points[ends[:, 1]], middles], axis=1)
    tree = cKDTree(elements.positions)
    for inner in (1 / 3, 0.5 * (1 - np.sqrt(0.2))):
        places = np.array([0.0, inner, 1 - inner, 1.0])
        shapes, _ = quadratic(places)
        distance, nodes = tree.query(np.einsum("ma,kad->kmd", shapes, geometry))
        if distance.max() < 1e-9:
            constrained = np.unique(nodes[triangles.constrained[triangles.on_outline]])
            return Outline(nodes, places, geometry, constrained)
    raise ValueError("the mesh has no known distribution of nodes along the outline")


def solve_mesh(case: Case, level: int, progress) -> dict:
    """The result on the mesh of a level, as described in mtled_reference/solve.py."""
    body = read_body(case)
    sizes = COARSEST.scaled(RATIO**-level)
    triangles = triangulate(body, sizes)
    elements = Elements(case, triangles)
    outline = outline_of(triangles, elements)
    result = solved_mesh(case, body, elements, outline, level, progress)
    count = len(triangles.corners)
    result["mesh"] = {"size_m": sizes.far, "elements": count} | result["mesh"]
    result["solution"] = {
        "version": versions.version(),
        "formulation": "displacement",
        "element": "P3 on triangles of order 2",
        "mesh_family": "triangles, edges bent along the outline and the borders of the regions; "
        "finer there and at the ends of the craniotomy",
        "solver": f"{SOLVER}, MUMPS",
        "time_scheme": TIME_SCHEME,
        "packages": versions.packages(),
    }
    return result
