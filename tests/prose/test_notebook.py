"""The notebook runs from top to bottom, and environments show themselves in it."""

from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).parents[2] / "docs/tutorials/notebook.ipynb"


@pytest.mark.thorough
@pytest.mark.filterwarnings("default")
def test_the_notebook_runs_and_shows_its_environments(tmp_path):
    nbclient = pytest.importorskip("nbclient", reason="extra docs")
    nbformat = pytest.importorskip("nbformat", reason="extra docs")
    book = nbformat.read(NOTEBOOK, as_version=4)
    assert not any(cell.get("outputs") for cell in book.cells), "clear the outputs"
    nbclient.NotebookClient(
        book, timeout=600, resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    shown = [
        output["data"].get("text/html", "")
        for cell in book.cells
        for output in cell.get("outputs", ())
        if output["output_type"] == "execute_result"
    ]
    assert [html.count("data:image/png;base64,") for html in shown] == [1, 1, 6]
