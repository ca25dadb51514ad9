"""fTetWild in a process and a folder of its own: it crashes on some meshes (of parts thinner than its envelope,
say), and writes `__tracked_surface.stl` into the folder that it works in.

Guaranteed: a crash is a `GeometryError`, and nothing is printed or left behind.  Not guaranteed: anything about the
tetrahedra; `pas.exchange.volume` checks them.  Run as a script, this file is the other process: it
imports nothing of `pas`.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

SAID = "said.txt"
"""The file that takes what the other process writes as errors."""


def require_library() -> None:
    """Raise `MissingLibraryError` without pytetwild."""
    from pas.errors import library

    library(
        "pytetwild",
        "tetrahedra need pytetwild: pip install pytetwild (on a Mac there are ready packages for macOS 15 on Apple "
        "silicon; elsewhere it is built, with a compiler and CMake)",
    )


def tetrahedralize(points: Any, triangles: Any, options: Mapping[str, Any]) -> tuple[Any, Any]:
    """Points (N, 3) and tetrahedra (M, 4), of any orientation, in a closed mesh of about unit size.

    `options` are those of `pytetwild.tetrahedralize`.  Raises `GeometryError`, and `MissingLibraryError`
    without pytetwild.
    """
    from pas.errors import GeometryError

    require_library()
    with tempfile.TemporaryDirectory(prefix="pas-") as name:
        folder = Path(name)
        np.save(folder / "points.npy", np.ascontiguousarray(points, dtype=np.float64))
        np.save(folder / "triangles.npy", np.ascontiguousarray(triangles, dtype=np.int32))
        code = _run(folder, json.dumps(dict(options)))
        if code < 0:
            raise GeometryError(
                f"fTetWild crashed ({signal.Signals(-code).name}): the part is thinner than the tolerance, "
                "or its mesh cuts itself; set a smaller tolerance"
            )
        if code:
            lines = (folder / SAID).read_text("utf-8", "replace").strip().splitlines() or ["no reason given"]
            raise GeometryError(f"fTetWild failed: {lines[-1]}")
        return np.load(folder / "found.npy"), np.load(folder / "tetrahedra.npy")


def _run(folder: Path, options: str) -> int:
    """Run the other process to its end, or until a limit is reached; returns its exit status."""
    from pas.limits import checkpoint

    with (
        open(folder / SAID, "wb") as said,
        subprocess.Popen(
            [sys.executable, "-P", str(Path(__file__).resolve()), str(folder), options],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(str(Path(p).resolve()) for p in sys.path)},
            stdout=subprocess.DEVNULL,
            stderr=said,
        ) as process,
    ):
        try:
            while process.poll() is None:
                checkpoint("fTetWild makes tetrahedra")
                with suppress(subprocess.TimeoutExpired):
                    process.wait(0.2)
        except BaseException:
            process.kill()
            raise
    return process.returncode


def _work(folder: Path, options: dict[str, Any]) -> None:
    from pytetwild import tetrahedralize as work  # type: ignore[attr-defined]

    found, tetrahedra = work(np.load(folder / "points.npy"), np.load(folder / "triangles.npy"), **options)
    np.save(folder / "found.npy", found)
    np.save(folder / "tetrahedra.npy", tetrahedra)


if __name__ == "__main__":
    _work(Path(sys.argv[1]), json.loads(sys.argv[2]))
