"""The notebooks run at a small size, and are kept without outputs."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

NOTEBOOKS = Path(__file__).resolve().parents[1] / "notebooks"

#: Values of the cell with the tag `parameters` in place of its own, and a part of what the notebook then prints.
SMALL: dict[str, tuple[dict[str, Any], str]] = {
    "own_tunnel.ipynb": ({"DURATION": 0.05}, "report.html"),
    "ground_motion.ipynb": ({"CELLS": 20}, "peak of the surface over that of the outcrop: 1.0"),
    "own_law.ipynb": ({"CELLS": 3}, "elements are softened"),
}


def read(name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((NOTEBOOKS / name).read_text(encoding="utf-8"))
    return found


def test_every_notebook_is_run() -> None:
    """All notebooks of the folder are among those that run."""
    assert sorted(file.name for file in NOTEBOOKS.glob("*.ipynb")) == sorted(SMALL)


@pytest.mark.parametrize("name", SMALL)
def test_outputs_are_not_kept(name: str) -> None:
    """A notebook in the repository has no outputs, and one cell of parameters."""
    cells = [cell for cell in read(name)["cells"] if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells)
    assert sum("parameters" in cell["metadata"].get("tags", []) for cell in cells) == 1


@pytest.mark.parametrize("name", SMALL)
def test_a_notebook_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A notebook runs from its first to its last cell at a small size."""
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    for module in ["matplotlib", "pandas", "pyvista", "meshio"]:
        pytest.importorskip(module)
    values, printed = SMALL[name]
    notebook = nbformat.read(NOTEBOOKS / name, as_version=4)
    for cell in notebook.cells:
        if "parameters" in cell.metadata.get("tags", []):
            here = {"DATA": str(NOTEBOOKS / "../../data"), "FOLDER": str(tmp_path / "results")}
            assignments = [f"{key} = {value!r}" for key, value in {**here, **values}.items()]
            cell.source += "\n" + "\n".join(assignments)
    monkeypatch.setenv("MPLBACKEND", "agg")
    client = nbclient.NotebookClient(
        notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    client.execute()
    texts = []
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            texts.append(output.get("text", "") + output.get("data", {}).get("text/plain", ""))
    assert printed in "".join(texts), texts


INTERRUPTED = """
import sys
sys.path.insert(0, {folder!r})
from conftest import keys
import powerhouse_fe as ph
history = keys()["output"]["history"]
scene = ph.Scene(keys(time={{"duration": 1000.0}}, output={{"every": 0.01, "history": history}}))
seen = []
def progress(stage, done, planned, at):
    if done > 0 and not seen:
        seen.append(done)
        print("stepping", flush=True)
try:
    scene.run({out!r}, progress)
except ph.Interrupted as error:
    print("ended:", error.results.ended, len(error.results.histories.times) > 1, all(f.exists() for f in error.results.files))
"""


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_the_interrupt_of_a_notebook(tmp_path: Path) -> None:
    """The interrupt of a kernel ends a run in order, with complete results and files, and the kernel goes on."""
    jupyter = pytest.importorskip("jupyter_client.manager")
    pytest.importorskip("ipykernel")
    manager, client = jupyter.start_new_kernel(kernel_name="python3", startup_timeout=120)
    printed = ""
    try:
        for code in [
            INTERRUPTED.format(folder=str(Path(__file__).parent), out=str(tmp_path / "out")),
            "print(1 + 1, 'goes on')",
        ]:
            client.execute(code)
            interrupted = False
            while True:
                message = client.get_iopub_msg(timeout=120)
                content = message["content"]
                printed += content.get("text", "") + "".join(content.get("traceback", []))
                if "stepping" in printed and not interrupted:
                    interrupted = True
                    if "goes on" not in code:
                        manager.interrupt_kernel()
                if message["msg_type"] == "status" and content["execution_state"] == "idle":
                    break
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)
    assert "ended: interrupted True True" in printed and "2 goes on" in printed, printed
