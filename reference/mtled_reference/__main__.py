"""Command line: solve a case with one code, merge solutions, regenerate all."""

import argparse
import signal
import sys
from pathlib import Path

from . import CODES, FINEST, LEVELS
from .case import read_case
from .reference_file import merge_into


def main(arguments: list[str] | None = None) -> int:
    """Runs a command; 0 on success, 2 with a message on stderr on failure."""
    options = _parser().parse_args(arguments)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that children end too
    try:
        options.run(options)
    except Exception as error:  # the boundary of the program: every failure is reported
        if options.traceback:
            raise
        print(f"mtled_reference: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="mtled_reference", description=__doc__)
    parser.add_argument("--traceback", action="store_true", help="show where an error arose")
    commands = parser.add_subparsers(required=True)

    solve = commands.add_parser("solve", help="solve a case with one code")
    solve.add_argument("case", type=Path)
    solve.add_argument("--code", choices=sorted(CODES), required=True)
    solve.add_argument("--mesh", type=int, choices=LEVELS, action="append", dest="meshes")
    solve.add_argument("--out", type=Path, required=True)
    solve.set_defaults(run=_solve)

    one = commands.add_parser("solve-mesh", help="solve one mesh in this process")
    one.add_argument("case", type=Path)
    one.add_argument("--code", choices=sorted(CODES), required=True)
    one.add_argument("--mesh", type=int, choices=(*LEVELS, FINEST), required=True)
    one.add_argument("--out", type=Path, required=True)
    one.set_defaults(run=_solve_mesh)

    race = commands.add_parser("race", help="one run of the race, in this process")
    race.add_argument("problem")
    race.add_argument("--cases", type=Path, required=True, help="folder of the case files")
    race.add_argument("--code", choices=sorted(CODES), required=True)
    race.add_argument("--element", required=True, help="such as P2 or Q1/P0")
    race.add_argument("--cells", type=int, required=True, help="along an edge of the body")
    race.add_argument("--out", type=Path, required=True)
    race.set_defaults(run=_race)

    truth = commands.add_parser("race-truth", help="the field of the block for the race")
    truth.add_argument("case", type=Path)
    truth.add_argument("--solved", type=Path, required=True, help=f"by solve-mesh --mesh {FINEST}")
    truth.add_argument("--refinement", type=float, default=1.5)
    truth.add_argument("--out", type=Path, required=True)
    truth.set_defaults(run=_race_truth)

    merge = commands.add_parser("merge", help="write DIR/CASE.json from solutions")
    merge.add_argument("case", type=Path)
    merge.add_argument("--data", type=Path, required=True)
    merge.add_argument("solutions", type=Path, nargs="+")
    merge.set_defaults(run=_merge)

    every = commands.add_parser("all", help="solve cases with both codes and merge them")
    every.add_argument("--cases", type=Path, required=True, help="folder of the case files")
    every.add_argument("--data", type=Path, required=True, help="folder of the reference files")
    every.add_argument("--only", action="append", help="name of a case; repeat for several")
    every.add_argument("--code", choices=sorted(CODES), action="append", dest="codes")
    every.add_argument("--jobs", type=int, default=2, help="processes at a time")
    for code in CODES:
        every.add_argument(f"--{code}-python", help=f"interpreter with {code}, e.g. 'python3 -s'")
    every.set_defaults(run=_all)
    return parser


def _solve(options) -> None:
    from .solve import solve

    meshes = sorted(set(options.meshes or LEVELS))
    solve(options.case, options.code, meshes, options.out)


def _solve_mesh(options) -> None:
    from .solve import solve_mesh_here

    solve_mesh_here(options.case, options.code, options.mesh, options.out)


def _race(options) -> None:
    from .race import race

    race(
        options.problem,
        options.cases,
        options.code,
        options.element,
        options.cells,
        options.out,
    )


def _race_truth(options) -> None:
    from .race import write_truth

    write_truth(options.case, options.solved, options.refinement, options.out)


def _merge(options) -> None:
    merge_into(read_case(options.case), options.data, options.solutions)


def _all(options) -> None:
    from .regenerate import regenerate

    interpreters = {code: getattr(options, f"{code.replace('-', '_')}_python") for code in CODES}
    paths = sorted(options.cases.glob("*.toml"))
    unknown = set(options.only or []) - {path.stem for path in paths}
    if unknown:
        raise ValueError(f"no case {', '.join(sorted(unknown))} in {options.cases}")
    chosen = [path for path in paths if not options.only or path.stem in options.only]
    regenerate(chosen, options.codes or list(CODES), interpreters, options.data, options.jobs)


if __name__ == "__main__":
    sys.exit(main())
