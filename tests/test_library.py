"""The compiled library: declared by its header, shipped in a wheel for any Python, watched, and missed in words."""

from __future__ import annotations

import ctypes
import os
import platform
import re
import subprocess
import sys
import sysconfig
import venv
import zipfile
from importlib.util import find_spec
from pathlib import Path
from shutil import copytree, ignore_patterns, which

import numpy as np
import pytest
from conftest import ROOT

import pas
from pas.kernels import library as library_module
from pas.kernels.library import Array, Functions, declared, library, signatures

KERNELS = ROOT / "pas" / "kernels"
HIDDEN = ignore_patterns(".*", "__pycache__", "*.so", "*.egg-info", "tests", "examples", "out", "build")


def test_the_library_stands_beside_its_sources_and_no_cache_is_kept():
    assert library()._name == str(ROOT / "pas" / "kernels" / "_library.so")
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "pas").rglob("*.py"))
    assert not re.search(r"XDG_CACHE|\.cache\b.*pas|\[.cc.,", sources)


def test_a_library_that_is_missing_or_of_another_version_is_told(monkeypatch, tmp_path):
    with pytest.raises(pas.errors.MissingLibraryError, match=r"cannot be used \(_library.so has no pas_of"):
        Functions().call("pas_of_another_version")
    monkeypatch.setattr(library_module, "PLACE", tmp_path / "_library.so")
    with pytest.raises(pas.errors.MissingLibraryError, match="installing the package anew makes it"):
        library.__wrapped__()


def test_headers_that_are_included_are_there():
    for source in KERNELS.glob("*.[ch]"):
        for name in re.findall(r'#include "(.*)"', source.read_text()):
            assert (KERNELS / name).exists()


def test_the_header_has_the_functions_of_the_sources():
    """Each is defined in one source, which includes the header, so that the compiler has compared both."""
    found = [
        name
        for source in sorted(KERNELS.glob("*.c"))
        for name in re.findall(r"^\w[\w ]*?\b(pas_\w+)\([^;{]*?\)\s*\{", source.read_text(), re.M | re.S)
    ]
    assert len(found) == len(set(found)) > 30
    assert set(found) == set(signatures())
    for source in KERNELS.glob("*.c"):
        assert re.search(r'#include "(pas|kernel|field|halfedge)\.h"', source.read_text()), source.name


def test_arguments_are_declared_as_in_the_header():
    run = declared("pas_leaving")
    assert run.restype is ctypes.c_int
    number, array = ctypes.c_ssize_t, ctypes.c_void_p
    assert run.argtypes == (number, array, array, number, array, number, number, array, array)
    structure = signatures()["pas_mesh_bends"]
    assert structure.arguments == (ctypes.c_void_p,) and structure.arrays == (None,)
    assert declared("pas_fans").argtypes[:2] == (ctypes.c_ssize_t, ctypes.c_void_p)
    code = np.dtype(np.intp).char
    assert signatures()["pas_fans"].arrays == (None, Array(code, False), None, Array(code, False), Array(code, True))


def test_arrays_of_another_type_are_copied_or_refused():
    call, triangles = Functions().call, np.array([[0, 1, 2], [2, 1, 3]])
    found = []
    for given in (triangles, triangles.astype(np.int32), np.asfortranarray(triangles)):
        result = np.empty(6, dtype=np.intp)
        call("pas_twins", 2, given, 4, result)
        found.append(result.tolist())
    assert found == [[-1, 3, -1, 1, -1, -1]] * 3
    with pytest.raises(TypeError, match="pas_twins takes int64, not float64"):
        call("pas_twins", 2, triangles.astype(float), 4, result)
    with pytest.raises(TypeError, match="pas_twins writes to contiguous arrays of int64, not float32"):
        call("pas_twins", 2, triangles, 4, np.empty(6, dtype=np.float32))
    with pytest.raises(TypeError, match="pas_twins takes 4 arguments, not 3"):
        call("pas_twins", 2, triangles, 4)


def wheel_of_the_machine(folder):
    """Built from a copy without the library."""
    tree = folder / "tree"
    copytree(ROOT, tree, ignore=HIDDEN)
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", str(folder), str(tree)]
    subprocess.run(build, check=True)


def wheel_by_zig(folder):
    """Built as for other machines."""
    if find_spec("ziglang") is None or platform.machine() != "x86_64" or sys.platform != "linux":
        pytest.skip(
            "ziglang is not installed (make wheels does that), or this is another machine than it builds for here"
        )
    script = [sys.executable, str(ROOT / "build_wheels.py"), "-o", str(folder), "manylinux_2_17_x86_64"]
    subprocess.run(script, check=True)


@pytest.mark.slow
@pytest.mark.parametrize("build", [wheel_of_the_machine, wheel_by_zig])
def test_a_wheel_serves_any_python_of_its_platform(build, tmp_path):
    """Installed into an environment with what it depends on, but nothing else of the package, it blends."""
    build(tmp_path)
    (wheel,) = tmp_path.glob("*.whl")
    assert "-py3-none-" in wheel.name
    names = [name for name in zipfile.ZipFile(wheel).namelist() if name.startswith("pas/kernels/")]
    assert {"pas/kernels/_library.so", "pas/kernels/pas.h"} <= set(names)
    assert not any(name.endswith((".c", ".h")) for name in names if name != "pas/kernels/pas.h")
    home = tmp_path / "environment"
    venv.create(home, with_pip=False)
    python = home / "bin" / "python"
    place = Path(sysconfig.get_path("purelib", vars={"base": str(home), "platbase": str(home)}))
    install = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--no-deps", str(wheel)]
    subprocess.run(install, check=True)
    (place / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    script = (
        "import pas; pipes = [pas.Pipe((1, 0, 0), '1/3', 1), pas.Pipe((0, 1, 0), '1/3', 1)]; "
        "blend = pas.blend(pipes, 1); print(pas.__file__, blend.mesh(1e-2).is_manifold, blend.certificate.proved)"
    )
    done = subprocess.run([python, "-I", "-c", script], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(place / "pas" / "__init__.py"), "True", "True"]


SANITIZED = ("-O1", "-g", "-fPIC", "-shared", "-ffp-contract=off", "-fsanitize=address,undefined")


@pytest.mark.slow
def test_sanitizers_find_nothing_in_the_compiled_code(tmp_path):
    """Some tests of the compiled code with addresses and undefined behaviour watched."""
    compiler = which("gcc") or which("cc")
    given = [compiler, "-print-file-name=libasan.so"]
    watcher = (
        Path(subprocess.run(given, capture_output=True, text=True, check=False).stdout.strip()) if compiler else None
    )
    if watcher is None or not watcher.is_absolute():
        pytest.skip("the machine's compiler has no sanitizer of addresses")
    made = tmp_path / "library.so"
    sources = sorted(map(str, KERNELS.glob("*.c")))
    subprocess.run([compiler, *SANITIZED, "-fno-sanitize-recover=all", "-o", made, *sources, "-lm"], check=True)
    script = (
        "import sys; from pathlib import Path; from pas.kernels import library; import pytest; "
        "library.PLACE = Path(sys.argv[1]); sys.exit(pytest.main(sys.argv[2:]))"
    )
    tests = [str(ROOT / "tests" / f"test_{name}.py") for name in ("compiled_parts", "mesh_kernels", "mesh_certificate")]
    options = ["-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", "-k", "not machine and not generated"]
    watched = {"LD_PRELOAD": str(watcher), "ASAN_OPTIONS": "detect_leaks=0", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", script, made, *options, *tests]
    done = subprocess.run(command, cwd=ROOT, env=os.environ | watched, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and " passed" in done.stdout, done.stdout[-3000:] + done.stderr[-5000:]


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
