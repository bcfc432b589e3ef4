"""Figures of mtled by commit: writes history.csv from the versions of baseline.json that git knows.

    python3 reports/history.py                   # in a checkout with its history

`mtled contest pages reference/results --history reports/history.csv` draws them."""

import json
import subprocess
from pathlib import Path

HERE = Path(__file__).parent
KINDS = ("comparison/", "work/")
LAST = ("/displacement", "/evaluations")


def git(*arguments: str) -> str:
    """What git prints."""
    call = ["git", "-C", str(HERE), *arguments]
    return subprocess.run(call, check=True, capture_output=True, text=True).stdout


def main() -> None:
    log = git("log", "--reverse", "--format=%as %h", "--", "baseline.json")
    rows = ["date,commit,figure,value"]
    for line in log.splitlines():
        date, commit = line.split()
        checks = json.loads(git("show", f"{commit}:./baseline.json"))["checks"]
        for check in checks:
            if check["id"].startswith(KINDS) and check["id"].endswith(LAST):
                rows.append(f"{date},{commit},{check['id']},{check['value']!r}")
    (HERE / "history.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
