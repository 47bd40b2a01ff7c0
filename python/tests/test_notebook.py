"""The example notebook runs to its end."""

import os
import pathlib

import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parent.parent / "examples"


def test_the_notebook_runs_to_its_end(tmp_path):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    pytest.importorskip("pandas")
    notebook = nbformat.read(EXAMPLES / "wayword.ipynb", as_version=4)
    # Nothing of a run is kept in the repository.
    assert all(not cell.get("outputs") for cell in notebook.cells)
    environment = {"PYTHONPATH": os.environ.get("PYTHONPATH", "")}
    client = nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}})
    with pytest.MonkeyPatch.context() as patch:
        for name, value in environment.items():
            patch.setenv(name, value)
        client.execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert not [output for output in shown if output["output_type"] == "error"]
    pages = [output["data"]["text/html"] for output in shown if "text/html" in output.get("data", {})]
    assert any("data:image/jpeg;base64," in page for page in pages), "cards with frames"
    world = next(cell.source for cell in notebook.cells if "class Hall" in cell.source)
    assert len([line for line in world.splitlines() if line.strip()]) <= 25
