"""What the first page shows works."""

import re
from pathlib import Path

import mtled

BLOCKS = re.findall(r"```python\n(.*?)```", (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8"), re.S)


def test_the_block_of_the_first_page_is_solved():
    names = {}
    exec(next(block for block in BLOCKS if "Stretched block" in block), names)
    assert isinstance(names["result"], mtled.Result)
    assert names["result"].displacement_m[:, 2].max() > 0.019


def test_the_first_lines_of_the_first_page_run_on_a_case_file(here):
    (here / "my_case.toml").write_text(mtled.bundled()["cube_compression"])
    lines = BLOCKS[0].replace("0.004", "0.025").splitlines()
    shown = [line for line in lines if "plot" not in line and "warp" not in line]
    exec("\n".join(shown), {})
    assert (here / "body.svg").is_file()
