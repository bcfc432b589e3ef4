"""Dataclasses as the tables of a case file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

from .conditions import Data, Displacement, Formula, Prescribe, RigidMotion, Rotation, Table
from .shapes import Difference, InShape, Intersection, Not, Union

#: Units at the ends of names.
UNITS = ("_kg_m3", "_m_s2", "_pa_per_m", "_per_s", "_m_s", "_m3", "_pa", "_rad", "_m", "_s")

_MOTIONS = {Displacement: "displacement", Rotation: "rotation", Formula: "formula", Data: "data"}


def key_of(name: str) -> str:
    """The key of a case file for the name of a field."""
    unit = next((unit for unit in UNITS if name.endswith(unit)), "")
    return name[: len(name) - len(unit)]


def table_of(item: Any) -> Any:
    """A value of this module as what a case file has."""
    if isinstance(item, Prescribe):
        return _prescribe(item)
    if isinstance(item, RigidMotion):
        return _rigid_motion(item)
    if is_dataclass(item) and not isinstance(item, type):
        return _dataclass(item)
    if isinstance(item, Mapping):
        return {name: table_of(part) for name, part in item.items()}
    if isinstance(item, (list, tuple)):
        return [table_of(part) for part in item]
    return item


def _dataclass(item: Any) -> Any:
    if isinstance(item, (Union, Intersection)):
        return {item.kind: [table_of(part) for part in item.parts]}
    if isinstance(item, Difference):
        return {item.kind: [table_of(item.first), table_of(item.second)]}
    if isinstance(item, (Not, InShape)):
        return {item.kind: table_of(item.part if isinstance(item, Not) else item.shape)}
    if isinstance(item, Table):
        return {item.kind: item.rows}
    parts = ((part.name, getattr(item, part.name)) for part in fields(item))
    given = {name: value for name, value in parts if name != "kind" and not _is_nothing(value)}
    table = {key_of(name): table_of(value) for name, value in given.items()}
    return {item.kind: table} if hasattr(item, "kind") else table


def _is_nothing(value: Any) -> bool:
    return value is None or (isinstance(value, tuple) and not value)


def _rigid_motion(motion: RigidMotion) -> dict[str, Any]:
    key = "rotation" if isinstance(motion.way, Rotation) else "displacement"
    table = {key: table_of(motion.way)}
    if motion.amplitude is not None:
        table["amplitude"] = table_of(motion.amplitude)
    return table


def _prescribe(condition: Prescribe) -> dict[str, Any]:
    table = {"name": condition.name, "of": condition.of, "where": table_of(condition.where)}
    if callable(condition.motion):
        # The function takes its place.
        table["displacement"] = {"x": 0.0, "y": 0.0}
    elif type(condition.motion) in _MOTIONS:
        table[_MOTIONS[type(condition.motion)]] = table_of(condition.motion)
    else:
        kinds = ", ".join(kind.__name__ for kind in _MOTIONS)
        raise TypeError(
            f"the motion of {condition.name} is {condition.motion!r}; it must be one of {kinds}, or a function"
        )
    if condition.amplitude is not None:
        table["amplitude"] = table_of(condition.amplitude)
    if condition.release_s is not None:
        table["release"] = condition.release_s
    return table
