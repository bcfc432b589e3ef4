"""Child processes that run this package."""

import os
import sys
from pathlib import Path


def this_python() -> list[str]:
    """This interpreter, without the packages of the user where it runs without them."""
    return [sys.executable, *(["-s"] if sys.flags.no_user_site else [])]


def module_command(python: list[str], *arguments) -> list[str]:
    """The command line `python -m mtled_reference` with arguments."""
    return [*python, "-m", __package__, *map(str, arguments)]


def environment() -> dict[str, str]:
    """The environment in which the interpreter of the child finds this package."""
    paths = [str(Path(__file__).resolve().parent.parent), os.environ.get("PYTHONPATH", "")]
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))}
