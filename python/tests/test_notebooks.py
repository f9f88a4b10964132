"""The worked notebooks run, and draw what they are to draw."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOKS = sorted((Path(__file__).parent.parent / "notebooks").glob("*.ipynb"))


@pytest.mark.usefixtures("client")
@pytest.mark.parametrize(("path", "pictures"), list(zip(NOTEBOOKS, [4, 3, 3], strict=True)), ids=lambda p: str(p)[-20:])
def test_a_notebook_runs(path, pictures):
    book = nbformat.read(path, as_version=4)
    assert all(not cell.get("outputs") for cell in book.cells), "outputs are not kept"
    NotebookClient(book, timeout=300, kernel_name="python3", resources={"metadata": {"path": path.parent}}).execute()
    outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == pictures
    assert not [output for output in outputs if output.output_type == "stream" and output.name == "stderr"]
