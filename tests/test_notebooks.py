"""Notebooks run from top to bottom in a fresh kernel, and hold no outputs."""

from __future__ import annotations

import re

import nbformat
import pytest
from conftest import ROOT
from nbclient import NotebookClient

NOTEBOOKS = sorted((ROOT / "examples/notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebooks_are_stored_without_outputs(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            assert not cell.outputs
            assert cell.execution_count is None


def executed(name, folder, monkeypatch):
    """The outputs of a notebook that runs in a folder, and what it prints."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT), prepend=":")
    notebook = nbformat.read(ROOT / f"examples/notebooks/{name}.ipynb", as_version=4)
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": folder}}).execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    return outputs, "".join(output.get("text", "") for output in outputs)


@pytest.mark.slow
def test_a_lattice(tmp_path, monkeypatch):
    outputs, text = executed("lattice", tmp_path, monkeypatch)
    assert "35 points, 64 struts" in text
    assert text.count("nothing else meets: proved") == 2
    assert re.search(r"^genus 30, density 0\.\d{3}$", text, re.MULTILINE)
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 3
    files = {"block.png", "ball.png", "fork.png", "block.3mf", "block.glb", "ball.stl"}
    assert {p.name for p in tmp_path.iterdir()} == files


@pytest.mark.slow
def test_the_first_blend(tmp_path, monkeypatch):
    outputs, text = executed("first_blend", tmp_path, monkeypatch)
    assert re.search(r"^order +GC\^2 at the contacts", text, re.MULTILINE)  # columns are as wide as they need be
    energies = re.search(r"^energy (\S+) and (\S+); proved: True$", text, re.MULTILINE)
    assert energies and [float(e) for e in energies.groups()] == pytest.approx([45.74, 46.02], rel=3e-3)
    volume = re.search(r"^volume (\S+)$", text, re.MULTILINE)
    assert volume and float(volume[1]) == pytest.approx(1.516, abs=2e-3)  # of a mesh to 1e-2
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 2
    assert sum("text/latex" in output.get("data", {}) for output in outputs) == 1
    assert {p.name for p in tmp_path.iterdir()} == {
        "corner.pas.json",
        "corner.stl",
        "corner_plain.png",
        "corner_zebra.png",
    }
