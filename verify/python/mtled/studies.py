"""Studies, tuning and verification: the commands of the program as functions that return tables.

Options are those of the commands (``mtled study convergence --help``) with underscores in place
of hyphens: ``clouds=5`` is ``--clouds 5``, a list is written with commas, ``True`` is the option
alone. Files are written where the commands write them, below ``reports/`` of the working folder:
runs are kept in ``reports/runs`` and not repeated.
"""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from .case import Case
from .errors import CaseError, MtledError

if TYPE_CHECKING:
    import pandas

#: A case, a case file, or the name of a bundled case.
CaseLike = Case | str | os.PathLike[str]
_OUTCOMES = {0: "passed", 1: "failed", 3: "inconclusive"}
_STOPPED = 130


class Report:
    """What studies have found."""

    def __init__(self, document: dict[str, Any], outcome: str, folder: Path) -> None:
        #: What the program writes as ``results.json``.
        self.json = document
        #: ``passed``, ``failed``, or ``inconclusive`` where the question cannot be decided.
        self.outcome = outcome
        #: Where the page of the report (``index.html``) and its files are.
        self.folder = folder

    @property
    def checks(self) -> list[dict[str, Any]]:
        """The figures that were judged: id, quantity, value, unit, bound, pass and source."""
        return list(self.json["checks"])

    @property
    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """The tables by their titles: a dict for each row, by the names of columns with their units."""
        tables = (table for study in self.json["studies"] for table in study["tables"])
        return {table["title"]: _rows(table) for table in tables}

    def to_pandas(self, table: str | None = None) -> pandas.DataFrame:
        """The checks, or the table of a title, as a data frame."""
        import pandas

        if table is None:
            return pandas.DataFrame(self.checks)
        if table not in self.tables:
            raise KeyError(f"there is no table {table!r}; there are {', '.join(map(repr, self.tables))}")
        return pandas.DataFrame(self.tables[table])

    def __repr__(self) -> str:
        passed = sum(check["pass"] for check in self.checks)
        return f"<mtled.Report {self.outcome}: {passed} of {len(self.checks)} checks, {self.folder / 'index.html'}>"


def verify(suite: str | os.PathLike[str] = "quick", *, only: str | None = None, **options: Any) -> Report:
    """The studies of the solver, or the gate of a suite of your own cases (``mtled verify``)."""
    return _report(["verify"], [], Path("reports", "verify"), {"suite": os.fspath(suite), "only": only} | options)


def study(
    kind: Literal["convergence", "timestep", "patch", "consistency", "stability"],
    *cases: CaseLike,
    **options: Any,
) -> Report:
    """A case over ranges of its recipe (``mtled study``), such as ``spacing="x2,x1.4,x1"``."""
    return _report(["study", kind], cases, Path("reports", kind), options)


def tune(
    case: CaseLike, *, target_error: float | None = None, budget_s: float | None = None, **options: Any
) -> Report:
    """The cheapest recipe with at most an error, or the most accurate one within a CPU time (``mtled tune``).

    The case file with the recipe is ``*.tuned.toml`` in the folder of the report.
    """
    goal = {"target_error": target_error, "budget": None if budget_s is None else f"{budget_s}s"}
    return _report(["tune"], [case], Path("reports", "tune", _name(case)), goal | options)


def budget(case: CaseLike, **options: Any) -> Report:
    """How large the error is, from what, and what each part costs (``mtled budget``)."""
    return _report(["budget"], [case], Path("reports", "budget", _name(case)), options)


class Sensitivities:
    """How the answers of a static case change with its numbers."""

    def __init__(self, document: dict[str, Any]) -> None:
        #: What the program prints as JSON.
        self.json = document
        #: Value of each answer in its SI unit.
        self.answers: dict[str, float] = {answer["name"]: answer["value"] for answer in document["answers"]}
        #: Change of each answer in per cent where a number grows by one per cent: numbers by their
        #: keys, those that matter most first, answers by their names.
        self.per_cent_per_per_cent = self._by_key("per_cent_per_per_cent")
        #: Derivative of each answer by each number, in SI units.
        self.derivatives = self._by_key("derivatives")
        #: ``per_cent_per_per_cent`` by solutions on both sides of each number; empty without ``check``.
        self.by_solutions = self._by_key("by_solutions")

    def _by_key(self, what: str) -> dict[str, dict[str, float]]:
        numbers = (number for number in self.json["numbers"] if number[what] is not None)
        return {number["key"]: dict(zip(self.answers, number[what], strict=True)) for number in numbers}

    def to_pandas(self) -> pandas.DataFrame:
        """``per_cent_per_per_cent`` as a data frame: a row for each number, a column for each answer."""
        import pandas

        return pandas.DataFrame.from_dict(self.per_cent_per_per_cent, orient="index")

    def __repr__(self) -> str:
        most = max(self.per_cent_per_per_cent, key=self._largest, default=None)
        return f"<mtled.Sensitivities of {len(self.answers)} answers, most to {most}>"

    def _largest(self, key: str) -> float:
        return max(map(abs, self.per_cent_per_per_cent[key].values()))


def sensitivity(case: CaseLike, *, of: Sequence[str] = (), check: bool = False, **options: Any) -> Sensitivities:
    """Which numbers of a static case matter most for its answers (``mtled sensitivity``).

    ``of`` names answers such as ``"force/top"`` or ``"displacement/middle.z"``; without names they are
    those of all probes and supports and the strain energy. ``check`` solves the case on both sides of
    each number too.
    """
    document, _ = _table(["sensitivity"], [case], {"of": list(of), "check": check} | options)
    return Sensitivities(document)


def measure_solvers(
    solvers: Mapping[str, str | os.PathLike[str]],
    *cases: CaseLike,
    with_mtled: bool = True,
    **options: Any,
) -> Report:
    """Errors and costs of programs that speak the solver protocol (``mtled contest run``).

    ``solvers`` has commands with ``{job}`` and ``{answer}`` by names, or files of Python that
    :func:`mtled.solver` makes solvers. Without cases all bundled cases with a reference are run.
    """
    given = {name: _command(command) for name, command in solvers.items()}
    if with_mtled:
        given = {"mtled": shlex.join([*_PROGRAM, "protocol", "solve"]) + " {job} {answer}"} | given
    entrants = [f"{name}={command}" for name, command in given.items()]
    options |= {"without_mtled": True, "solver": entrants}
    return _report(["contest", "run"], cases, Path("reports", "contest"), options)


_PROGRAM = (sys.executable, "-m", "mtled")


def _command(command: str | os.PathLike[str]) -> str:
    if isinstance(command, str) and "{job}" in command:
        return command
    file = Path(command)
    if not file.is_file():
        raise FileNotFoundError(f"{file}: is neither a file of Python nor a command with {{job}} and {{answer}}")
    return shlex.join([sys.executable, str(file.resolve())]) + " {job} {answer}"


def _name(case: CaseLike) -> str:
    return case.name if isinstance(case, Case) else Path(case).stem


def _report(command: Sequence[str], cases: Iterable[CaseLike], folder: Path, options: Mapping[str, Any]) -> Report:
    folder = Path(options.get("out") or folder)
    document, outcome = _table(command, cases, {**options, "out": folder})
    return Report(document, outcome, folder)


def _table(
    command: Sequence[str], cases: Iterable[CaseLike], options: Mapping[str, Any]
) -> tuple[dict[str, Any], str]:
    """What a command prints as JSON, and its outcome."""
    with tempfile.TemporaryDirectory(prefix="mtled-") as own:
        arguments = [*command, *(_file(case, Path(own)) for case in cases), "--format", "json", "--quiet"]
        for name, value in options.items():
            if value is not None and value is not False:
                arguments += _option(name, value)
        code, printed, messages = _run(arguments)
    if code == _STOPPED:
        raise KeyboardInterrupt
    if code not in _OUTCOMES or not printed.strip():
        raise _error(messages, code)
    return json.loads(printed), _OUTCOMES[code]


def _file(case: CaseLike, folder: Path) -> str:
    """The file of a case as the program reads it."""
    if not isinstance(case, Case):
        return os.fspath(case)
    if case._core.has_functions:
        raise ValueError(f"{case.name} has a Python function in it, which other processes cannot run: solve it here")
    if case._core.is_bundled and not case.overrides:
        return case.name
    if case._core.is_bundled:
        raise ValueError(f"{case.name} is a bundled case with overrides: give its name, and the overrides as set=[...]")
    file = folder / f"{case.name}.toml"
    file.write_text(case._core.portable_text(), encoding="utf-8")
    return str(file)


def _option(name: str, value: Any) -> list[str]:
    flag = f"--{name.replace('_', '-')}"
    if value is True:
        return [flag]
    if name in ("of", "solver", "set", "reference") and isinstance(value, (list, tuple)):
        return [word for item in value for word in (flag, str(item))]
    if isinstance(value, (list, tuple)):
        value = ",".join(map(str, value))
    return [flag, str(value)]


def _run(arguments: Sequence[str]) -> tuple[int, str, str]:
    process = subprocess.Popen(
        [*_PROGRAM, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, encoding="utf-8"
    )
    try:
        printed, messages = process.communicate()
    except BaseException:
        # Ctrl-C has reached the program too: it stores what it has and ends.
        process.terminate()
        process.communicate()
        raise
    return process.returncode, printed, messages


def _error(messages: str, code: int) -> MtledError:
    errors = []
    for line in messages.splitlines():
        try:
            message = json.loads(line)
        except ValueError:
            message = {"severity": "error", "message": line}
        if message.get("severity") == "error":
            errors.append(message)
    text = "\n".join(error["message"] for error in errors) or f"the program ended with the exit code {code}"
    places = [
        (error["file"], error.get("line", 0), error.get("column", 0), error.get("key", ""), error["message"])
        for error in errors
        if "file" in error
    ]
    return CaseError(text, places) if places else MtledError(text)


def _rows(table: Mapping[str, Any]) -> list[dict[str, Any]]:
    names = [
        column["name"] if column["unit"] in ("", "1") else f"{column['name']} [{column['unit']}]"
        for column in table["columns"]
    ]
    return [dict(zip(names, row, strict=True)) for row in table["rows"]]
