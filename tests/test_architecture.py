"""The package: layers in order, imports one way, fast to enter, every public name documented."""

from __future__ import annotations

import ast
import inspect
import runpy
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from conftest import ROOT, nodes, parsed

import pas
from pas.shape import KINDS

LAYERS = [
    *("_version", "errors", "limits", "elsewhere", "registry", "verdicts", "arrays", "kernels"),
    *("algebra", "settings", "shape", "bernstein", "partition", "mesh", "contacts", "surface", "certify", "piecewise"),
    *("solid", "parametric", "fairing"),
    *("layouts", "blending", "pipeline", "exchange", "independent", "render", "designs", "network", "kinds"),
    *("studio", "cli"),
]
"""A module imports from layers that stand before its own, and from its own."""

PACKAGE = ROOT / "pas"
MODULES = sorted(
    p for p in PACKAGE.rglob("*.py") if p.name not in ("__init__.py", "__main__.py") or p.parent != PACKAGE
)


def layer(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported(path: Path) -> set[str]:
    """Rooms of `pas` that a module imports, lazily or not."""
    names = set()
    for node in nodes(path):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "pas":
            names.add(node.module.split(".")[1] if "." in node.module else "")
        if isinstance(node, ast.Import):
            names |= {a.name.split(".")[1] for a in node.names if a.name.startswith("pas.")}
    return names


def test_imports_go_one_way():
    wrong = []
    for path in MODULES:
        assert layer(path) in LAYERS, f"{path} is in no layer"
        strangers = imported(path) - set(LAYERS)
        wrong += [f"{path} imports from {other or 'the package itself'}" for other in strangers]
        known = imported(path) - strangers
        wrong += [f"{path} imports upwards from {r}" for r in known if LAYERS.index(r) > LAYERS.index(layer(path))]
    assert not wrong, "\n".join(wrong)


def test_modules_are_documented_and_short():
    wrong = []
    for path in MODULES:
        text, tree = path.read_text(encoding="utf-8"), parsed(path)
        called = {n.func.id for n in nodes(path) if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)}
        wrong += [f"{path} has no docstring"] * (not ast.get_docstring(tree))
        wrong += [f"{path} has more than 350 lines"] * (len(text.splitlines()) > 350)
        wrong += [f"{path} prints"] * ("print" in called and layer(path) != "cli")
    assert not wrong, "\n".join(wrong)


def test_public_names_are_documented():
    things = {name: getattr(pas, name) for name in pas.__all__ if name != "__version__"}
    things |= {
        f"{name}.{attribute}": value
        for name, thing in things.items()
        if inspect.isclass(thing)
        for attribute, value in vars(thing).items()
        if not attribute.startswith("_") and (callable(value) or isinstance(value, property))
    }
    assert len(things) > 300 and not [name for name, thing in things.items() if not inspect.getdoc(thing)]


BY_CLASS = {
    ("solid/solid.py", "Solid"): "operators give NotImplemented for what is no solid, so that Python says so",
    ("mesh/mesh.py", "Mesh"): "the same for those of meshes",
    ("solid/assembly.py", "Solid"): "a part is a solid or a mesh, and only solids have joints and contain points",
    ("solid/assembly.py", "Mesh"): "what a part may be is checked where an assembly is made",
    ("render/scene.py", "Mesh"): "an argument is checked",
    ("partition/layout.py", "Layout"): "equality gives False for what is no layout",
    ("layouts/clips.py", "Layout"): "an argument may be a layout or the name of a kind of them",
    ("blending/place.py", "Layout"): "an argument may be a partition, a layout or the name of a kind of them",
    ("parametric/data.py", "ParametricSurface"): "an argument is checked",
    ("parametric/surface.py", "ParametricSurface"): "an argument is checked",
    ("parametric/fitting.py", "ParametricSurface"): "an argument is checked, which may be a blend with a surface",
}
"""Where a class of a kind of shapes may be asked for outside the kinds' own files, and why."""


def classes_asked_for(path: Path) -> set[str]:
    """The names of classes in isinstance, issubclass, match cases, and in dispatch by a function's annotations."""
    found: set[str] = set()
    for node in nodes(path):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("isinstance", "issubclass"):
            found |= {n.id for n in ast.walk(node.args[1]) if isinstance(n, ast.Name)}
        elif isinstance(node, ast.MatchClass):
            found |= {n.id for n in ast.walk(node.cls) if isinstance(n, ast.Name)}
        elif isinstance(node, ast.FunctionDef) and any("register" in ast.unparse(d) for d in node.decorator_list):
            parts = [*node.decorator_list, *(a.annotation for a in node.args.args[:1] if a.annotation)]
            found |= {n.id for part in parts for n in ast.walk(part) if isinstance(n, ast.Name)}
    return found


def test_kinds_of_shapes_are_told_apart_by_their_registry_alone():
    known = {kind.type.__name__ for kind in KINDS.values()}
    asked = {
        (str(path.relative_to(PACKAGE)), name)
        for path in MODULES
        if layer(path) not in ("kinds", "shape")
        for name in classes_asked_for(path) & known
    }
    assert asked == set(BY_CLASS), sorted(asked ^ set(BY_CLASS))


def test_public_names_stand_in_the_stub_once_and_are_loaded_from_there():
    homes = [n for n in ast.parse((PACKAGE / "__init__.pyi").read_text()).body if isinstance(n, ast.ImportFrom)]
    names = [alias.name for node in homes for alias in node.names]
    assert sorted(names) == sorted(pas.__all__) == sorted(dir(pas))
    assert len(set(names)) == len(names)
    for node in homes:
        for alias in node.names:
            home = import_module(f"pas.{node.module}" if node.module else "pas")
            assert getattr(pas, alias.name) is getattr(home, alias.name)
            assert alias.asname == alias.name, f"mypy hides {alias.name} unless it is imported as {alias.name}"
    with pytest.raises(AttributeError, match="pas has no 'nothing'"):
        _ = pas.nothing


def test_import_is_light():
    heavy = ["numpy", "scipy", "sympy", "flint", "cvxpy", "daqp", "pyvista", "vtk", "trimesh", "pytetwild", "lib3mf"]
    code = f"import sys, pas; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_solving_needs_no_pictures_nor_sympy():
    code = (
        "import sys, pas; pipes = [pas.Pipe(a, '1/3', 1) for a in ((1,0,0),(0,1,0))];"
        "pas.blend(pipes, 1).surface.mesh(.1);"
        "print([m for m in ('sympy', 'cvxpy', 'pyvista', 'vtk', 'trimesh') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_picture_of_the_layers_is_drawn_from_the_sources():
    layers = runpy.run_path(str(ROOT / "docs/layers.py"))
    drawn = layers["picture"]()
    for name in set(LAYERS) - {"_version"}:
        assert f">{name}</text>" in drawn
    assert set(layers["order"](["a", "b"], {("a", "b"): 1})) == {"a", "b"}
    with pytest.raises(ValueError, match="a, b import from one another"):
        layers["order"](["a", "b"], {("a", "b"): 1, ("b", "a"): 1})
