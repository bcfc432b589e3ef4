"""A problem, which makes a case."""

from __future__ import annotations

from dataclasses import replace

from ..case import Case
from ._conditions import Displacement
from ._shapes import Box
from ._statement import Statement
from ._tables import Distance, Path, table_of

__all__ = ["Problem"]


class Problem(Statement):
    """All of a case; :meth:`case` makes one."""

    def case(self, *, name: str = "case", folder: Path = ".") -> Case:
        """The case; names of files count from ``folder``."""
        own, conditions = self.shape, self.prescribe or ()
        # What functions take the place of.
        shape = Box(own.lower_m, own.upper_m) if isinstance(own, Distance) else own
        rest = Displacement(0.0, 0.0)
        prescribe = [replace(part, motion=rest) if callable(part.motion) else part for part in conditions]
        tables = table_of(replace(self, shape=shape, prescribe=prescribe or None))
        tables["geometry"] = {"shape": tables.pop("shape")}
        if self.plane is not None:
            tables.setdefault("dimension", "plane_strain")
        case = Case.from_dict(tables, name=name, folder=folder)
        if isinstance(own, Distance):
            case = case.with_distance(own.function, own.lower_m, own.upper_m, sample_m=own.sample_m)
        for part in conditions:
            if callable(part.motion):
                case = case.with_displacement(part.name, part.motion)
        return case
