"""Values of polynomials and of surfaces of several pieces, and rays."""

from __future__ import annotations

import numpy as np

from pas.bench.case import Case, Suite, Work
from pas.surface.evaluator import Evaluator

POINTS, RAYS = 1_000_000, 10_000

QUINTIC = "x^5 + 2*x^2*y^3 - z^5 + x*y*z^3 - 3*x^2*y*z + y^4 - z^2*x + x - 2*y + 1"


def _points(number: int = POINTS) -> np.ndarray:
    return np.random.default_rng(0).uniform(-0.5, 0.5, (number, 3))


def _values() -> Work:
    from pas.algebra.polynomial import Polynomial

    polynomial, points = Polynomial(QUINTIC), _points()
    return lambda: polynomial(points)


def _numpy_values() -> Work:
    from numpy.polynomial.polynomial import polyval3d

    from pas.algebra.polynomial import Polynomial

    table = np.zeros((6, 6, 6))
    for exponents, value in Polynomial(QUINTIC).raw.to_dict().items():
        table[exponents] = float(value.p) / float(value.q)
    x, y, z = _points().T
    return lambda: polyval3d(x, y, z, table)


def _sympy_values() -> Work:
    from sympy import lambdify, symbols, sympify

    function = lambdify(symbols("x y z"), sympify(QUINTIC.replace("^", "**")), "numpy", cse=True)
    x, y, z = _points().T
    return lambda: function(x, y, z)


def _surface() -> Work:
    evaluator, points = _evaluator(), _points()
    return lambda: evaluator.values(points)


def _rays() -> Work:
    evaluator = _evaluator()
    directions = np.random.default_rng(1).normal(size=(RAYS, 3))
    origins = np.zeros_like(directions)
    return lambda: evaluator.rays(origins, directions)


def _evaluator() -> Evaluator:
    from pas.contacts.pipe import Pipe
    from pas.pipeline.blend import blend

    axes = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    return Evaluator(blend([Pipe(axis, "1/3", 1) for axis in axes], 2, 5).surface)


def cases() -> list[Case]:
    """Those of this suite."""
    return [
        Case(f"{POINTS:,} values of a quintic", _values, {"numpy": _numpy_values, "sympy": _sympy_values}),
        Case(f"{POINTS:,} values of a GC^2 corner, cells found", _surface),
        Case(f"all crossings of {RAYS:,} rays with it", _rays),
    ]


EVALUATION = Suite("eval", "values and rays", cases)
