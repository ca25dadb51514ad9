"""Exact algebra: products, Groebner bases, spaces of solutions."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Sequence
from typing import Any

from pas.bench.case import Case, Prepare, Suite, Work

QUARTICS = ("(x + 2*y - 3*z + 1)^4 - x*y*z + 7", "(3*x - y + z/2 - 2)^4 + x^2*y - 5")
IDEAL = ("x^2 + y^2 + z^2 - 4", "x*y - z^2 + 1", "x^3 - y*z + 2*x - 3")
"""Two dense quartics, and a quadric, a quadric and a cubic that meet in points."""


def _product() -> Work:
    from pas.algebra.polynomial import Polynomial

    first, second = map(Polynomial, QUARTICS)
    return lambda: first * second


def _sympy_product() -> Work:
    from sympy import QQ, ring

    _, x, y, z = ring("x, y, z", QQ)
    first = (x + 2 * y - 3 * z + 1) ** 4 - x * y * z + 7
    second = (3 * x - y + z * QQ(1, 2) - 2) ** 4 + x**2 * y - 5
    return lambda: first * second


def _basis() -> Work:
    from pas.algebra.ideal import Ideal

    return lambda: Ideal(*IDEAL).groebner_basis()


def _sympy_basis() -> Work:
    from sympy import groebner, sympify

    generators = [sympify(text.replace("^", "**")) for text in IDEAL]
    return lambda: groebner(generators, order="grevlex")


def _singular(script: str) -> Prepare:
    return lambda: lambda: _command(["Singular", "-q", "-c", f"ring r=0,(x,y,z),dp; {script} quit;"])


def _macaulay(script: str) -> Prepare:
    return lambda: lambda: _command(["M2", "--silent", "--stop", "-e", f"R=QQ[x,y,z]; {script}; exit 0"])


def _command(words: list[str]) -> None:
    subprocess.run(words, check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _space(radii: Sequence[str], order: int, degree: int) -> Prepare:
    def prepare() -> Work:
        from pas.blending.place import place
        from pas.blending.solving import solve
        from pas.contacts.pipe import Pipe

        axes = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
        placed = place([Pipe(axis, radius, 1) for axis, radius in zip(axes, radii, strict=True)], order)
        work: Callable[[], Any] = lambda: solve(placed, degree)  # noqa: E731
        return work

    return prepare


def cases() -> list[Case]:
    """Those of this suite."""
    unequal = ("1/3", "1/4", "2/5")
    return [
        Case("product of two dense quartics", _product, {"sympy": _sympy_product}),
        Case(
            "Groebner basis of three surfaces",
            _basis,
            {
                "sympy": _sympy_basis,
                "Singular": _singular(f"ideal i={', '.join(IDEAL)}; std(i);"),
                "Macaulay2": _macaulay(f"gens gb ideal({', '.join(IDEAL)})"),
            },
            "commands with their start",
        ),
        Case("all GC^2 corners of degree 6", _space(unequal, 2, 6)),
        Case("all GC^3 corners of degree 7", _space(unequal, 3, 7)),
    ]


ALGEBRA = Suite("algebra", "exact polynomials, ideals and solution spaces", cases)
