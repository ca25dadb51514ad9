"""The same answers on every machine: the corner files under other kernels of the linear algebra library.

Kernels differ in the last digits of every product.  Degrees, dimensions and verdicts must be the same, and the
surfaces within 1e-3 of their size (optima of quadratic forms, which the published files ask for, within 1e-6).
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

THREADS = {"Haswell": 1, "Zen": 2, "SkylakeX": 1, "Prescott": 1}
"""The kernels, and the threads of each: two take several times the work of one where other programs have the processor.
"""

CORNERS = ROOT / "examples/corners"
ALL = tuple(sorted(file.stem for file in CORNERS.glob("*.toml")))
FEW = ("elbow_gc2", "equal_gc3", "published_a", "published_b", "published_c", "published_proved", "unequal_gc2")
"""Of two neighbours and three, of each order above 1, of the most unknowns and of quadratic forms."""

CLOSE, EXACT = 1e-3, 1e-6

SOLVED = """
import json, runpy, sys
from pathlib import Path
solve = runpy.run_path(sys.argv[1] + "/corners.py")["solve"]
found = {}
for name in sys.argv[2:]:
    blend = solve(Path(sys.argv[1]) / f"{name}.toml")
    surface = blend.surface
    found[name] = {
        "same": [surface.degree, blend.dimension, [v.status.value for v in blend.certificate.verdicts]],
        "size": [c for p in surface.patches for c in p.dense(surface.degree).tolist()],
        "energy": blend.energy,
    }
print(json.dumps(found))
"""


FITTED = """
import json
from pas.designs import Body, PaperHandle
print(json.dumps({"handle": str(PaperHandle().quartic(Body()))}))
"""
"""A member of least squares in an ill-conditioned basis, rounded to nine digits: it has the same ones everywhere."""


def answers(kernel: str, number: int, script: str, names: Sequence[str]) -> dict[str, Any] | None:
    """What a script prints under a kernel with so many threads; None where this processor cannot run it."""
    threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"), str(number))
    done = subprocess.run(
        [sys.executable, "-c", script, str(CORNERS), *names],
        env=os.environ | threads | {"OPENBLAS_CORETYPE": kernel, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode == -signal.SIGILL:
        return None
    assert done.returncode == 0, done.stderr[-2000:]
    return dict(json.loads(done.stdout))


def under_all(script: str, names: Sequence[str] = (), threads: Mapping[str, int] = THREADS) -> list[dict[str, Any]]:
    """What a script prints under each kernel that this processor can run; skips the test where that is one."""
    tried = [answers(kernel, number, script, names) for kernel, number in threads.items()]
    found = [result for result in tried if result is not None]
    if len(found) < 2:
        pytest.skip("this processor runs one of the kernels only")
    return found


def test_least_squares_have_the_same_digits_under_four_kernels():
    first, *others = under_all(FITTED)
    assert "x^4" in first["handle"]
    assert all(other == first for other in others)


@pytest.mark.parametrize(
    ("names", "threads"),
    [
        pytest.param(FEW, THREADS, id="few"),
        pytest.param(ALL, THREADS | {"Prescott": 2}, id="all", marks=pytest.mark.slow),
    ],
)
def test_the_corner_files_come_to_the_same_under_four_kernels(names, threads):
    first, *others = under_all(SOLVED, names, threads)
    assert tuple(first) == names
    for other in others:
        for name, result in first.items():
            close = EXACT if name.startswith("published") else CLOSE
            assert other[name]["same"] == result["same"], name
            assert other[name]["energy"] == pytest.approx(result["energy"], rel=close), name
            patches, reference = np.array(other[name]["size"]), np.array(result["size"])
            assert np.abs(patches - reference).max() <= close * np.abs(reference).max(), name
