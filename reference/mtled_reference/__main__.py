"""Solves cases by finite elements and merges the solutions."""

import argparse
import signal
import sys
from pathlib import Path

from . import CODES, FINEST, LEVELS
from .finest import write_reference_solution
from .regenerate import regenerate
from .shared.case import read_case
from .shared.reference_file import merge_into
from .solve import solve, solve_mesh_here


def main(arguments: list[str] | None = None) -> int:
    """Runs a command; returns 0, or 2 with a message on stderr if it fails."""
    options = _parser().parse_args(arguments)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # ends child processes too
    try:
        options.run(options)
    except Exception as error:  # every failure ends in one line on stderr
        if options.traceback:
            raise
        print(f"mtled_reference: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="mtled_reference", description=__doc__)
    parser.add_argument("--traceback", action="store_true", help="show the traceback of an error")
    commands = parser.add_subparsers(required=True)
    _add_solving(commands)
    _add_finest(commands)
    _add_references(commands)
    return parser


def _add_solving(commands) -> None:
    """The commands that solve a case."""
    command = commands.add_parser("solve", help="solve a case with one code")
    command.add_argument("case", type=Path)
    command.add_argument("--code", choices=CODES, required=True)
    command.add_argument("--mesh", type=int, choices=LEVELS, action="append", dest="meshes")
    command.add_argument("--out", type=Path, required=True)
    command.set_defaults(run=_solve)

    command = commands.add_parser("fibres", help="solve a box with fibres on several meshes")
    command.add_argument("case", type=Path)
    command.add_argument("--size", type=float, action="append", dest="sizes", required=True)
    command.add_argument("--out", type=Path, required=True)
    command.add_argument("--steps", type=int, default=8, help="parts of the load")
    command.set_defaults(run=_fibres)

    command = commands.add_parser("published", help="solve a ventricle of Land's benchmark")
    command.add_argument("problem", choices=("land_2", "land_3"))
    command.add_argument("--published", type=Path, required=True, help="folder of the problems")
    cells = (
        "across the wall, along an eighth of the circumference, up; of a half section two of them"
    )
    command.add_argument("--cells", type=int, nargs="+", action="append", required=True, help=cells)
    command.add_argument("--out", type=Path, required=True)
    command.set_defaults(run=_published)

    command = commands.add_parser("strip", help="solve a strip in plane strain and time it")
    command.add_argument("case", type=Path)
    command.add_argument("--cells", type=int, nargs=2, required=True, help="along and across")
    command.add_argument("--steps", type=int, default=8, help="parts of the load")
    command.set_defaults(run=_strip)

    command = commands.add_parser("solve-mesh", help="solve one mesh in this process")
    command.add_argument("case", type=Path)
    command.add_argument("--code", choices=CODES, required=True)
    command.add_argument("--mesh", type=int, choices=(*LEVELS, FINEST), required=True)
    command.add_argument("--out", type=Path, required=True)
    command.set_defaults(run=_solve_mesh)


def _fibres(options) -> None:
    # Needs FEniCSx.
    from .fibres import solve_on_meshes

    solve_on_meshes(options.case, options.sizes, options.out, options.steps)


def _published(options) -> None:
    # Needs FEniCSx.
    from .published import solve_on_meshes

    meshes = [tuple(counts) for counts in options.cells]
    solve_on_meshes(options.problem, options.published, meshes, options.out)


def _strip(options) -> None:
    # Needs FEniCSx.
    from .published import time_strip

    time_strip(options.case, tuple(options.cells), options.steps)


def _add_finest(commands) -> None:
    """The command that writes a field on a finer mesh than those of a reference."""
    command = commands.add_parser("finest", help="the field of the bonded block on a finer mesh")
    command.add_argument("case", type=Path)
    output = f"output of solve-mesh --mesh {FINEST}"
    command.add_argument("--solved", type=Path, required=True, help=output)
    ratio = "size of the next coarser mesh over that of the finest"
    command.add_argument("--refinement", type=float, default=1.5, help=ratio)
    command.add_argument("--out", type=Path, required=True)
    command.set_defaults(run=_finest)


def _add_references(commands) -> None:
    """The commands that write reference files."""
    command = commands.add_parser("merge", help="write DIR/CASE.json from solutions")
    command.add_argument("case", type=Path)
    command.add_argument("--data", type=Path, required=True)
    command.add_argument("solutions", type=Path, nargs="+")
    command.set_defaults(run=_merge)

    command = commands.add_parser("all", help="solve cases with both codes and merge them")
    command.add_argument("--cases", type=Path, required=True, help="folder of the case files")
    command.add_argument("--data", type=Path, required=True, help="folder of the reference files")
    command.add_argument("--only", action="append", help="name of a case; repeat for several")
    command.add_argument("--code", choices=CODES, action="append", dest="codes")
    command.add_argument("--jobs", type=int, default=2, help="processes at a time")
    for code in CODES:
        command.add_argument(f"--{code}-python", help=f"interpreter with {code}, e.g. 'python3 -s'")
    command.set_defaults(run=_all)


def _solve(options) -> None:
    meshes = sorted(set(options.meshes or LEVELS))
    solve(options.case, options.code, meshes, options.out)


def _solve_mesh(options) -> None:
    solve_mesh_here(options.case, options.code, options.mesh, options.out)


def _finest(options) -> None:
    write_reference_solution(options.case, options.solved, options.refinement, options.out)


def _merge(options) -> None:
    merge_into(read_case(options.case), options.data, options.solutions)


def _all(options) -> None:
    interpreters = {code: getattr(options, f"{code.replace('-', '_')}_python") for code in CODES}
    paths = sorted(options.cases.glob("*.toml"))
    unknown = set(options.only or []) - {path.stem for path in paths}
    if unknown:
        raise ValueError(f"no case {', '.join(sorted(unknown))} in {options.cases}")
    chosen = [path for path in paths if not options.only or path.stem in options.only]
    regenerate(chosen, options.codes or list(CODES), interpreters, options.data, options.jobs)


if __name__ == "__main__":
    sys.exit(main())
