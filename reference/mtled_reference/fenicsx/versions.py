"""Functions of DOLFINx whose names or arguments changed between releases 0.5 and 0.10."""

import inspect
import platform

import dolfinx
import numpy as np
import petsc4py
import ufl
from dolfinx import fem, mesh
from dolfinx.fem import petsc as fem_petsc  # noqa: F401  (loads dolfinx.fem.petsc on new releases)
from mpi4py import MPI
from petsc4py import PETSc

from ..shared.resources import processor_time

HAS_UFL_ELEMENTS = hasattr(ufl, "VectorElement")
"""Elements come from UFL up to DOLFINx 0.6, later from Basix."""

_compile_seconds = 0.0


def form(expression, flags: tuple[str, ...] = ()):
    """The compiled form of an expression, with flags of the C compiler."""
    global _compile_seconds
    start = processor_time()
    options = {"cffi_extra_compile_args": list(flags)} if flags else {}
    name = "jit_params" if "jit_params" in inspect.signature(fem.form).parameters else "jit_options"
    compiled = fem.form(expression, **{name: options})
    _compile_seconds += processor_time() - start
    return compiled


def compile_seconds() -> float:
    """Processor time [s] of all forms so far, including that of the C compiler."""
    return _compile_seconds


def vector_element(cell: str, degree: int, size: int):
    """Lagrange element of the degree with `size` components."""
    if HAS_UFL_ELEMENTS:
        return ufl.VectorElement("Lagrange", cell, degree, dim=size)
    import basix.ufl

    return basix.ufl.element("Lagrange", cell, degree, shape=(size,))


def discontinuous_element(cell: str, degree: int = 1):
    """Complete polynomials of the degree inside each cell."""
    family = "DPC" if cell in ("quadrilateral", "hexahedron") else "DG"
    if HAS_UFL_ELEMENTS:
        return ufl.FiniteElement(family, cell, degree)
    import basix.ufl

    return basix.ufl.element(family, cell, degree)


def mixed_element(elements: list):
    """The mixed element of several elements."""
    if HAS_UFL_ELEMENTS:
        return ufl.MixedElement(elements)
    import basix.ufl

    return basix.ufl.mixed_element(elements)


def function_space(domain, element):
    """The function space of an element, or of a pair (family, degree)."""
    if hasattr(fem, "functionspace"):
        return fem.functionspace(domain, element)
    return fem.FunctionSpace(domain, element)


def create_mesh(cell: str, order: int, points: np.ndarray, cells: np.ndarray):
    """A mesh of Lagrange cells from points (n, d) [m] and the numbers of the points of
    each cell, in the order of Basix."""
    size = points.shape[1]
    if HAS_UFL_ELEMENTS:
        kind = ufl.Cell(cell, geometric_dimension=size)
        domain = ufl.Mesh(ufl.VectorElement("Lagrange", kind, order))
    else:
        domain = ufl.Mesh(vector_element(cell, order, size))
    name = "domain" if "domain" in inspect.signature(mesh.create_mesh).parameters else "e"
    cells = np.ascontiguousarray(cells, dtype=np.int64)
    return mesh.create_mesh(
        MPI.COMM_SELF, cells=cells, x=np.ascontiguousarray(points), **{name: domain}
    )


def exterior_facets(domain) -> np.ndarray:
    """Numbers of the facets that belong to one cell only."""
    topology = domain.topology
    topology.create_connectivity(topology.dim - 1, topology.dim)
    topology.create_connectivity(topology.dim, topology.dim - 1)
    return mesh.exterior_facet_indices(topology)


def geometry_nodes(domain) -> np.ndarray:
    """Numbers of the geometry nodes of each cell (cells, nodes)."""
    nodes = domain.geometry.dofmap
    if hasattr(nodes, "array"):
        nodes = (
            nodes.array.reshape(len(nodes), -1)
            if hasattr(nodes, "__len__")
            else (nodes.array.reshape(nodes.num_nodes, -1))
        )
    return np.asarray(nodes)


def new_matrix(form):
    """A zero matrix with the sparsity pattern of a bilinear form."""
    return fem_petsc.create_matrix(form)


def assemble_matrix(matrix, form) -> None:
    """Assembles a bilinear form into the matrix, without boundary conditions."""
    matrix.zeroEntries()
    fem_petsc.assemble_matrix(matrix, form)
    matrix.assemble()


def assemble_vector(form) -> np.ndarray:
    """The vector of a linear form, as an array."""
    vector = fem_petsc.assemble_vector(form)
    vector.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
    array = vector.array.copy()
    vector.destroy()
    return array


def version() -> str:
    """That of DOLFINx."""
    return dolfinx.__version__


def packages() -> dict[str, str]:
    """Versions that a result may depend on."""
    petsc = ".".join(str(part) for part in PETSc.Sys.getVersion())
    return {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "petsc": petsc,
        "petsc4py": petsc4py.__version__,
        "ufl": getattr(ufl, "__version__", "unknown"),
    }
