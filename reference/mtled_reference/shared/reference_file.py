"""The reference file of a case: values of both codes on three meshes each."""

import json
from pathlib import Path

from .case import Case
from .problem_hash import problem_hash

SCHEMA_VERSION = 1


def reference(case: Case, times: list[float], solutions: list[dict]) -> dict:
    """The content of a reference file."""
    return {
        "schema_version": SCHEMA_VERSION,
        "case": case.name,
        "problem_hash": problem_hash(case.document, case.folder),
        "times_s": times,
        "solutions": solutions,
    }


def merged(case: Case, contents: list[dict]) -> dict:
    """One reference from several; the last solution of each code is kept.

    Contents of another problem or with other instants are refused.
    """
    solutions = {}
    times = contents[-1]["times_s"]
    expected = problem_hash(case.document, case.folder)
    for content in contents:
        if content["problem_hash"] != expected:
            raise ValueError(f"a solution of {content['case']} belongs to another problem")
        if content["times_s"] != times:
            raise ValueError(f"the solutions of {case.name} have different instants")
        for solution in content["solutions"]:
            solutions[solution["code"]] = solution
    return reference(case, times, [solutions[code] for code in sorted(solutions)])


def merge_into(case: Case, folder: Path, solution_paths: list[Path]) -> Path:
    """Merges solutions into `folder`/CASE.json and returns its path.

    Stored solutions of another version of the problem are dropped.
    """
    path = folder / f"{case.name}.json"
    contents = [json.loads(solution.read_text()) for solution in solution_paths]
    if path.exists():
        stored = json.loads(path.read_text())
        if stored["problem_hash"] == contents[-1]["problem_hash"]:
            contents.insert(0, stored)
    folder.mkdir(parents=True, exist_ok=True)
    write(path, merged(case, contents))
    return path


def write(path: Path, content: dict) -> None:
    """Writes JSON with one line per entry of a table and arrays of numbers on one line."""
    path.write_text(_encoded(content, "") + "\n")


def _encoded(value, indent: str) -> str:
    deeper = indent + " "
    if isinstance(value, dict) and value:
        rows = [f"{deeper}{json.dumps(key)}: {_encoded(value[key], deeper)}" for key in value]
        return "{\n" + ",\n".join(rows) + "\n" + indent + "}"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        rows = [deeper + _encoded(item, deeper) for item in value]
        return "[\n" + ",\n".join(rows) + "\n" + indent + "]"
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
