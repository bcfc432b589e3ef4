#!/usr/bin/env python3
"""Runs the commands of the guide as a reader would: each page in an empty folder, its blocks in
their order, with the program on the path; two pages at a time.

usage: commands.py --mtled PROGRAM [--pictures] [PAGE …]

What the info string of a code block says:

    toml file=NAME          the block is saved as NAME, before the first command of the page
    sh                      the block is run and ends with exit code 0
    sh exit=3               … with this one
    sh not-run="REASON"     it is not run; counted, and printed with its reason
    text output             every line stands in what the block before it printed, but for its
                            figures; … stands for anything

--pictures also copies the SVG files that the gallery has drawn into src/pictures.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from pages import GUIDE, ROOT, Page, blocks, pages

LARGEST_PICTURE = 300_000  # bytes
SLOW = 5.0  # seconds, of a block that is named


def masked(text):
    """Without figures and the width of blanks."""
    text = re.sub(r"[−-]?\d[\d.,]*(?:e[−-]?\d+|×10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?", "0", text)
    return re.sub(r"\s+", " ", text).strip()


def absent(expected, printed):
    """Lines that were expected and not printed."""
    printed = [masked(line) for line in printed.splitlines()]

    def stands(line):
        pattern = ".*".join(re.escape(part) for part in masked(line).split("…"))
        return any(re.search(pattern, other) for other in printed)

    return [line for line in expected.splitlines() if line.strip() and not stands(line)]


def programs_of(mtled, scratch):
    """A folder with the program under its own name."""
    programs = scratch / "programs"
    programs.mkdir()
    (programs / "mtled").symlink_to(mtled.resolve())
    return programs


class Runner:
    """Runs one page."""

    def __init__(self, programs, scratch):
        python = Path(sys.executable).parent
        self.scratch = scratch
        self.environment = dict(os.environ, NO_COLOR="1", PATH=f"{programs}:{python}:{os.environ['PATH']}")
        self.run, self.skipped, self.faults = 0, [], []

    def page(self, page):
        """All blocks of a page."""
        folder = self.scratch / page.name
        folder.mkdir()
        where, start, printed = page.source.relative_to(ROOT), time.monotonic(), ""
        for block in blocks(page.source):
            if "file" in block.options:
                (folder / block.options["file"]).write_text(block.text, encoding="utf-8")
        for block in blocks(page.source):
            place = f"{where}:{block.line}"
            if block.language == "sh":
                reason = block.options.get("not-run")
                if reason is not None:
                    self.skipped.append(f"{place}: {reason}")
                    continue
                printed = self.block(block, place, folder)
            elif "output" in block.options:
                for line in absent(block.text, printed):
                    self.faults.append(f"{place}: not printed by the command: {line}")
        if self.run:
            print(f"{where}: {self.run} blocks, {time.monotonic() - start:.1f} s", flush=True)
        return self

    def block(self, block, place, folder):
        self.run, start = self.run + 1, time.monotonic()
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", block.text], cwd=folder,
                              env=self.environment, stdin=subprocess.DEVNULL, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if time.monotonic() - start > SLOW:
            print(f"{place}: {time.monotonic() - start:.1f} s", flush=True)
        expected = int(block.options.get("exit", 0))
        if done.returncode != expected:
            tail = "\n    ".join(done.stdout.splitlines()[-15:])
            self.faults.append(f"{place}: exit code {done.returncode} instead of {expected}\n    {tail}")
        return done.stdout


def pictures(folder, faults, keep):
    """What the gallery shows is what its commands have drawn, and small."""
    for picture in sorted((GUIDE / "src" / "pictures").glob("*.svg")):
        if not (folder / picture.name).is_file():
            faults.append(f"{picture.name}: no command of the gallery draws it")
    for picture in sorted(folder.glob("*.svg")):
        if picture.stat().st_size > LARGEST_PICTURE:
            faults.append(f"{picture.name}: {picture.stat().st_size} bytes")
        if keep:
            shutil.copyfile(picture, GUIDE / "src" / "pictures" / picture.name)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--mtled", type=Path, required=True)
    parser.add_argument("--pictures", action="store_true")
    parser.add_argument("names", nargs="*", metavar="PAGE")
    arguments = parser.parse_args()
    readme = Page("README", ROOT / "README.md", "first_page")
    chosen = [page for page in [readme, *pages()] if not arguments.names or page.name in arguments.names]
    with tempfile.TemporaryDirectory() as scratch:
        programs = programs_of(arguments.mtled, Path(scratch))
        with ThreadPoolExecutor(max_workers=2) as pool:
            done = list(pool.map(lambda page: Runner(programs, Path(scratch)).page(page), chosen))
        faults = [fault for runner in done for fault in runner.faults]
        if any(page.name == "gallery" for page in chosen):
            pictures(Path(scratch) / "gallery", faults, arguments.pictures)
    skipped = [reason for runner in done for reason in runner.skipped]
    for line in skipped:
        print(f"not run: {line}")
    for line in faults:
        print(line, file=sys.stderr)
    print(f"{sum(runner.run for runner in done)} blocks of commands run, {len(skipped)} not run, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
