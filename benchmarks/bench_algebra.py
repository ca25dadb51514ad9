"""Exact algebra: products, Groebner bases, spaces of solutions."""

from __future__ import annotations

from collections.abc import Sequence

from measured import Prepare, Work, command, measured

import pas

AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
QUARTICS = ("(x + 2*y - 3*z + 1)^4 - x*y*z + 7", "(3*x - y + z/2 - 2)^4 + x^2*y - 5")
IDEAL = ("x^2 + y^2 + z^2 - 4", "x*y - z^2 + 1", "x^3 - y*z + 2*x - 3")
"""Two dense quartics, and a quadric, a quadric and a cubic that meet in points."""


def product() -> Work:
    """By pas."""
    first, second = map(pas.Polynomial, QUARTICS)
    return lambda: first * second


def sympy_product() -> Work:
    """By sympy's sparse polynomials."""
    from sympy import QQ, ring

    _, x, y, z = ring("x, y, z", QQ)
    first = (x + 2 * y - 3 * z + 1) ** 4 - x * y * z + 7
    second = (3 * x - y + z * QQ(1, 2) - 2) ** 4 + x**2 * y - 5
    return lambda: first * second


def basis() -> Work:
    """By pas, from the polynomials."""
    return lambda: pas.Ideal(*IDEAL).groebner_basis()


def sympy_basis() -> Work:
    """By sympy."""
    from sympy import groebner, sympify

    generators = [sympify(text.replace("^", "**")) for text in IDEAL]
    return lambda: groebner(generators, order="grevlex")


def space(radii: Sequence[str], order: int, degree: int) -> Prepare:
    """All corners of a degree; the problem is placed outside the clock's reach only in part, as for users."""

    def prepare() -> Work:
        pipes = [pas.Pipe(axis, radius, 1) for axis, radius in zip(AXES, radii, strict=True)]
        return lambda: pas.solutions(pipes, order, degree).dimension

    return prepare


test_algebra = measured(
    {
        "product of two dense quartics": {"pas": product, "sympy": sympy_product},
        "Groebner basis of three surfaces (commands with their start)": {
            "pas": basis,
            "sympy": sympy_basis,
            "Singular": command(
                "Singular", "-q", "-c", f"ring r=0,(x,y,z),dp; ideal i={', '.join(IDEAL)}; std(i); quit;"
            ),
            "Macaulay2": command(
                "M2", "--silent", "--stop", "-e", f"R=QQ[x,y,z]; gens gb ideal({', '.join(IDEAL)}); exit 0"
            ),
        },
        "all GC^2 corners of degree 6": {"pas": space(("1/3", "1/4", "2/5"), 2, 6)},
        "all GC^3 corners of degree 7": {"pas": space(("1/3", "1/4", "2/5"), 3, 7)},
    }
)
