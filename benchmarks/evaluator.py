"""Nanoseconds a value and seconds of rays on the corner of degree 5, beside other ways, in one run.

    python benchmarks/evaluator.py [--points 1000000] [--rays 100000] [--repeat 3]

CPU seconds, the least of several runs.  "Barycentric coordinates and monomials" finds cells by all their barycentric
coordinates and multiplies a matrix of monomials, as `pas` once did throughout.  The lower rows are of one polynomial
without location: sympy's lambdify of its Horner form, and numpy.polynomial.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
import sympy

import pas
from pas.algebra.monomials import exponents, monomial_values

CHUNK = 1 << 15
"""Points of which monomials are held at once, in the old way."""


def corner() -> pas.PiecewiseSurface:
    """The corner of three unequal pipes, GC^2, of degree 5."""
    axes, radii = ((1, 0, 0), (0, 1, 0), (0, 0, 1)), ("1/3", "1/4", "2/5")
    pipes = [pas.Pipe(axis, radius, 1) for axis, radius in zip(axes, radii, strict=True)]
    return pas.blend(pipes, 2, energy=pas.ThinPlate()).surface


def seconds(work: Callable[[], object], repeat: int) -> float:
    """The least CPU seconds of several calls."""
    spent = []
    for _ in range(repeat):
        start = time.process_time()
        work()
        spent.append(time.process_time() - start)
    return min(spent)


def as_before(surface: pas.PiecewiseSurface, points: np.ndarray) -> np.ndarray:
    """Values by all barycentric coordinates and monomials."""
    local = surface.partition.frame.local_points(points)
    pieces = surface.partition.piece_of[surface.local.locate(local)]
    result = np.full(len(points), np.nan)
    for piece, patch in enumerate(surface.patches):
        rows, column = np.flatnonzero(pieces == piece), patch.dense(surface.degree)
        for start in range(0, len(rows), CHUNK):
            part = rows[start : start + CHUNK]
            result[part] = column @ monomial_values(local[part], surface.degree)
    return result


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=10**6)
    parser.add_argument("--rays", type=int, default=10**5)
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    surface = corner()
    rng = np.random.default_rng(0)
    points = rng.uniform(-1, 1, (options.points, 3))
    origins = rng.normal(size=(options.rays, 3))
    origins *= 3 / np.linalg.norm(origins, axis=1)[:, None]
    directions = rng.uniform(-0.7, 0.7, (options.rays, 3)) - origins
    known = pas.Evaluator(surface)
    print(f"degree {surface.degree}, {options.points} points, {options.rays} rays")

    ways: dict[str, Callable[[], object]] = {
        "values": lambda: known.values(points),
        "values and gradients": lambda: known.jets(points),
        "Hessians": lambda: known.hessians(points),
        "third derivatives": lambda: known.third_derivatives(points),
    }
    reference = seconds(lambda: as_before(surface, points), options.repeat)
    print(f"{'ns a point, with location':<50}{'ns':>8}{'ratio':>8}")
    row("barycentric coordinates and monomials", reference, reference, options.points)
    for title, work in ways.items():
        row(title, seconds(work, options.repeat), reference, options.points)

    polynomial = surface.polynomials[0]
    x, y, z = sympy.symbols("x y z")
    formula = sympy.lambdify((x, y, z), sympy.horner(polynomial.to_sympy()), "numpy")
    cube = np.zeros((surface.degree + 1,) * 3)
    for exponent, coefficient in zip(exponents(surface.degree), polynomial.dense(surface.degree), strict=True):
        cube[exponent] = coefficient
    columns = np.ascontiguousarray(points.T)
    alone = pas.Evaluator(polynomial)
    print(f"{'one polynomial, without location':<50}")
    row("sympy lambdify", seconds(lambda: formula(*columns), options.repeat), reference, options.points)
    polyval = np.polynomial.polynomial.polyval3d
    row("numpy.polynomial", seconds(lambda: polyval(*columns, cube), options.repeat), reference, options.points)
    row("values", seconds(lambda: alone.values(points), options.repeat), reference, options.points)

    first = seconds(lambda: known.first(origins, directions), options.repeat)
    crossings = seconds(lambda: known.rays(origins, directions), options.repeat)
    print(f"seconds of rays: first crossings {first:.2f}, all crossings {crossings:.2f}")


def row(title: str, spent: float, reference: float, points: int) -> None:
    """Print one line: nanoseconds a point, and how many times as fast as the reference."""
    print(f"  {title:<48}{spent / points * 1e9:>8.0f}{reference / spent:>8.1f}", flush=True)


if __name__ == "__main__":
    main()
