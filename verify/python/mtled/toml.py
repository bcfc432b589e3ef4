"""Values and tables as TOML."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Mapping
from numbers import Integral, Real
from typing import Any


def value(item: Any) -> str:
    """A value on one line. Arrays of numpy are lists."""
    if hasattr(item, "tolist"):
        item = item.tolist()
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, Integral):
        return str(int(item))
    if isinstance(item, Real):
        number = float(item)
        return repr(number) if math.isfinite(number) else str(number)
    if isinstance(item, os.PathLike):
        item = os.fspath(item)
    if isinstance(item, str):
        # A basic string is escaped as in JSON, but for the character of code 127.
        return json.dumps(item, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(item, Mapping):
        pairs = ", ".join(f"{key(name)} = {value(part)}" for name, part in item.items())
        return f"{{ {pairs} }}" if pairs else "{}"
    if isinstance(item, (list, tuple)):
        return f"[{', '.join(value(part) for part in item)}]"
    raise TypeError(f"a case has numbers, texts, lists and tables, not {type(item).__name__}: {item!r}")


def key(name: str) -> str:
    """A key, in quotation marks where it needs them."""
    if not isinstance(name, str):
        raise TypeError(f"keys of a case are texts, not {type(name).__name__}: {name!r}")
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else value(name)


def document(tables: Mapping[str, Any]) -> str:
    """A document: values first, then tables and lists of tables under headings."""
    lines = [
        f"{key(name)} = {value(item)}"
        for name, item in tables.items()
        if not isinstance(item, Mapping) and not _is_tables(item)
    ]
    for name, item in tables.items():
        if isinstance(item, Mapping):
            lines += _table(key(name), item)
        elif _is_tables(item):
            for table in item:
                lines += ["", f"[[{key(name)}]]"]
                lines += [f"{key(inner)} = {value(part)}" for inner, part in table.items()]
    return "\n".join(lines) + "\n"


def _is_tables(item: Any) -> bool:
    return isinstance(item, (list, tuple)) and bool(item) and all(isinstance(row, Mapping) for row in item)


def _table(name: str, table: Mapping[str, Any]) -> list[str]:
    if table and all(isinstance(item, Mapping) for item in table.values()):
        inner = [["", f"[{name}.{key(part)}]"] + _pairs(item) for part, item in table.items()]
        return [line for lines in inner for line in lines]
    return ["", f"[{name}]"] + _pairs(table)


def _pairs(table: Mapping[str, Any]) -> list[str]:
    return [f"{key(name)} = {value(item)}" for name, item in table.items()]
