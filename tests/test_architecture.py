"""The house: rooms in order, imports one way, fast to enter, every public name documented."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

import pas

ROOMS = [
    *("_version", "errors", "limits", "registry", "described", "algebra", "bernstein", "partition", "mesh"),
    *("surface", "solid", "parametric", "generatrix", "fairing", "blending", "pipeline"),
    *("exchange", "independent", "render", "teapot", "cli"),
]
"""A module imports from rooms that stand before its own, and from its own."""

PACKAGE = ROOT / "pas"
MODULES = sorted(
    p for p in PACKAGE.rglob("*.py") if p.name not in ("__init__.py", "__main__.py") or p.parent != PACKAGE
)


def room(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported(path: Path) -> set[str]:
    """Rooms of `pas` that a module imports, lazily or not."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "pas":
            names.add(node.module.split(".")[1] if "." in node.module else "")
        if isinstance(node, ast.Import):
            names |= {a.name.split(".")[1] for a in node.names if a.name.startswith("pas.")}
    return names


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_go_one_way(path):
    assert room(path) in ROOMS
    for other in imported(path):
        assert other in ROOMS, f"{path} imports from {other or 'the package itself'}"
        assert ROOMS.index(other) <= ROOMS.index(room(path)), f"{path} imports upwards from {other}"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_modules_are_documented_and_short(path):
    text = path.read_text(encoding="utf-8")
    assert ast.get_docstring(ast.parse(text))
    assert len(text.splitlines()) <= 350
    calls = [n.func.id for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)]
    assert "print" not in calls or room(path) == "cli"


@pytest.mark.parametrize("name", [n for n in pas.__all__ if n != "__version__"])
def test_public_names_are_documented(name):
    thing = getattr(pas, name)
    assert inspect.getdoc(thing)
    if inspect.isclass(thing):
        for attribute, value in vars(thing).items():
            if not attribute.startswith("_") and (callable(value) or isinstance(value, property)):
                assert inspect.getdoc(value), f"{name}.{attribute}"


def test_lazy_names_are_those_that_are_declared():
    tree = ast.parse((PACKAGE / "__init__.py").read_text())
    block = next(n for n in tree.body if isinstance(n, ast.If))
    declared = {a.asname for n in block.body if isinstance(n, ast.ImportFrom) for a in n.names}
    assert declared | {"__version__"} == set(pas.__all__)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = pas.nothing
    assert "blend" in dir(pas)


def test_import_is_light():
    heavy = ["numpy", "scipy", "sympy", "flint", "cvxpy", "daqp", "pyvista", "vtk", "trimesh", "pytetwild", "lib3mf"]
    code = f"import sys, pas; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_solving_needs_no_pictures_nor_sympy():
    code = (
        "import sys, pas; pipes = [pas.Pipe(a, '1/3', 1) for a in ((1,0,0),(0,1,0),(0,0,1))];"
        "pas.blend(pipes, 1).surface.mesh(.1);"
        "print([m for m in ('sympy', 'cvxpy', 'pyvista', 'vtk', 'trimesh') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
