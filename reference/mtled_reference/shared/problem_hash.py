"""Hash of the problem that a case file states.

A reference belongs to a case while their hashes agree. Titles, descriptions and
the meshless discretisation do not enter the hash.
"""

import hashlib
import struct
from pathlib import Path

NOT_THE_PROBLEM = {"title", "description", "source", "discretisation", "output"}
TIME_OF_THE_PROBLEM = {"method", "end", "load_end", "damping"}


def problem_hash(document: dict, folder: Path) -> str:
    """SHA-256 (hex) of the canonical text of the parsed case file `document`;
    `folder` is that of the case file."""
    problem = {key: value for key, value in document.items() if key not in NOT_THE_PROBLEM}
    if "time" in problem:
        time = problem["time"]
        problem["time"] = {key: time[key] for key in time if key in TIME_OF_THE_PROBLEM}
    return hashlib.sha256(canonical_text(problem, folder).encode()).hexdigest()


def canonical_text(value, folder: Path) -> str:
    """A table is `{`, its sorted keys with their values, `}`; an array `[` … `]`; a
    string `s`, its length in bytes, `:` and the string; a number `n` and its bits as
    a double; a Boolean `b1` or `b0`; a file `f` and the SHA-256 of its content."""
    if isinstance(value, dict):
        entries = [_string(key) + _entry(key, value[key], folder) for key in sorted(value)]
        return "{" + "".join(entries) + "}"
    if isinstance(value, list):
        return "[" + "".join(canonical_text(item, folder) for item in value) + "]"
    if isinstance(value, bool):
        return "b1" if value else "b0"
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, (int, float)):
        return "n" + struct.pack(">d", float(value) + 0.0).hex()
    raise ValueError(f"{type(value).__name__} values are not supported in a case file")


def _entry(key: str, value, folder: Path) -> str:
    if key == "file" and isinstance(value, str):
        return "f" + hashlib.sha256((folder / value).read_bytes()).hexdigest()
    return canonical_text(value, folder)


def _string(text: str) -> str:
    return f"s{len(text.encode())}:{text}"
