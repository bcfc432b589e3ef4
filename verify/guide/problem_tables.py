#!/usr/bin/env python3
"""Writes the dataclasses of the Python package from the JSON Schema of the program.

usage: problem_tables.py PROGRAM [--check]

A table of a case file is a dataclass. A key is a field, with its unit at the end of its name, and None where it is
left out; its description stands below it, where editors find it. --check writes nothing and fails where a module is
not that of the program. What the schema cannot say, since Python says it in another way, are the tables below.
"""

import ast
import re
import runpy
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

from schema import Schema, choices, default_of, name_of, unit_of, write

FOLDER = Path(__file__).resolve().parents[1] / "python" / "mtled" / "problem"
OWN = runpy.run_path(str(FOLDER / "_tables.py"))
UNITS, key_of = OWN["UNITS"], OWN["key_of"]
WIDTH = 120
WRITTEN = "Written by verify/guide/problem_tables.py from `mtled case schema`; do not edit."

# Modules: what they are about, and the keys of the file whose tables they hold; the last has the file itself.
MODULES = {
    "shapes": ("Shapes, selections and regions.", ["geometry", "region"]),
    "materials": ("Materials.", ["material"]),
    "conditions": (
        "Conditions, loads and obstacles.",
        ["prescribe", "body_force", "traction", "pressure", "spring", "cavity", "initial_velocity", "obstacle"],
    ),
    "recipe": ("The discretisation and time.", ["discretisation", "time"]),
    "statement": ("Probes, output and the whole case.", None),
}
RENAMED = {"Discretisation": "Recipe", "Plane": "PlaneStrain", "shape": "InShape"}
# Names for what stands in a case file without keys.
UNNAMED = {
    "union": ["parts"],
    "intersection": ["parts"],
    "difference": ["first", "second"],
    "not": ["part"],
    "shape": ["shape"],
    "table": ["rows"],
    "coulomb": ["coefficient"],
}
DEFAULTS = {("Prescribe", "of"): "surface", ("Recipe", "cloud"): "regular"}
# One field for the keys of which one is given; it may be a function, too.
MOTION = "Prescribe"
# The whole case, which mtled.problem.Problem is made of.
CASE = "Statement"


@dataclass
class Field:
    """A field of a dataclass."""

    name: str
    kind: str
    words: str
    needed: bool = True
    positional: bool = True
    default: str = ""

    def lines(self):
        default = self.default if self.needed else " = None"
        kind = self.kind if self.needed else f"{self.kind} | None"
        return [f"    {self.name}: {kind}{default}", *docstring(self.words, "    ")]


def docstring(words, indent):
    lines = textwrap.wrap(
        words.replace("\\", "\\\\"), WIDTH, initial_indent=f'{indent}"""', subsequent_indent=indent,
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip
    if lines and len(lines[-1]) + 3 > WIDTH:
        lines.append(indent)
    return lines[:-1] + [lines[-1] + '"""'] if lines else []


def listed(start, parts, end):
    """A list on one line, or on one line for each part."""
    line = start + ", ".join(parts) + end
    return [line] if len(line) <= WIDTH else [start, *(f"    {part}," for part in parts), end]


def table_lines(name, words, fields, inner=(), base=""):
    """A dataclass: what is positional first, then what goes by name."""
    first = [part for part in fields if part.positional]
    rest = [part for part in fields if not part.positional]
    lines = ["@dataclass", f"class {name}{base}:", *docstring(words, "    "), ""]
    lines += inner
    for part in first:
        lines += part.lines()
    if rest:
        lines.append("    _: KW_ONLY")
    for part in rest:
        lines += part.lines()
    return [*lines, "", ""]


class Tables(Schema):
    def class_of(self, name):
        name = RENAMED.get(name, name)
        return "".join(part[:1].upper() + part[1:] for part in name.split("_"))

    def kind_of(self, schema, key=""):
        """A type in Python."""
        if "$ref" in schema:
            return self.class_of(name_of(schema["$ref"]))
        if "anyOf" in schema:
            return " | ".join(self.kind_of(s) for s in schema["anyOf"] if s.get("type") != "null")
        kinds = schema["type"]
        kind = next(k for k in kinds if k != "null") if isinstance(kinds, list) else kinds
        if kind == "array":
            inner = [self.kind_of(s) for s in schema.get("prefixItems", [schema.get("items")])]
            return f"Sequence[{' | '.join(dict.fromkeys(inner))}]"
        if kind == "object":
            return f"Mapping[str, {self.kind_of(schema['additionalProperties'])}]"
        if kind == "string":
            return "Path" if key == "file" else "str"
        return {"number": "float", "integer": "int", "boolean": "bool"}[kind]

    def field(self, owner, key, schema, needed):
        words, kind = self.words(schema), self.kind_of(schema, key)
        number = re.sub(r"Sequence|\W", "", kind) in ("int", "float")
        name = key + UNITS[unit_of(words)] if number else key
        assert key_of(name) == key, f"{owner}.{key} ends as if it had a unit"
        default = DEFAULTS.get((owner, key), "")
        if default_of(schema).strip('"') and "left out" not in words:
            words += f" Default: {default_of(schema)}."
        # Components, and the vector of which another key may take the place.
        vector = number and bool(re.search("left out where (another|a) .* is given", words)) and "Sequence" in kind
        positional = needed and not default or key in ("x", "y", "z") or vector
        return Field(name, kind, words, needed, positional, f' = "{default}"' if default else "")

    def fields(self, owner, schema):
        keys, needed = schema["properties"], schema.get("required", [])
        order = needed + [key for key in keys if key not in needed]
        return [self.field(owner, key, keys[key], key in needed) for key in order]

    def motion(self, fields):
        """Keys of which one is given, as one field."""
        kinds = [part for part in fields if part.words.endswith("left out where another kind is given.")]
        keys = ", ".join(f'"{part.name}"' for part in kinds)
        motion = Field(
            "motion", " | ".join([*(part.kind for part in kinds), "Function"]),
            "One of these tables, or a function of x, y and z that returns three numbers [m].",
            default=f' = field(\n        metadata={{"keys": ({keys})}}\n    )',
        )  # fmt: skip
        return [*(part for part in fields if part not in kinds), motion]

    def unnamed(self, key, schema):
        """What stands in a case file without keys."""
        names = UNNAMED[key]
        parts = schema["prefixItems"] if len(names) > 1 else [schema]
        return [Field(name, self.kind_of(part), "") for name, part in zip(names, parts, strict=True)]

    def variant(self, key):
        """A table with one key, which names its kind; shapes may be selections too."""
        words, found = [], {}
        uses = [
            (name, row) for name in self.order() for row in self.definitions[name].get("oneOf", [])
            if key in row.get("properties", {})
        ]  # fmt: skip
        for name, row in uses:
            inner = row["properties"][key]
            said = self.words(row)
            if said not in words:
                words.append(f"As a selection: {said[0].lower()}{said[1:]}" if words else said)
            parts = self.fields(name, inner) if "properties" in inner else self.unnamed(key, inner)
            for part in parts:
                known = found.setdefault(part.name, part)
                if known.kind != part.kind:
                    # Sequence[Shape] and Sequence[Selector] are Sequence[Shape | Selector].
                    other = re.sub(r".*\[|\]", "", part.kind)
                    known.kind = re.sub(r"(\]*)$", rf" | {other}\1", known.kind, count=1)
        inner = [f'    kind: ClassVar[str] = "{key}"']
        base = "(Unnamed)" if key in UNNAMED else ""
        return table_lines(self.class_of(key), " ".join(words), list(found.values()), inner, base)

    def methods(self, name, schema):
        """A dataclass for each method of time: keys belong to the one that the words of the table name for them."""
        words = self.words(schema)
        owner = {
            key: method
            for keys, method in re.findall(r'([^.;]+?)(?: belong to method| to) "(\w+)"', words)
            for key in re.findall(r"`(\w+)`", keys)
        }
        values = self.definitions[schema["properties"]["method"]["$ref"].rsplit("/", 1)[-1]]
        found = dict(choices(values.get("oneOf", [values])))
        assert set(owner.values()) == set(found) and set(owner) < set(schema["properties"]), owner
        lines = []
        for method, words in found.items():
            parts = [part for part in self.fields(name, schema) if part.name != "method"]
            for part in parts:
                other = re.search(r'left out for method "(\w+)" only', part.words)
                part.needed = part.positional = bool(other) and other[1] != method
            own = [part for part in parts if owner.get(key_of(part.name), method) == method]
            stated = f'    method: str = field(default="{method}", init=False, repr=False)'
            lines += table_lines(self.class_of(method), words, own, [stated])
        return lines + [f"{name} = {' | '.join(self.class_of(method) for method in found)}", "", ""]

    def choice(self, name, schema):
        """Words to choose from, and tables with one key, those first."""
        lines, kinds = [], []
        for row in schema.get("oneOf", []):
            for key in row.get("properties", {}):
                kinds.append(self.class_of(key))
                if key not in self.met:
                    self.met.add(key)
                    lines += self.variant(key)
        words = list(choices(schema.get("oneOf", [schema])))
        if words:
            kinds += ["Literal[" + ", ".join(f'"{word}"' for word, _ in words) + "]"]
        line = f"{name} = {' | '.join(kinds)}"
        if len(line) <= WIDTH:
            lines.append(line)
        elif len(kinds) > 1:
            lines += [f"{name} = (", f"    {kinds[0]}", *(f"    | {kind}" for kind in kinds[1:]), ")"]
        else:
            lines += listed(f"{name} = Literal[", [f'"{word}"' for word, _ in words], "]")
        said = [f'"{word}": {text}' for word, text in words if text and "oneOf" in schema]
        lines += docstring(" ".join([self.words(schema), *said]), "")
        return [*lines, "", ""]

    def definition(self, name):
        schema, own = self.definitions[name], self.class_of(name_of(name))
        if "properties" not in schema:
            return self.choice(own, schema)
        if "method" in schema["properties"]:
            return self.methods(own, schema)
        fields = self.fields(own, schema)
        return table_lines(own, self.words(schema), self.motion(fields) if own == MOTION else fields)

    def file(self):
        """The case itself; the shape of its geometry is its own, and may be a function."""
        (shape,) = self.fields("Geometry", self.definitions["GeometryFormat"])
        shape.kind += " | Distance"
        fields = [shape if part.name == "geometry" else part for part in self.fields(CASE, self.root)]
        return table_lines(CASE, self.words(self.root), fields)

    def modules(self):
        """Texts of modules by their names."""
        self.met, homes, texts = set(), {}, {}
        done = {"GeometryFormat", "MethodFormat"}
        for module, (about, keys) in MODULES.items():
            names = [name for name in self.order(keys) if name not in done]
            done |= set(names)
            lines = [line for name in names for line in self.definition(name)]
            lines += [] if keys else self.file()
            body = "\n".join(lines).rstrip() + "\n"
            texts[module] = head(about, body, homes)
            homes |= dict.fromkeys(defined(body, (ast.ClassDef, ast.Assign)), module)
        return texts


def defined(body, kinds):
    parts = [part for part in ast.parse(body).body if isinstance(part, kinds)]
    return sorted(part.name if isinstance(part, ast.ClassDef) else part.targets[0].id for part in parts)


def head(about, body, homes):
    """The docstring, imports and public names of a module before the rest of it."""
    own = ["Distance", "Function", "Path", "Unnamed"]
    sources = {name: f"._{module}" for name, module in homes.items()} | dict.fromkeys(own, "._tables")
    sources |= dict.fromkeys(["Mapping", "Sequence"], "collections.abc")
    sources |= dict.fromkeys(["KW_ONLY", "dataclass", "field"], "dataclasses")
    sources |= dict.fromkeys(["ClassVar", "Literal"], "typing")
    names = [part for part in ast.walk(ast.parse(body)) if isinstance(part, ast.Name)]
    used = {part.id for part in names if isinstance(part.ctx, ast.Load)} & set(sources)
    lines = [f'"""{about}', "", WRITTEN, '"""', "", "from __future__ import annotations", ""]
    for source in sorted({sources[name] for name in used}, key=lambda source: (source[0] == ".", source)):
        names = sorted((name for name in used if sources[name] == source), key=lambda name: (not name.isupper(), name))
        if source[0] == "." and lines[-1] and lines[-1][5:6] != ".":
            lines.append("")
        line = f"from {source} import {', '.join(names)}"
        lines += [line] if len(line) <= WIDTH else listed(f"from {source} import (", names, ")")
    public = [f'"{name}"' for name in defined(body, ast.ClassDef) if name != CASE]
    lines += ["", *listed("__all__ = [", public, "]")]
    return "\n".join(lines) + "\n\n\n" + body


def main():
    texts = Tables(sys.argv[1]).modules()
    written = [write(FOLDER / f"_{name}.py", text) for name, text in texts.items()]
    print(f"{sum(text.count('@dataclass') for text in texts.values())} tables in {len(texts)} modules")
    return 0 if all(written) else 1


if __name__ == "__main__":
    sys.exit(main())
