"""The imports of the package have no circles, between files or between folders."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "mtled_reference"
MOST_FILES = 15

CODES = {"fenicsx", "scikit_fem"}
MAY_IMPORT = {
    "shared": set(),
    "fenicsx": {"shared"},
    "scikit_fem": {"shared"},
    "brain": {"shared", *CODES},
    "whole_brain": {"shared", *CODES, "brain"},
    "": {"shared", *CODES, "brain", "whole_brain"},
    "adapters": {"", "shared", *CODES},
    "adapters/simulators": {"adapters"},
}
"""The folders from which the files of a folder may import, beside their own; the root of
the package is ""."""


def module_name(path: Path) -> str:
    """The dotted name of a file; of `__init__.py` that of its folder."""
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_name(path): path for path in sorted(PACKAGE.rglob("*.py"))}


def folder(name: str) -> str:
    """The folder of a module, relative to the package."""
    parent = FILES[name].parent.relative_to(PACKAGE)
    return "" if parent == Path() else parent.as_posix()


def imported(node: ast.AST, path: Path) -> list[str]:
    """Dotted names that an import statement in a file may mean, modules or not."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if not isinstance(node, ast.ImportFrom):
        return []
    base = node.module.split(".") if node.module else []
    if node.level:
        base = [*path.relative_to(PACKAGE.parent).parts[: -node.level], *base]
    return [".".join([*base, alias.name]) for alias in node.names]


def imports(path: Path) -> set[str]:
    """The modules of the package that a file imports anywhere, also in functions."""
    modules = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        for name in imported(node, path):
            # The last part may be a function or class of a module.
            for module in (name, name.rpartition(".")[0]):
                if module in FILES:
                    modules.add(module)
                    break
    return modules


GRAPH = {name: imports(path) for name, path in FILES.items()}


def circle(graph: dict[str, set[str]]) -> str:
    """A circle of the graph as text, empty if there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return " <- ".join(name or "root" for name in error.args[1])
    return ""


def test_the_statements_that_import_are_read():
    lines = (
        "import mtled_reference.shared.case\n"
        "from mtled_reference.shared import case, materials\n"
        "def f():\n    from ..shared.polygon import inside_polygon\n    from . import mesh as m\n"
        "from .. import CODES\n"
    )
    path = PACKAGE / "scikit_fem" / "example.py"
    names = {name for node in ast.walk(ast.parse(lines)) for name in imported(node, path)}
    assert names == {
        "mtled_reference.shared.case",
        "mtled_reference.shared.materials",
        "mtled_reference.shared.polygon.inside_polygon",
        "mtled_reference.scikit_fem.mesh",
        "mtled_reference.CODES",
    }
    assert GRAPH["mtled_reference.solve"] >= {"mtled_reference.brain.fenicsx"}
    assert GRAPH["mtled_reference.__main__"] >= {"mtled_reference"}


def test_files_do_not_import_in_a_circle():
    assert circle(GRAPH) == ""


def test_folders_do_not_import_in_a_circle():
    graph = {name: set() for name in MAY_IMPORT}
    for name, modules in GRAPH.items():
        graph[folder(name)] |= {folder(module) for module in modules} - {folder(name)}
    assert circle(graph) == ""


@pytest.mark.parametrize("name", FILES)
def test_a_file_imports_from_folders_below_its_own(name):
    allowed = MAY_IMPORT[folder(name)] | {folder(name)}
    assert {module for module in GRAPH[name] if folder(module) not in allowed} == set()


@pytest.mark.parametrize("name", [n for n, path in FILES.items() if path.stem == "__init__"])
def test_importing_a_folder_imports_nothing_else(name):
    assert GRAPH[name] == set()


@pytest.mark.parametrize("path", [PACKAGE, *(PACKAGE / name for name in MAY_IMPORT if name)])
def test_a_folder_has_few_files(path):
    assert len(list(path.glob("*.py"))) <= MOST_FILES
