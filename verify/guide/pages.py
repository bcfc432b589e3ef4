"""The pages of the guide: which there are, what their code blocks are for."""

import re
import shlex
from dataclasses import dataclass, field
from pathlib import Path

from markdown_it import MarkdownIt

GUIDE = Path(__file__).resolve().parent
ROOT = GUIDE.parent.parent
SUMMARY = GUIDE / "src" / "SUMMARY.md"


@dataclass
class Page:
    """One file of the repository that the site shows."""

    title: str
    source: Path
    name: str  # of the page in the site, without .html


@dataclass
class Part:
    """Pages under one title in the contents."""

    title: str
    pages: list = field(default_factory=list)


@dataclass
class Block:
    """A fenced code block: its language, what its info string says besides, its text."""

    language: str
    options: dict
    text: str
    line: int


def contents():
    """Parts of the site with their pages, in the order of SUMMARY.md."""
    parts = [Part("")]
    for line in SUMMARY.read_text(encoding="utf-8").splitlines():
        entry = re.fullmatch(r"- \[(.+)\]\((.+)\)", line)
        if line.startswith("## "):
            parts.append(Part(line.removeprefix("## ")))
        elif entry:
            source = (SUMMARY.parent / entry[2]).resolve()
            name = source.parent.name if source.stem == "README" else source.stem
            parts[-1].pages.append(Page(entry[1], source, name.lower()))
    names = [page.name for part in parts for page in part.pages]
    assert len(set(names)) == len(names), f"two pages of one name: {sorted(names)}"
    return parts


def pages():
    return [page for part in contents() for page in part.pages]


def reader():
    return MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"])


def options_of(info):
    """`sh exit=3 not-run="a reason"` is the language and a table."""
    words = shlex.split(info)
    pairs = (word.partition("=")[::2] for word in words[1:])
    return (words[0] if words else ""), dict(pairs)


def blocks(source):
    """Fenced code blocks of a file, in order."""
    found = []
    for token in reader().parse(source.read_text(encoding="utf-8")):
        if token.type == "fence":
            language, options = options_of(token.info)
            found.append(Block(language, options, token.content, token.map[0] + 1))
    return found
