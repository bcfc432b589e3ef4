"""The program: ``python -m mtled``."""

import sys

from . import _mtled


def main() -> int:
    """Runs the program with the arguments of this process and returns its exit code."""
    return _mtled.program(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
