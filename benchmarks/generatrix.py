"""Generatrix blends: what a slider costs, what making one costs, as ratios in one run.

    python benchmarks/generatrix.py [--repeat 30]

`slider` is the milliseconds from a changed shape value to the new mesh (points, normals, triangles) of 100 x 100
points; `anew` the same with nothing kept from before: `generatrix_blend` with lengths given, and its mesh.  `naive`
evaluates the surface and its normals at the same points by Taylor arithmetic.  `certificate` is all verdicts of one
blend, `safe` the largest safe length.  Medians; imports not counted.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from statistics import median

import numpy as np

import pas

SIZE = (100, 100)
SHAPE = pas.GeneratrixShape("1/2", "1/2")
INTERSECTION = ("x^2 + y^2 - 1", "x^2/2 + y^2 + z^2 - 9")


def cases() -> dict[str, tuple[Callable[[], pas.Boundary], Callable[[], pas.Boundary]]]:
    """Pairs of boundaries, made afresh by each call."""
    return {
        "two pipes": (
            lambda: pas.plane_section("x^2 + y^2 - 1", "z - 3"),
            lambda: pas.plane_section("y^2 + z^2/4 - 1/4", "x - 3"),
        ),
        "cut by a quadric": (
            lambda: next(b for b in pas.quadric_intersection(*INTERSECTION) if b(0.0)[2] > 0).on(0),
            lambda: pas.plane_section("x^2 + y^2/2 - 1/4", "z - 6"),
        ),
        "helicoid, cubic": (
            lambda: pas.Boundary.on_parametric(pas.SurfaceCurve(pas.helicoid(start=2), "0", "4*s")),
            lambda: pas.Boundary.on_implicit(
                "x^3 + y + z^2 + 4*z + 5", ("s", "-17 - s^3", "2"), (-(21 ** (1 / 3)), -(17 ** (1 / 3)))
            ),
        ),
    }


def milliseconds(work: Callable[[], object], repeat: int) -> float:
    """The median of several runs."""
    spent = []
    for _ in range(repeat):
        start = time.perf_counter()
        work()
        spent.append(time.perf_counter() - start)
    return 1e3 * median(spent)


def row(make: tuple[Callable[[], pas.Boundary], Callable[[], pas.Boundary]], repeat: int) -> tuple[float, ...]:
    """slider, anew, naive, certificate, safe."""
    blend = pas.generatrix_blend(make[0](), make[1](), SHAPE)
    values = iter(np.linspace(0.4, 0.6, 10 * repeat))
    blend.mesh(size=SIZE)
    slider = milliseconds(lambda: blend.with_shape(l1=next(values), lambda2=0.1).mesh(size=SIZE), repeat)
    few = max(repeat // 5, 1)
    anew = milliseconds(lambda: pas.generatrix_blend(make[0](), make[1](), SHAPE).mesh(size=SIZE), few)
    s, t = (np.linspace(0, 1, n) for n in SIZE)
    places = np.stack(np.meshgrid(s, t, indexing="ij"), axis=-1)
    naive = milliseconds(lambda: (blend.surface(places), blend.surface.normals(places)), few)
    certificate = milliseconds(lambda: blend.with_shape(l1=0.5).certificate, few)
    safe = milliseconds(lambda: blend.largest_safe(0), 1)
    return slider, anew, naive, certificate, safe


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=30)
    options = parser.parse_args()
    columns = ("slider", "anew", "naive", "certificate", "safe", "anew/slider")
    print(f"{'milliseconds':<20}" + "".join(f"{column:>13}" for column in columns))
    for name, make in cases().items():
        numbers = row(make, options.repeat)
        print(f"{name:<20}" + "".join(f"{n:>13.1f}" for n in (*numbers, numbers[1] / numbers[0])), flush=True)


if __name__ == "__main__":
    main()
