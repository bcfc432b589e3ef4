from pathlib import Path

import mtled
import pytest

CUBE = "cube_compression"


@pytest.fixture(scope="session")
def cube():
    """The result of a case with a single material."""
    return mtled.load(CUBE).solve(error_bars=False)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A working folder of its own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="session")
def label_map():
    """The label map of the brain slice in the checkout."""
    return Path(__file__).parents[3] / "reference" / "brain" / "slice.nrrd"
