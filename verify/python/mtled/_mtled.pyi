"""The compiled part of the package; the modules around it are what users call."""

from collections.abc import Callable
from os import PathLike
from typing import final

import numpy as np
import numpy.typing as npt

_Path = str | PathLike[str]
_Triple = tuple[float, float, float]
_Array = npt.NDArray[np.float64]

__all__ = [
    "Case",
    "Discretisation",
    "Result",
    "WarpedImage",
    "__version__",
    "bundled_cases",
    "program",
    "schema",
]
__version__: str

def program(arguments: list[str]) -> int: ...
def schema() -> str:
    """The JSON Schema of case files."""

def bundled_cases() -> list[tuple[str, str]]: ...

@final
class Discretisation:
    """Nodes, quadrature points and supports of a case.

    Supports are rows as in a compressed sparse matrix: the entries of point p are
    ``support_starts[p]:support_starts[p + 1]``.
    """

    @property
    def nodes_m(self) -> _Array:
        """Reference positions [m], (nodes, 3)."""
    @property
    def nodal_spacing_m(self) -> _Array:
        """Local distance of nodes [m], (nodes,)."""
    @property
    def influence_radius_m(self) -> _Array:
        """Radius of the influence domain of each node [m], (nodes,)."""
    @property
    def on_boundary(self) -> npt.NDArray[np.bool_]:
        """Whether a node lies on the boundary, (nodes,)."""
    @property
    def lumped_mass_kg(self) -> _Array:
        """Lumped mass of each node [kg], (nodes,)."""
    @property
    def points_m(self) -> _Array:
        """Reference positions of the quadrature points [m], (points, 3)."""
    @property
    def quadrature_weights_m3(self) -> _Array:
        """Volume of each quadrature point [m³], (points,)."""
    @property
    def point_regions(self) -> npt.NDArray[np.uint16]:
        """Number of the region of each point, (points,)."""
    @property
    def support_starts(self) -> npt.NDArray[np.uintp]:
        """(points + 1,)"""
    @property
    def support_nodes(self) -> npt.NDArray[np.uint32]:
        """Node of each entry, (entries,)."""
    @property
    def phi(self) -> _Array:
        """Shape function of that node at the point [–], (entries,)."""
    @property
    def grad_phi_per_m(self) -> _Array:
        """Its gradient [1/m], (entries, 3)."""
    @property
    def worst_condition(self) -> float:
        """The largest condition number of a moment matrix."""
    @property
    def enlarged_supports(self) -> int:
        """Quadrature points whose influence radii had to be enlarged."""
    @property
    def warnings(self) -> list[str]:
        """Reasons to doubt a result."""
    @property
    def setup_seconds(self) -> float:
        """Wall time of the set-up [s]."""

@final
class Case:
    @staticmethod
    def load(path: _Path, set: list[str]) -> Case: ...
    @staticmethod
    def parse(text: str, file: str, folder: _Path, set: list[str]) -> Case: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def file(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def hash(self) -> str: ...
    @property
    def overrides(self) -> list[str]: ...
    @property
    def conditions(self) -> list[str]: ...
    @property
    def is_bundled(self) -> bool: ...
    @property
    def has_functions(self) -> bool: ...
    def portable_text(self) -> str: ...
    def with_distance(
        self,
        distance: Callable[[_Array, _Array, _Array], npt.ArrayLike],
        lower_m: list[float],
        upper_m: list[float],
        sample_m: float,
    ) -> Case: ...
    def with_displacement(self, condition: str, displacement: Callable[[float, float, float], _Triple]) -> Case: ...
    def discretise(self) -> Discretisation: ...
    def solve(self, error_bars: bool, progress: Callable[[float, int], object] | None) -> Result: ...

@final
class Result:
    @property
    def nodes_m(self) -> _Array: ...
    @property
    def displacement_m(self) -> _Array: ...
    def json(self) -> str: ...
    def text(self) -> str: ...
    def history(self) -> tuple[list[str], _Array]: ...
    def displacement_at(self, points_m: _Array) -> _Array: ...
    def mesh(self) -> tuple[_Array, npt.NDArray[np.uint32], npt.NDArray[np.uint16], dict[str, _Array]]: ...
    def picture(self, field: str) -> str: ...
    def warp(self, image: _Path, labels: bool, decay_m: float | None, unit: str | None) -> WarpedImage: ...
    def write(self, folder: _Path) -> None: ...

@final
class WarpedImage:
    @property
    def bytes(self) -> npt.NDArray[np.uint8]: ...
    @property
    def shape(self) -> list[int]: ...
    @property
    def dtype(self) -> str: ...
    @property
    def origin_m(self) -> list[float]: ...
    @property
    def directions_m(self) -> _Array: ...
    @property
    def source_vectors_m(self) -> npt.NDArray[np.float32]: ...
    @property
    def unconverged(self) -> int: ...
    @property
    def from_outside(self) -> int: ...
    @property
    def nodes_outside(self) -> int: ...
    def write(self, path: _Path) -> None: ...
    def write_inverse_field(self, path: _Path) -> None: ...
