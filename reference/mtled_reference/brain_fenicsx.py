"""The brain slice with FEniCSx: cubic triangles, displacements alone.

At ν = 0.49 cubic triangles do not lock noticeably, so that this element shares no
idea with the three fields of the other code.
"""

import numpy as np
import scipy.sparse as sp
import ufl
from dolfinx import fem
from petsc4py import PETSc
from scipy.spatial import cKDTree

from . import fenicsx_versions as versions
from .brain_body import Body, read_body
from .brain_record import SOLVER, TIME_SCHEME, Outline, solved_mesh
from .brain_triangles import Sizes, Triangles, triangulate
from .case import Case
from .materials import strain_energy

COARSEST = Sizes(far=0.02, outline=0.005, border=0.006, end=0.0035, growth=0.4)
"""Sizes of the triangles [m]."""
RATIO = 1.5
DEGREE = 3
QUADRATURE = 6
"""Degree of polynomials that the quadrature takes exactly."""


def quadratic_cells(triangles: Triangles) -> tuple[np.ndarray, np.ndarray]:
    """Points [m] and cells of order 2 in the order of Basix: corners, then the middles
    of the edges opposite to them; edges along curves follow these."""
    corners = triangles.corners
    edges = np.sort(corners[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2), axis=1)
    edges, number = np.unique(edges, axis=0, return_inverse=True)
    middles = triangles.points[edges].mean(axis=1)
    index = {tuple(edge): n for n, edge in enumerate(edges.tolist())}
    curved = [index[tuple(edge)] for edge in np.sort(triangles.curve_edges, axis=1).tolist()]
    middles[curved] = triangles.on_curves(0.5)
    cells = np.column_stack([corners, len(triangles.points) + number.reshape(-1, 3)])
    return np.vstack([triangles.points, middles]), cells


class Elements:
    """The triangles, as brain_motion.py and brain_record.py want them."""

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
        self._measure(case)
        self.made = []

    def _make_forms(self, case: Case) -> None:
        """∫ Σ χ_r ψ_r dV over the regions r, with χ_r = 1 in the cells of r."""
        dx = ufl.Measure("dx", self.domain, metadata={"quadrature_degree": QUADRATURE})
        h = ufl.grad(self.unknown)
        F = ufl.as_matrix([[1 + h[0, 0], h[0, 1], 0], [h[1, 0], 1 + h[1, 1], 0], [0, 0, 1]])
        C, J = F.T * F, ufl.det(F)
        first, second = ufl.tr(C), (ufl.tr(C) ** 2 - ufl.tr(C * C)) / 2
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

    def _measure(self, case: Case) -> None:
        """Shares of the nodes in the volumes of the regions [m³], and their centres [m]."""
        v = ufl.TestFunction(self.space)
        x = ufl.SpatialCoordinate(self.domain)
        self.shares, self.centres = [], []
        for chosen in self.of_region:
            volume = case.thickness * chosen
            share = versions.assemble_vector(fem.form(volume * v[0] * self.dx))[::2]
            moment = [
                fem.assemble_scalar(fem.form(volume * x[axis] * self.dx)) for axis in (0, 1)
            ]
            self.shares.append(share)
            self.centres.append(np.array(moment) / share.sum())

    def _csr(self, form, matrix) -> sp.csr_matrix:
        versions.assemble_matrix(matrix, form)
        starts, columns, entries = matrix.getValuesCSR()
        return sp.csr_matrix((entries.copy(), columns.copy(), starts.copy()), matrix.getSize())

    def force(self, u: np.ndarray) -> np.ndarray:
        """Inner forces [N]."""
        self.unknown.x.array[:] = u
        force = versions.assemble_vector(self.force_form)
        if not np.all(np.isfinite(force)):
            raise FloatingPointError("an element is turned inside out")
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
        """What solves with a matrix: LU by MUMPS. The factors before are given back."""
        for made in self.made:
            made.destroy()
        matrix.sort_indices()
        petsc = PETSc.Mat().createAIJ(
            matrix.shape, csr=(matrix.indptr, matrix.indices, matrix.data), comm=PETSc.COMM_SELF
        )
        solver = PETSc.KSP().create(PETSc.COMM_SELF)
        solver.setType("preonly")
        solver.getPC().setType("lu")
        solver.getPC().setFactorSolverType("mumps")
        solver.setOperators(petsc)
        solver.setUp()
        self.made = [solver, petsc]

        def solve(right):
            b, x = petsc.createVecs()
            b.array[:] = right
            solver.solve(b, x)
            answer = x.array.copy()
            b.destroy()
            x.destroy()
            return answer

        return solve


def outline_of(triangles: Triangles, elements: Elements) -> Outline:
    """The nodes along the outline, found by where they lie."""
    points, _ = quadratic_cells(triangles)
    ends = triangles.curve_edges[triangles.on_outline]
    middles = triangles.on_curves(0.5)[triangles.on_outline]
    geometry = np.stack([points[ends[:, 0]], points[ends[:, 1]], middles], axis=1)
    tree = cKDTree(elements.positions)
    for inner in (1 / 3, 0.5 * (1 - np.sqrt(0.2))):
        places = np.array([0.0, inner, 1 - inner, 1.0])
        shape = np.column_stack(
            [(1 - places) * (1 - 2 * places), places * (2 * places - 1), 4 * places * (1 - places)]
        )
        distance, nodes = tree.query(np.einsum("ma,kad->kmd", shape, geometry))
        if distance.max() < 1e-9:
            held = np.unique(nodes[triangles.held[triangles.on_outline]])
            return Outline(nodes, places, geometry, held)
    raise ValueError("the nodes along the outline are not where they should be")


def solve_mesh(case: Case, level: int, progress) -> dict:
    """Solves mesh `level` of the brain slice; see solve.py."""
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
