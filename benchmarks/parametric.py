"""Parametric blends against the naive way with sympy, as ratios in one run.

    python benchmarks/parametric.py [--points 1000000] [--repeat 3]

First the milliseconds of the exact particular solution (reading, Hermite basis, Taylor coefficients, sum,
lowest terms), here and by sympy's diff, subs and cancel.  Then those of values at the points, here at
scattered points and on a grid, against `sympy.lambdify` of the expanded expression (`sympy.expand`, a sum of
monomials over denominators) and of the quotient (numerator over denominator, each expanded).  Ratios are to
scattered points, the last one that of the expanded expression to the grid.  `off by` is the relative
difference from the quotient, whose expanded numerators cancel badly for many surfaces.

Medians, imports not counted.  Where the naive evaluation would take more than ten seconds it is done at
fewer points and scaled up, which flatters it.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np
import sympy

import pas

CIRCLE = ("(1 - t^2)/(1 + t^2)", "2*t/(1 + t^2)")
Triple = tuple[str, str, str]
CASES: dict[str, tuple[list[Triple], int]] = {
    "2 cylinders, k=1": ([(*CIRCLE, "h - 1"), ("2*(1 - t^2)/(1 + t^2)", "4*t/(1 + t^2)", "h + 1")], 1),
    "2 tubes, k=2": (
        [
            ("(t**2-1)/(t**2+1)", "(8*t**2+8-15*t**2*h-15*h+18*t*h+4*t**2*h**3+4*h**3)/(4*(t**2+1))", "2*t/(t**2+1)"),
            ("(t**2-1)/(t**2+1)", "2*t/(t**2+1)", "2*(-t**2-1+2*t-2*t*h+2*t**2*h+2*h)/(t**2+1)"),
        ],
        2,
    ),
    "3 spheres, k=1": (
        [
            ("(h**2+t**2-1)/(h**2+t**2+1)", "2*t/(h**2+t**2+1)", "2*h/(h**2+t**2+1)+1"),
            ("2*(t**2-1)/(t**2+1)", "4*t/(t**2+1)", "h-1"),
            (
                "(h**2-4*h+3+t**2)/(h**2-4*h+5+t**2)",
                "2*t/(h**2-4*h+5+t**2)",
                "-2*(-5*h+7+h**2+t**2)/(5-4*h+h**2+t**2)",
            ),
        ],
        1,
    ),
    "2 general, k=4": (
        [
            (
                "(15+35*t-98*h+74*t*h+15*h**2+41*t**2)/(9*(1+10*t-8*h))",
                "-2*(31+19*t-44*h)/(47*t-19*t**3*h+72*h-17*t**2*h**2-55*h**2+72*h**3)",
                "(42+18*t-42*h-27*t*h+2*h**2+74*t**2)/(90-81*t+67*h-85*t*h**2-84*h**2-42*t**2)",
            ),
            (
                "1",
                "-(90-10*t*h-95*h**2-80*h**3-90*t**2+19*t**2*h)/(-40-45*t+91*h-7*t*h+30*h**2+37*t**2)",
                "-(42+39*t-20*h)/(-31*t+71*t**3+47*t*h+58*t*h**2+30*h**3+28*t**2)",
            ),
        ],
        4,
    ),
    "20 cylinders, k=3": (
        [(f"({i} + 1 - t^2)/(1 + t^2)", f"{i + 2}*t/(1 + t^2)", f"h + {i}/7") for i in range(20)],
        3,
    ),
}
PATIENCE = 10.0
"""Seconds after which a measurement is not repeated."""


def milliseconds(work: Callable[[], object], repeat: int) -> float:
    """The median of several runs."""
    spent: list[float] = []
    while len(spent) < repeat and sum(spent) < PATIENCE:
        start = time.perf_counter()
        work()
        spent.append(time.perf_counter() - start)
    return 1e3 * median(spent)


def surfaces(case: list[Triple]) -> pas.BlendingData:
    """The data of a case, read afresh so that nothing is remembered."""
    return pas.BlendingData([pas.ParametricSurface(*triple) for triple in case])


def naive_blend(case: list[Triple], order: int) -> list[Any]:
    """The Hermite blend by sympy, term by term from the formula."""
    h = sympy.Symbol("h")
    n, size = len(case), order + 1
    whole = sympy.prod([(h - s) ** size for s in range(n)])
    basis = {}
    for i in range(n):
        rest = sympy.cancel(whole / (h - i) ** size)
        for j in range(size):
            basis[i, j] = sum(
                sympy.diff(1 / rest, h, m).subs(h, i)
                / (sympy.factorial(m) * sympy.factorial(j))
                * rest
                * (h - i) ** (j + m)
                for m in range(size - j)
            )
    components = []
    for axis in range(3):
        total = sympy.Integer(0)
        for i, triple in enumerate(case):
            component = sympy.sympify(triple[axis].replace("^", "**"))
            for j in range(size):
                total += sympy.diff(component, h, j).subs(h, i) * basis[i, j]
        components.append(sympy.cancel(sympy.together(total)))
    return components


def lambdified(expressions: list[Any], points: np.ndarray) -> float:
    """Milliseconds of evaluating at the points, scaled up from fewer where that takes long."""
    function = sympy.lambdify(sympy.symbols("t h"), expressions)
    share = points[: max(1, len(points) // 100)]
    with np.errstate(all="ignore"):
        rough = milliseconds(lambda: function(share[:, 0], share[:, 1]), 1) * len(points) / len(share)
        if rough > 1e3 * PATIENCE:
            return rough
        return milliseconds(lambda: function(points[:, 0], points[:, 1]), 3)


def exact_times(case: list[Triple], order: int, repeat: int) -> tuple[float, float]:
    """Milliseconds of the exact blend, here and by sympy (nan where that would take minutes)."""
    ours = milliseconds(lambda: pas.hermite_blend(surfaces(case), order).surface.components, repeat)
    return ours, milliseconds(lambda: naive_blend(case, order), 1) if len(case) < 20 else float("nan")


def value_times(blend: pas.ParametricBlend, size: int, repeat: int) -> tuple[float, ...]:
    """Milliseconds of values: scattered points, grid, expanded, quotient; then the relative difference."""
    high = len(blend.data.values) - 1
    points = np.random.default_rng(1).uniform((0.1, 0.0), (0.7, high), (size, 2))
    side = round(size**0.5)
    t, h = np.linspace(0.1, 0.7, side), np.linspace(0, high, side)
    scattered = milliseconds(lambda: blend.surface(points), repeat)
    grid = milliseconds(lambda: blend.surface.on_grid(t, h), repeat)
    quotients = [c.to_sympy() for c in blend.surface.components]
    expanded = lambdified([sympy.expand(q) for q in quotients], points)
    quotient = lambdified(quotients, points)
    few = points[:1000]
    values = np.stack([c(few[:, 0], few[:, 1]) for c in blend.surface.components], axis=-1)
    off = np.nanmax(np.abs(values - blend.surface(few)) / (1 + np.abs(values)))
    return scattered, grid, expanded, quotient, float(off)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--repeat", type=int, default=5)
    options = parser.parse_args()
    exact_times(*CASES["2 cylinders, k=1"], 1)  # imports
    print(f"{'exact':<20}" + "".join(f"{column:>11}" for column in ("here", "sympy", "ratio")))
    for name, (case, order) in CASES.items():
        ours, naive = exact_times(case, order, options.repeat)
        print(f"{name:<20}{ours:>11.1f}{naive:>11.1f}{naive / ours:>11.1f}", flush=True)
    columns = ("points", "grid", "expanded", "quotient", "ratio", "ratio", "grid ratio", "off by")
    for kind, make in (("Hermite", pas.hermite_blend), ("weights", pas.weighted_blend)):
        print(f"\n{kind:<20}" + "".join(f"{column:>11}" for column in columns))
        for name, (case, order) in CASES.items():
            if make is pas.weighted_blend and len(case) > 3:
                continue  # the expanded expression alone would take minutes
            scattered, grid, expanded, quotient, off = value_times(
                make(surfaces(case), order), options.points, options.repeat
            )
            row = (scattered, grid, expanded, quotient, expanded / scattered, quotient / scattered, expanded / grid)
            print(f"{name:<20}" + "".join(f"{entry:>11.1f}" for entry in row) + f"{off:>11.1e}", flush=True)


if __name__ == "__main__":
    main()
