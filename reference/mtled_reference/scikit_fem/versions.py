"""Versions of the packages that a result may depend on."""

import platform

import numpy as np
import scipy
import skfem


def packages() -> dict[str, str]:
    """Versions of Python and the packages by name."""
    return {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "scikit-fem": skfem.__version__,
    }
