"""Types that the dataclasses share."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import field
from typing import Any, Literal
from typing import Union as OneOf

Triple = Sequence[float]
Path = OneOf[str, "os.PathLike[str]"]
Unit = Literal["m", "mm"]
#: A function of the coordinates x, y and z [m].
Function = Callable[[Any, Any, Any], Any]


def kind_of(kind: str) -> Any:
    """A table with one key, which names the kind."""
    return field(default=kind, init=False, repr=False)
