"""A problem, which makes a case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..case import Case
from .conditions import (
    BodyForce,
    Cavity,
    InitialVelocity,
    Obstacle,
    Prescribe,
    Pressure,
    Spring,
    Traction,
)
from .kinds import Path
from .recipe import Material, Recipe, Region
from .shapes import Distance
from .tables import table_of
from .time import Dynamic, Output, PlaneStrain, Probe, Static


@dataclass
class Problem:
    """All of a case; :meth:`case` makes one."""

    title: str
    shape: Any
    material: Mapping[str, Material]
    discretisation: Recipe
    time: Static | Dynamic
    region: Sequence[Region] = ()
    prescribe: Sequence[Prescribe] = ()
    body_force: Sequence[BodyForce] = ()
    traction: Sequence[Traction] = ()
    pressure: Sequence[Pressure] = ()
    spring: Sequence[Spring] = ()
    cavity: Sequence[Cavity] = ()
    initial_velocity: Sequence[InitialVelocity] = ()
    obstacle: Sequence[Obstacle] = ()
    probe: Sequence[Probe] = ()
    plane: PlaneStrain | None = None
    output: Output | None = None
    description: str | None = None
    source: str | None = None

    def case(self, *, name: str = "case", folder: Path = ".") -> Case:
        """The case; names of files count from ``folder``."""
        tables = table_of(self)
        shape = tables.pop("shape")
        if isinstance(self.shape, Distance):
            # The function takes its place.
            shape = {"box": {"min": list(self.shape.lower_m), "max": list(self.shape.upper_m)}}
        tables["geometry"] = {"shape": shape}
        if self.plane is not None:
            tables["dimension"] = "plane_strain"
        case = Case.from_dict(tables, name=name, folder=folder)
        if isinstance(self.shape, Distance):
            own = self.shape
            case = case.with_distance(own.function, own.lower_m, own.upper_m, sample_m=own.sample_m)
        for condition in self.prescribe:
            if callable(condition.motion):
                case = case.with_displacement(condition.name, condition.motion)
        return case
