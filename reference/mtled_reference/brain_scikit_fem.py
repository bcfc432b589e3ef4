"""The brain slice with scikit-fem: quadrilaterals Q2 / P1 discontinuous."""

import platform

import numpy as np
import scipy
import scipy.sparse
import skfem

from .brain_body import read_body
from .brain_quads import quads_from
from .brain_record import SOLVER, TIME_SCHEME, Outline, solved_mesh
from .brain_scikit_fem_elements import QuadElements
from .brain_triangles import Sizes, triangulate
from .case import Case
from .scikit_fem_newton import Factorisation

COARSEST = Sizes(far=0.022, outline=0.0065, border=0.0085, end=0.005, growth=0.4)
"""Sizes of the triangles [m]; the quadrilaterals are about half as wide."""
RATIO = 1.5


class Elements(QuadElements):
    """The quadrilaterals with a direct solver; one for each set of free nodes, since
    the pattern of a matrix is analysed once."""

    def __init__(self, case: Case, quads):
        super().__init__(case, quads)
        self.factors = {}

    def factorised(self, matrix):
        """What solves with a symmetric matrix."""
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
    """Solves mesh `level` of the brain slice; see solve.py."""
    body = read_body(case)
    sizes = COARSEST.scaled(RATIO**-level)
    quads = quads_from(triangulate(body, sizes))
    elements = Elements(case, quads)
    nodes = quads.outline[:, [0, 2, 1]]
    outline = Outline(
        nodes,
        np.array([0.0, 0.5, 1.0]),
        elements.positions[quads.outline],
        np.unique(quads.outline[quads.held]),
    )
    result = solved_mesh(case, body, elements, outline, level, progress)
    result["mesh"] = {"size_m": 0.5 * sizes.far, "elements": quads.mesh.nelements} | result["mesh"]
    result["solution"] = {
        "version": skfem.__version__,
        "formulation": "three fields u, p, θ: ψ((θ/J)^(1/3) F) + p(J − θ); ventricles u alone",
        "element": "Q2 / P1 discontinuous",
        "mesh_family": "three quadrilaterals per triangle, edges bent along the outline and the "
        "borders of the regions; finer there and at the ends of the craniotomy",
        "solver": f"{SOLVER}, {elements.solver_name}",
        "time_scheme": TIME_SCHEME,
        "packages": {
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
        },
    }
    return result
