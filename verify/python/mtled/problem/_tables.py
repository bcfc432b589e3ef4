"""Dataclasses as the tables of a case file."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, dataclass, fields, is_dataclass
from typing import Any
from typing import Union as OneOf

__all__ = ["Distance", "key_of"]

Path = OneOf[str, "os.PathLike[str]"]
#: A function of the coordinates x, y and z [m].
Function = Callable[[Any, Any, Any], Any]
#: Units, and what stands for them at the ends of names; one that ends as another comes before it.
UNITS = {
    "kg/m³": "_kg_m3",
    "m/s²": "_m_s2",
    "Pa/m": "_pa_per_m",
    "1/s": "_per_s",
    "m/s": "_m_s",
    "m³": "_m3",
    "Pa": "_pa",
    "rad": "_rad",
    "m": "_m",
    "s": "_s",
    "–": "",
    "voxel": "",
    "": "",
}


class Unnamed:
    """A table whose values have no keys in a case file."""


@dataclass
class Distance:
    """The body in which ``function(x, y, z)`` is negative; see :meth:`mtled.Case.with_distance`."""

    function: Function
    lower_m: Sequence[float]
    upper_m: Sequence[float]
    sample_m: float | None = None


def key_of(name: str) -> str:
    """The key of a case file for the name of a field."""
    return name.removesuffix(next(end for end in UNITS.values() if name.endswith(end)))


def table_of(item: Any) -> Any:
    """A value of this package as what a case file has."""
    if is_dataclass(item) and not isinstance(item, type):
        given = [(part, getattr(item, part.name)) for part in fields(item)]
        table: Any = dict(_pair(item, part, value) for part, value in given if value is not None)
        if isinstance(item, Unnamed):
            table = list(table.values()) if len(table) > 1 else next(iter(table.values()))
        kind = getattr(item, "kind", None)
        return {kind: table} if kind else table
    if isinstance(item, Mapping):
        return {name: table_of(part) for name, part in item.items()}
    if isinstance(item, (list, tuple)):
        return [table_of(part) for part in item]
    return item


def _pair(item: Any, part: Field[Any], value: Any) -> tuple[str, Any]:
    """The key of a field and its value; a field for one of several keys has the one that its class is called after."""
    if "keys" not in part.metadata:
        return key_of(part.name), table_of(value)
    key = type(value).__name__.lower()
    if key not in part.metadata["keys"]:
        kinds = ", ".join(name.capitalize() for name in part.metadata["keys"])
        raise TypeError(f"the {part.name} of {item.name} is {value!r}; it must be one of {kinds}, or a function")
    return key, table_of(value)
