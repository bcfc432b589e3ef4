"""Cases: what is solved."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _mtled, toml
from .errors import DoubtfulWarning
from .result import Result

Triple = tuple[float, float, float]


class Case:
    """A case without mistakes; see :func:`load` and :meth:`from_dict`."""

    def __init__(self, core: _mtled.Case) -> None:
        self._core = core

    @classmethod
    def from_dict(
        cls,
        tables: Mapping[str, Any],
        *,
        name: str = "case",
        folder: str | os.PathLike[str] = ".",
        overrides: Mapping[str, Any] | None = None,
    ) -> Case:
        """The case with these tables, as in a case file; files are looked for in ``folder``."""
        return cls.from_text(toml.document(tables), name=name, folder=folder, overrides=overrides)

    @classmethod
    def from_text(
        cls,
        text: str,
        *,
        name: str = "case",
        folder: str | os.PathLike[str] = ".",
        overrides: Mapping[str, Any] | None = None,
    ) -> Case:
        """The case of the text of a case file; files are looked for in ``folder``."""
        return cls(_mtled.Case.parse(text, f"{name}.toml", folder, _settings(overrides)))

    @property
    def name(self) -> str:
        return self._core.name

    @property
    def title(self) -> str:
        return self._core.title

    @property
    def description(self) -> str:
        return self._core.description

    @property
    def file(self) -> str:
        """The name of the file; of a bundled case its name with ``.toml``."""
        return self._core.file

    @property
    def text(self) -> str:
        """The text of the file with the overrides in it."""
        return self._core.text

    @property
    def hash(self) -> str:
        """SHA-256 of the case and of the files that it names; it does not cover Python functions."""
        return self._core.hash

    @property
    def overrides(self) -> list[str]:
        return self._core.overrides

    @property
    def conditions(self) -> list[str]:
        """Names of the prescribed displacements."""
        return self._core.conditions

    def with_distance(
        self,
        distance: Callable[[np.ndarray, np.ndarray, np.ndarray], npt.ArrayLike],
        lower_m: Sequence[float],
        upper_m: Sequence[float],
        *,
        sample_m: float | None = None,
    ) -> Case:
        """The case with another body: where ``distance(x, y, z)`` is negative.

        The function takes arrays of coordinates [m] and returns signed distances to the boundary
        [m]; away from the boundary their sign and a bound on the distance are enough. The body
        lies between the corners ``lower_m`` and ``upper_m``. The function is called once, for a
        lattice of points ``sample_m`` apart, by default the longest edge of the box over 128;
        between them distances are linear. A boundary of curvature radius R so moves by up to
        about ``sample_m**2 / (4 * R)``, and edges are rounded over ``sample_m``.
        """
        lower, upper = list(map(float, lower_m)), list(map(float, upper_m))
        if sample_m is None:
            sample_m = max(high - low for low, high in zip(lower, upper, strict=True)) / 128
        return Case(self._core.with_distance(distance, lower, upper, sample_m))

    def with_displacement(self, condition: str, displacement: Callable[[float, float, float], Triple]) -> Case:
        """The case in which a condition prescribes ``displacement(x, y, z)`` [m], three numbers.

        The function is called for one reference position [m] at a time.
        """
        return Case(self._core.with_displacement(condition, displacement))

    def discretise(self) -> _mtled.Discretisation:
        """Nodes, quadrature points and supports as arrays."""
        return self._core.discretise()

    def solve(self, *, error_bars: bool = True, progress: Callable[[float, int], object] | None = None) -> Result:
        """Runs the case as ``mtled solve`` does, without the lock of the interpreter.

        ``progress(fraction, step)`` is called at most 20 times a second, from this thread. What
        it raises, and Ctrl-C, end the run at once; a set-up that has begun ends in the
        background. A result that the run itself doubts is a :class:`mtled.DoubtfulWarning`.
        """
        result = Result(self._core.solve(error_bars, progress))
        if result.doubtful:
            warnings.warn("; ".join(result.doubts), DoubtfulWarning, stacklevel=2)
        return result

    def __repr__(self) -> str:
        return f"<mtled.Case {self.name}: {self.title}>"


def load(path: str | os.PathLike[str], *, overrides: Mapping[str, Any] | None = None) -> Case:
    """Reads a case file, or a bundled case by its name.

    ``overrides`` are values in place of those of the file, by keys such as
    ``"discretisation.spacing"`` or ``"prescribe.top.displacement.z"``.
    """
    return Case(_mtled.Case.load(path, _settings(overrides)))


def bundled() -> dict[str, str]:
    """The texts of the cases inside the package by their names."""
    return dict(_mtled.bundled_cases())


def _settings(overrides: Mapping[str, Any] | None) -> list[str]:
    return [f"{key}={toml.value(item)}" for key, item in (overrides or {}).items()]
