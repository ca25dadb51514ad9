"""Parametric blends: exact ones beside sympy, their values, and sliders of generatrix blends with their meshes."""

from __future__ import annotations

from collections.abc import Callable
from itertools import cycle
from typing import Any

import numpy as np
from measured import Prepare, Work, measured

import pas

CYLINDERS = (
    ("(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)", "h - 1"),
    ("2*(1 - t^2)/(1 + t^2)", "4*t/(1 + t^2)", "h + 1"),
)
ORDER, POINTS, SIZE = 1, 1_000_000, (100, 100)
INTERSECTION = ("x^2 + y^2 - 1", "x^2/2 + y^2 + z^2 - 9")

Pair = tuple[pas.Boundary, pas.Boundary]


def hermite() -> Any:
    """The blend by pas, from formulas."""
    return pas.hermite_blend(pas.BlendingData([pas.ParametricSurface(*triple) for triple in CYLINDERS]), ORDER)


def naive() -> Work:
    """The blend by sympy, term by term from the formula (Spitzbart 1960)."""
    import sympy

    h, size, n = sympy.Symbol("h"), ORDER + 1, len(CYLINDERS)

    def component(axis: int) -> Any:
        total, whole = sympy.Integer(0), sympy.prod([(h - s) ** size for s in range(n)])
        for i, triple in enumerate(CYLINDERS):
            rest, given = sympy.cancel(whole / (h - i) ** size), sympy.sympify(triple[axis].replace("^", "**"))
            for j in range(size):
                basis = sum(
                    sympy.diff(1 / rest, h, m).subs(h, i) / sympy.factorial(m) * (h - i) ** (j + m)
                    for m in range(size - j)
                )
                total += sympy.diff(given, h, j).subs(h, i) * basis * rest / sympy.factorial(j)
        return sympy.cancel(sympy.together(total))

    return lambda: [component(axis) for axis in range(3)]


def points() -> np.ndarray:
    """Drawn parameters (POINTS, 2)."""
    return np.random.default_rng(1).uniform((0.1, 0.0), (0.7, 1.0), (POINTS, 2))


def values() -> Work:
    """By pas."""
    surface, places = hermite().surface, points()
    return lambda: surface(places)


def sympy_values() -> Work:
    """By sympy's function for numpy of the quotients."""
    import sympy

    function = sympy.lambdify(sympy.symbols("t h"), [c.to_sympy() for c in hermite().surface.components])
    t, h = points().T
    return lambda: function(t, h)


def two_pipes() -> Pair:
    """Sections across."""
    return pas.plane_section("x^2 + y^2 - 1", "z - 3"), pas.plane_section("y^2 + z^2/4 - 1/4", "x - 3")


def cut_by_a_quadric() -> Pair:
    """A curve in space."""
    upper = next(b for b in pas.quadric_intersection(*INTERSECTION) if b(0.0)[2] > 0)
    return upper.on(0), pas.plane_section("x^2 + y^2/2 - 1/4", "z - 6")


def helicoid() -> Pair:
    """To a cubic."""
    ends = (-(21 ** (1 / 3)), -(17 ** (1 / 3)))
    cubic = pas.Boundary.on_implicit("x^3 + y + z^2 + 4*z + 5", ("s", "-17 - s^3", "2"), ends)
    return pas.Boundary.on_parametric(pas.SurfaceCurve(pas.helicoid(start=2), "0", "4*s")), cubic


BOUNDARIES = {"two pipes": two_pipes, "cut by a quadric": cut_by_a_quadric, "helicoid, cubic": helicoid}


def blend(make: Callable[[], Pair]) -> Any:
    """With lengths given."""
    return pas.generatrix_blend(*make(), pas.GeneratrixShape("1/2", "1/2"))


def slider(make: Callable[[], Pair]) -> Prepare:
    """From a changed shape value to the new mesh."""

    def prepare() -> Work:
        made, given = blend(make), cycle([0.4 + i / 500 for i in range(100)])
        made.mesh(size=SIZE)
        return lambda: made.with_shape(l1=next(given), lambda2=0.1).mesh(size=SIZE)

    return prepare


def anew(make: Callable[[], Pair]) -> Prepare:
    """With nothing kept from before."""
    return lambda: lambda: blend(make).mesh(size=SIZE)


def certificate(make: Callable[[], Pair]) -> Prepare:
    """All verdicts of one blend."""

    def prepare() -> Work:
        made = blend(make)
        return lambda: made.with_shape(l1=0.5).certificate

    return prepare


test_exact = measured(
    {
        "Hermite blend of two cylinders, GC^1, exact": {"pas": lambda: hermite, "sympy": naive},
        f"{POINTS:,} values of it": {"pas": values, "sympy": sympy_values},
    }
)
test_generatrix = measured(
    {
        f"generatrix blend, {name}: {what}": {"pas": work(make)}
        for name, make in BOUNDARIES.items()
        for what, work in {
            "a slider's step and its mesh, 100 x 100": slider,
            "made and meshed anew": anew,
            "certificate": certificate,
        }.items()
    }
)
