"""The sparse direct solver."""

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg

try:
    import pypardiso
except ImportError:
    pypardiso = None


class Factorisation:
    """LDLᵀ of a symmetric matrix given by its upper triangle: by PARDISO of the MKL
    where pypardiso is installed, otherwise by SuperLU of SciPy, which is slower."""

    def __init__(self):
        self._solver = pypardiso.PyPardisoSolver(mtype=-2) if pypardiso else None
        self._matrix = None

    @property
    def name(self) -> str:
        return "PARDISO (MKL)" if pypardiso else "SuperLU (SciPy)"

    def factorise(self, upper: sparse.csr_matrix) -> None:
        """Factorises a matrix; the sparsity pattern, analysed once, must be the same each time."""
        self._matrix = upper
        if self._solver is None:
            full = (upper + sparse.triu(upper, 1).T).tocsc()
            self._factors = scipy.sparse.linalg.splu(full)
            return
        first = not np.any(self._solver.pt)
        self._call(12 if first else 22, np.zeros((upper.shape[0], 1)))

    def solve(self, right: np.ndarray) -> np.ndarray:
        """The solution for a right-hand side (n,)."""
        if self._solver is None:
            return self._factors.solve(right)
        return self._call(33, right[:, None]).ravel()

    def release(self) -> None:
        """Frees the memory of the factors."""
        if self._solver is not None and np.any(self._solver.pt):
            self._solver.free_memory(everything=True)

    def _call(self, phase: int, right: np.ndarray) -> np.ndarray:
        self._solver.set_phase(phase)
        return self._solver._call_pardiso(self._matrix, np.asfortranarray(right))
