"""The same answers on every machine: the corner files under other kernels of the linear algebra library.

Kernels differ in the last digits of every product.  Degrees, dimensions and verdicts must be the same, and the
surfaces within 1e-3 of their size (optima of quadratic forms, which the published files ask for, within 1e-6).

Values by Horner's rule are the doubles that it gives when it is done as it is written down.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

from pas.algebra.evaluation import horner
from pas.algebra.monomials import count, positions

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


@pytest.mark.parametrize("names", [("Haswell", "Prescott"), tuple(THREADS)], ids=["two", "all"])
@pytest.mark.sampled(2)
def test_least_squares_have_the_same_digits_under_other_kernels(names):
    first, *others = under_all(FITTED, threads={name: THREADS[name] for name in names})
    assert "x^4" in first["handle"]
    assert all(other == first for other in others)


@pytest.mark.parametrize(
    ("names", "threads"),
    [
        pytest.param(FEW, THREADS, id="few"),
        pytest.param(ALL, THREADS | {"Prescott": 2}, id="all"),
    ],
)
@pytest.mark.slow
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


def by_the_rule(coefficients, degree, x, y, z):
    """Horner's rule over z inside y inside x, in numbers of any kind."""
    where, value = positions(degree), 0 * x
    for a in range(degree, -1, -1):
        in_y = 0 * x
        for b in range(degree - a, -1, -1):
            in_z = 0 * x
            for c in range(degree - a - b, -1, -1):
                in_z = in_z * z + coefficients[where[a, b, c]]
            in_y = in_y * y + in_z
        value = value * x + in_y
    return value


@pytest.mark.parametrize("degree", range(13))
@pytest.mark.parametrize("number", [1, 63, 64, 200])
def test_values_are_those_of_horners_rule_and_exact_to_rounding(degree, number):
    rng = np.random.default_rng(degree)
    table, points = rng.normal(size=(3, count(degree))), rng.uniform(-2, 2, (3, number))
    for row, values in zip(table.tolist(), horner(table, degree, points), strict=True):
        assert np.array_equal(values, by_the_rule(row, degree, *points))
        coefficients = [Fraction(c) for c in row]
        for place in range(0, number, 50):
            point = [Fraction(v) for v in points[:, place].tolist()]
            size = by_the_rule([abs(c) for c in coefficients], degree, *map(abs, point))
            error = abs(Fraction(values[place]) - by_the_rule(coefficients, degree, *point))
            assert error <= 2 * (degree + 3) * size / 2**53
