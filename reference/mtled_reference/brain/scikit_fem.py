"""The brain slice with scikit-fem: quadrilaterals Q2 / P1 discontinuous."""

import numpy as np
import scipy.sparse
import skfem

from ..scikit_fem.factorisation import Factorisation
from ..scikit_fem.solve import packages
from ..shared.case import Case
from ..shared.materials import THREE_FIELDS
from .body import read_body
from .quad_elements import QuadElements
from .quads import quads_from
from .run import SOLVER, TIME_SCHEME, Outline, solved_mesh
from .triangles import Sizes, triangulate

COARSEST = Sizes(far=0.022, outline=0.0065, border=0.0085, end=0.005, growth=0.4)
"""Sizes of the triangles [m]; the quadrilaterals are about half as wide."""
RATIO = 1.5


class Elements(QuadElements):
    """The quadrilaterals with direct solvers: one for each set of free unknowns, since a
    solver keeps the sparsity pattern."""

    def __init__(self, case: Case, quads):
        super().__init__(case, quads)
        self.factors = {}

    def factorised(self, matrix):
        """A function that solves with a symmetric matrix."""
        size = matrix.shape[0]
        if size not in self.factors:
            self.factors[size] = Factorisation()
        factors = self.factors[size]
        upper = scipy.sparse.triu(matrix, format="csr")
        upper.sort_indices()
        factors.factorise(upper)
        self.solver_name = factors.name
        return factors.solve


def solve_mesh(case: Case, level: int, progress) -> dict:
    """The result on the mesh of a level, as described in mtled_reference/solve.py."""
    body = read_body(case)
    sizes = COARSEST.scaled(RATIO**-level)
    quads = quads_from(triangulate(body, sizes))
    elements = Elements(case, quads)
    nodes = quads.outline[:, [0, 2, 1]]
    outline = Outline(
        nodes,
        np.array([0.0, 0.5, 1.0]),
        elements.positions[quads.outline],
        np.unique(quads.outline[quads.constrained]),
    )
    result = solved_mesh(case, body, elements, outline, level, progress)
    result["mesh"] = {"size_m": 0.5 * sizes.far, "elements": quads.mesh.nelements} | result["mesh"]
    result["solution"] = {
        "version": skfem.__version__,
        "formulation": f"{THREE_FIELDS}; ventricles u alone",
        "element": "Q2 / P1 discontinuous",
        "mesh_family": "three quadrilaterals per triangle, edges bent along the outline and the "
        "borders of the regions; finer there and at the ends of the craniotomy",
        "solver": f"{SOLVER}, {elements.solver_name}",
        "time_scheme": TIME_SCHEME,
        "packages": packages(),
    }
    return result
