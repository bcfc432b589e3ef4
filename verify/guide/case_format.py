#!/usr/bin/env python3
"""Writes the page of the case format from the JSON Schema of the program.

usage: case_format.py PROGRAM [--check]

Every key must have a description, every number its unit, and a key that may be left out must say
what then counts. --check writes nothing and fails where the page is not that of the program.
"""

import re
import sys

from pages import GUIDE
from schema import Schema, choices, default_of, name_of, unit_of, write

PAGE = GUIDE / "src" / "case_format.md"
FIRST = """# The case format

<!-- Written by case_format.py from `mtled case schema`; do not edit. -->

A case file is written in [TOML](https://toml.io) and states one problem: lengths in m, masses in kg,
times in s, stresses in Pa, angles in rad. Unknown keys are refused. `mtled case schema` prints the
same as a JSON Schema, which editors use for completion; `mtled case check` finds the mistakes in a
file, and `mtled case show cube_compression` prints a bundled case as a start:

```sh
mtled case show cube_compression > my_case.toml
mtled case check my_case.toml
mtled case schema > schema.json
```

*Default* is what counts where the key is left out; **needed** keys have none, and where it is a dash
the description says when the key may be left out. Paths are relative to the case file.
"""


def title(name):
    """GridFormat → Grid; HalfSpace → Half space."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).capitalize()


def link(name):
    text = title(name)
    return f"[{text.lower()}](#{text.lower().replace(' ', '-')})"


class Format(Schema):
    def __init__(self, program):
        super().__init__(program)
        self.faults, self.keys = [], 0

    def type_of(self, schema):
        """A type in words, links for the program's own."""
        if "$ref" in schema:
            return link(name_of(schema["$ref"]))
        if "anyOf" in schema:
            return " or ".join(self.type_of(s) for s in schema["anyOf"] if s.get("type") != "null")
        kinds = schema.get("type", "")
        kind = next((k for k in kinds if k != "null"), "") if isinstance(kinds, list) else kinds
        if kind == "array":
            if "prefixItems" in schema:
                return "(" + ", ".join(self.type_of(s) for s in schema["prefixItems"]) + ")"
            count, inner = schema.get("maxItems"), self.type_of(schema.get("items", {}))
            return f"{count} × {inner}" if count else f"list of {inner}"
        if kind == "object" and isinstance(schema.get("additionalProperties"), dict):
            return f"table of {self.type_of(schema['additionalProperties'])} by name"
        return {"object": "table", "integer": "whole number", "string": "text"}.get(kind, kind)

    def row(self, place, key, schema, needed):
        self.keys += 1
        words, kind = self.words(schema), self.type_of(schema)
        unit = unit_of(words)
        if not words:
            self.faults.append(f"{place}.{key} has no description")
        if "number" in kind.replace("whole number", "") and not unit and "list" not in kind:
            self.faults.append(f"{place}.{key} has no unit: {words}")
        stated = re.search(r"(\S+) if left out|(\"\w+\") if left out", words)
        default = "–"
        if needed:
            default = "**needed**"
        elif default_of(schema):
            default = f"`{default_of(schema)}`"
        elif stated:
            default = "`" + stated[1].strip("(;,") + "`"
            if not re.fullmatch(r"`(\"\w+\"|[\d.e-]+)`", default):
                default = "–"
        elif "left out" not in words and "default" not in schema:
            self.faults.append(f"{place}.{key} does not say what counts where it is left out")
        words = words.replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")
        return f"| `{key}` | {kind} | {unit} | {default} | {words} |"

    def table(self, place, schema):
        if not schema.get("properties"):
            return []
        needed = schema.get("required", [])
        rows = ["| key | type | unit | default | |", "|---|---|---|---|---|"]
        first = sorted(schema["properties"], key=lambda key: (key not in needed, key.lower()))
        return rows + [self.row(place, key, schema["properties"][key], key in needed) for key in first] + [""]

    def choice(self, place, variants):
        """Words to choose from, and tables with one key."""
        lines, words = [], list(choices(variants))
        if words:
            lines += ["| value | |", "|---|---|"]
            for word, description in words:
                self.keys += 1
                text = description.replace("|", "\\|").replace("*", "\\*")
                lines.append(f'| `"{word}"` | {text} |')
            lines.append("")
        for variant in variants:
            for key, inner in variant.get("properties", {}).items():
                self.keys += 1
                words = " ".join(variant.get("description", "").split())
                if not words:
                    self.faults.append(f"{place}.{key} has no description")
                inside = f"`{{ {key} = {{ … }} }}`" if "properties" in inner else f"`{{ {key} = … }}`, {self.type_of(inner)}"
                lines += [f"**{inside}** {words}", ""] + self.table(f"{place}.{key}", inner)
        return lines

    def section(self, name, schema):
        lines = [f"## {title(name)}", ""]
        if schema.get("description"):
            lines += [" ".join(schema["description"].split()).replace("*", "\\*"), ""]
        if "oneOf" in schema:
            return lines + self.choice(name, schema["oneOf"])
        if "enum" in schema:
            return lines + self.choice(name, [schema])
        return lines + self.table(name, schema)

    def page(self):
        lines = [FIRST, *self.section("The file", {k: v for k, v in self.root.items() if k != "description"})]
        for name in self.order():
            lines += self.section(name_of(name), self.definitions[name])
        return "\n".join(lines).rstrip() + "\n"


def main():
    schema = Format(sys.argv[1])
    written = write(PAGE, schema.page())
    for fault in schema.faults:
        print(fault, file=sys.stderr)
    print(f"{schema.keys} keys and values, {len(schema.faults)} faults")
    return 1 if schema.faults or not written else 0


if __name__ == "__main__":
    sys.exit(main())
