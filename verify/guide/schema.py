"""The JSON Schema of case files that the program prints, for what is written from it."""

import difflib
import json
import re
import subprocess
import sys


def name_of(reference):
    """#/$defs/GridFormat → Grid."""
    return re.sub(r"Format$", "", reference.rsplit("/", 1)[-1])


def unit_of(words):
    """The unit that a description states in square brackets."""
    unit = re.search(r"\[([^\]]+)\]", words)
    return unit[1] if unit else ""


def default_of(schema):
    """What counts where a key is left out, as it is written; tables and lists say it in words."""
    default = schema.get("default")
    return "" if default is None or isinstance(default, (list, dict)) else json.dumps(default, ensure_ascii=False)


def choices(variants):
    """The words to choose from, and their descriptions."""
    for variant in variants:
        for word in variant.get("enum", [variant["const"]] if "const" in variant else []):
            yield word, " ".join(variant.get("description", "").split())


class Schema:
    def __init__(self, program):
        self.root = json.loads(subprocess.check_output([program, "case", "schema"]))
        self.definitions = self.root["$defs"]

    def words(self, schema):
        """The description of a key, or of its type."""
        if "description" in schema:
            return " ".join(schema["description"].split())
        for inner in [schema, *schema.get("anyOf", [])]:
            if "$ref" in inner:
                return self.words(self.definitions[inner["$ref"].rsplit("/", 1)[-1]])
        return ""

    def order(self, keys=None):
        """Definitions in the order in which a reader meets them who starts at keys of the file, by default all."""
        met = []

        def visit(schema):
            found = re.findall(r'"\$ref": "#/\$defs/(\w+)"', json.dumps(schema))
            new = [name for name in dict.fromkeys(found) if name not in met]
            for name in new:
                if name not in met:
                    met.append(name)
                    visit(self.definitions[name])

        for key in keys or self.root["required"] + list(self.root["properties"]):
            visit(self.root["properties"][key])
        assert keys or set(met) == set(self.definitions), set(self.definitions) - set(met)
        return met


def write(path, text):
    """Writes a file; with --check shows how it would change instead. Whether it is now as it should be."""
    if "--check" not in sys.argv:
        path.write_text(text, encoding="utf-8")
        return True
    old = path.read_text(encoding="utf-8") if path.exists() else ""
    if old != text:
        print(f"{path} is not that of {sys.argv[1]}: run {sys.argv[0]} again", file=sys.stderr)
        lines = difflib.unified_diff(old.splitlines(), text.splitlines(), "now", "as it should be", n=0, lineterm="")
        print("\n".join(lines), file=sys.stderr)
    return old == text
