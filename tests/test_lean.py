"""A lean install: without the packages of the extras blends are made, proved, meshed and written, and what needs one of
these packages says which extra brings it."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib

import pytest
from conftest import ROOT

from pas.errors import OPTIONAL

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]
NAMED = {"numpy", "scipy", "sympy", "cvxpy", "pyvista", "pytetwild"}
"""What the documented install brings, whatever else it does."""

HIDDEN = "import sys; sys.modules |= dict.fromkeys({!r})\n"

PROGRAM = """
import pas
from pathlib import Path

pipes = [pas.Pipe(axis, "1/3", 1) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
blend = pas.blend(pipes, 1)
assert blend.certificate.proved and len(blend.mesh(0.05).triangles)
blend.solid("1/2").write("lean.stl", tolerance=0.05)
blend.write("lean.ply", tolerance=0.05)
assert pas.load(blend.save("lean.pas.json")).certificate.proved
print(Path("lean.stl").stat().st_size > 1000)
for needs in (blend.space.problem, blend.mesh(0.05).to_pyvista, lambda: blend.write("lean.vtp"),
              lambda: pas.solid.text("a", 1), lambda: blend.draw("lean.png")):
    try:
        needs()
    except pas.MissingLibraryError as error:
        print(error)
print(type(pas.table([blend])).__name__)
print(sorted(p.name for p in Path().iterdir()))
"""


def packages(names):
    return {re.match(r"[\w-]+", name)[0].lower() for name in names}


def all_packages(extra):
    """The packages of an extra, and of those it names."""
    found = set()
    for name in EXTRAS[extra]:
        inner = re.match(r"pas\[(.*)\]", name)
        found |= set().union(*(all_packages(e) for e in inner[1].split(","))) if inner else packages([name])
    return found


def test_the_documented_install_brings_everything():
    lean = packages(PROJECT["dependencies"])
    assert lean | all_packages("all") >= NAMED
    assert all_packages("develop") >= all_packages("all")
    others = set().union(*(all_packages(extra) for extra in EXTRAS if extra not in ("all", "test", "docs", "develop")))
    assert all_packages("all") - {"pandas"} == others
    assert not lean & all_packages("all")
    assert "'.[develop]'" in (ROOT / "Makefile").read_text(encoding="utf-8")
    assert "'.[all]'" in (ROOT / "docs/start/install.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", OPTIONAL)
def test_sentences_name_the_extra_that_brings_the_package(name):
    extra = re.search(r"pip install 'pas\[(\w+)\]'", OPTIONAL[name])[1]
    assert name in all_packages(extra) and name in OPTIONAL[name]


def test_a_lean_install_blends_proves_meshes_and_writes(tmp_path):
    lean = packages(PROJECT["dependencies"])
    hidden = all_packages("all") - lean | {"OCP", "vtk", "vtkmodules"}
    program = HIDDEN.format(sorted(hidden)) + PROGRAM
    run = [sys.executable, "-W", "error", "-c", program]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    first, *sentences, table, files = done.stdout.splitlines()
    assert (first, table) == ("True", "list")
    assert [re.search(r"pip install '(.*?)'|OpenGL", s)[0] for s in sentences][:4] == [
        "pip install 'pas[convex]'", "pip install 'pas[pictures]'", "pip install 'pas[pictures]'",
        "pip install 'pas[fonts]'",
    ]  # fmt: skip
    assert len(sentences) == 5 and ("pas[pictures]" in sentences[4] or "OpenGL" in sentences[4])
    assert files == "['lean.pas.json', 'lean.ply', 'lean.stl']"
