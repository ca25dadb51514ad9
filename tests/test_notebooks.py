"""Notebooks run from top to bottom in a fresh kernel: those of examples, which hold no outputs, and the tutorials."""

from __future__ import annotations

import base64
import re
import sys

import nbformat
import pytest
from conftest import ROOT
from nbclient import NotebookClient
from test_snippets import told

sys.path.insert(0, str(ROOT / "docs"))

import notebooks  # the module beside the pages

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
    assert energies and [float(e) for e in energies.groups()] == pytest.approx([46.75, 47.11], rel=3e-3)
    volume = re.search(r"^volume (\S+)$", text, re.MULTILINE)
    assert volume and float(volume[1]) == pytest.approx(1.5135, abs=1e-3)  # of a mesh to 1e-2
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 2
    assert sum("text/latex" in output.get("data", {}) for output in outputs) == 1
    assert {p.name for p in tmp_path.iterdir()} == {
        "corner.pas.json",
        "corner.stl",
        "corner_plain.png",
        "corner_zebra.png",
    }


def pages(quick):
    """The tutorials as cases, of which all but some are slow."""
    return [pytest.param(p, id=p.stem, marks=[pytest.mark.slow] * (p.stem not in quick)) for p in notebooks.TUTORIALS]


@pytest.mark.parametrize("page", pages(["energy"]))
def test_a_tutorial_prints_in_a_notebook_what_its_page_says(page):
    done = notebooks.executed(notebooks.notebook(page))
    nbformat.validate(done)
    outputs = [output for cell in done.cells if cell.cell_type == "code" for output in cell.outputs]
    printed = iter("".join(output.get("text", "") for output in outputs).splitlines())
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    for line in (line for block in blocks for line in told(block)):
        assert line in printed  # in this order: what is before it is used up
    pictures = [output for output in outputs if "image/png" in output.get("data", {})]
    assert len(pictures) >= sum(".draw(" in block or ".picture(" in block for block in blocks)


def test_all_tutorials_are_notebooks_and_made_again_only_if_they_change(tmp_path, monkeypatch):
    listed = re.findall(r"^tutorials/(\w+)$", (ROOT / "docs/index.md").read_text(encoding="utf-8"), re.M)
    assert sorted(listed) == [page.stem for page in notebooks.TUTORIALS] and len(listed) == 7
    ran = []
    monkeypatch.setattr(notebooks, "executed", lambda made: ran.append(made) or made)
    notebooks.write(tmp_path)
    notebooks.write(tmp_path)
    assert len(ran) == 7
    for made in ran:
        nbformat.validate(made)
        cells = [cell for cell in made.cells if cell.cell_type == "markdown"]
        shown = [name for cell in cells for name in re.findall(r"\]\(attachment:([^)]+)\)", cell.source)]
        kept = {name: data for cell in cells for name, data in cell.get("attachments", {}).items()}
        assert sorted(shown) == sorted(kept)
        assert all(base64.b64decode(data["image/png"]).startswith(b"\x89PNG") for data in kept.values())
        assert not any(re.search(r"\]\((?!attachment:|http)", cell.source) or "```" in cell.source for cell in cells)
    text = (ROOT / "docs/tutorials/energy.md").read_text(encoding="utf-8")
    page = tmp_path / "energy.md"
    page.write_text(text.replace("../../", f"{ROOT}/") + "more\n", encoding="utf-8")
    notebooks.write(tmp_path, [page])
    assert len(ran) == 8
