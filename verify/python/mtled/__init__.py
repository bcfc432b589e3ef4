"""Large deformations of soft tissue without a mesh, and how far they can be trusted.

>>> import mtled
>>> result = mtled.load("cube_compression").solve(error_bars=False)
>>> result.displacement_m.shape == result.nodes_m.shape
True
"""

from . import errors, problem
from ._mtled import Discretisation, __version__, schema
from .case import Case, bundled, load
from .errors import CaseError, DoubtfulWarning, ImageError, Mistake, MtledError, SetUpError, SolveError
from .protocol import Refused, Solver, solver
from .result import Picture, Result, WarpedImage
from .studies import Report, Sensitivities, budget, measure_solvers, sensitivity, study, tune, verify

__all__ = [
    "Case",
    "CaseError",
    "Discretisation",
    "DoubtfulWarning",
    "ImageError",
    "Mistake",
    "MtledError",
    "Picture",
    "Refused",
    "Report",
    "Result",
    "Sensitivities",
    "SetUpError",
    "SolveError",
    "Solver",
    "WarpedImage",
    "__version__",
    "budget",
    "bundled",
    "errors",
    "load",
    "measure_solvers",
    "problem",
    "schema",
    "sensitivity",
    "solver",
    "study",
    "tune",
    "verify",
]
