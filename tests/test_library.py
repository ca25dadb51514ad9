"""The compiled library: made when the package is installed, shipped in a wheel for any Python, and missed in words."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import zipfile
from shutil import copytree, ignore_patterns, which

import pytest
from conftest import ROOT

import pas
from pas.kernels import library as library_module
from pas.kernels.library import Functions, library

HIDDEN = ignore_patterns(".*", "__pycache__", "*.so", "*.egg-info", "tests", "examples", "out", "build")


def test_the_library_stands_beside_its_sources_and_no_cache_is_kept():
    assert library()._name == str(ROOT / "pas" / "kernels" / "_library.so")
    sources = "".join(path.read_text() for path in (ROOT / "pas").rglob("*.py"))
    assert not re.search(r"XDG_CACHE|\.cache\b.*pas|\[.cc.,", sources)


def test_a_library_that_is_missing_or_of_another_version_is_told(monkeypatch, tmp_path):
    with pytest.raises(pas.errors.MissingLibraryError, match="the compiled library of pas cannot be used"):
        Functions().call("pas_of_another_version")
    monkeypatch.setattr(library_module, "PLACE", tmp_path / "_library.so")
    with pytest.raises(pas.errors.MissingLibraryError, match="installing the package anew makes it"):
        library.__wrapped__()


def test_headers_that_are_included_are_there():
    folder = ROOT / "pas" / "kernels"
    for source in folder.glob("*.[ch]"):
        for name in re.findall(r'#include "(.*)"', source.read_text()):
            assert (folder / name).exists()


def test_no_two_sources_define_one_name():
    """They are one library."""
    found = [
        name
        for source in sorted((ROOT / "pas" / "kernels").glob("*.c"))
        for name in re.findall(r"^\w[\w ]*?\b(pas_\w+)\([^;]*?\)\n?\{", source.read_text(), re.M | re.S)
    ]
    assert len(found) == len(set(found)) > 40


@pytest.mark.slow
def test_a_wheel_serves_any_python_of_its_platform(tmp_path):
    """Built from a copy without the library, and installed where nothing else of the package is."""
    tree = tmp_path / "tree"
    copytree(ROOT, tree, ignore=HIDDEN)
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", str(tmp_path), str(tree)]
    subprocess.run(build, check=True)
    (wheel,) = tmp_path.glob("*.whl")
    assert "-py3-none-" in wheel.name
    names = zipfile.ZipFile(wheel).namelist()
    assert "pas/kernels/_library.so" in names and not any(name.endswith((".c", ".h")) for name in names)
    zipfile.ZipFile(wheel).extractall(tmp_path / "installed")
    script = "import pas; print(pas.__file__, pas.Evaluator('x^2 - 1').rays([[-2, 0, 0]], [[1, 0, 0]]).counts)"
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "installed")}
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.startswith(str(tmp_path)) and done.stdout.strip().endswith("[2]")


def test_without_a_compiler_the_build_asks_for_one(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    import build_backend

    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(build_backend.build_meta, "get_requires_for_build_wheel", lambda settings: [])
    monkeypatch.setattr(build_backend.build_meta, "get_requires_for_build_editable", lambda settings: [])
    hooks = build_backend.get_requires_for_build_wheel, build_backend.get_requires_for_build_editable
    assert build_backend.found() is None and [hook() for hook in hooks] == [[build_backend.WHEEL]] * 2
    monkeypatch.undo()
    assert (build_backend.found() is None) == (not any(map(which, build_backend.COMPILERS)))
