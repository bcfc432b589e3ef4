"""The notebook runs from its first to its last cell."""

import shutil
from pathlib import Path

import pytest

NAME = "label_map_to_warped_image.ipynb"
NOTEBOOK = Path(__file__).parents[1] / "examples" / NAME


def test_the_notebook_goes_from_a_label_map_to_a_warped_image_and_a_picture(label_map, tmp_path):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    code = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "code")
    lines = [line for line in code.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    assert len(lines) < 30
    # The folders of the checkout, so that nothing is written there.
    folder = tmp_path / "verify" / "python" / "examples"
    folder.mkdir(parents=True)
    (tmp_path / "reference" / "brain").mkdir(parents=True)
    shutil.copy(label_map, tmp_path / "reference" / "brain")
    client = nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(folder)}})
    client.execute()
    assert (folder / "warped.nrrd").stat().st_size > 1000 and (folder / "brain.svg").stat().st_size > 1000
