"""How even the walls of hollow nodes are: 44 nodes, the bottom bracket of a bicycle, feet on runs and pipes on plates.

Bends of 60 to 120 degrees, T, Y, corners, crosses, unequal and skew pipes, cones and spheres, at GC^1 and GC^2, with
walls of an eighth of the largest radius.  Prints for each the
thinnest and the thickest wall over the thickness, as measured along normals of the outer side from some thousand points
of the inner one, and whether it is proved and fair; with `--prove` also by how much of the thickness it is proved to be
thicker, in hundredths.

    python benchmarks/walls.py [--orders 1 2] [--only WORDS] [--prove]
"""

from __future__ import annotations

import argparse
import time
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product
from math import cos, radians, sin

import pas
from pas.pipeline.feet import Tee
from pas.pipeline.search import excess
from pas.surface.depth import Depth

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


def _back(axis: Sequence[int]) -> tuple[int, ...]:
    return tuple(-c for c in axis)


def _turned(degrees: float) -> tuple[Fraction, Fraction, int]:
    """A direction at an angle from x."""
    return Fraction(round(1000 * cos(radians(degrees))), 1000), Fraction(round(1000 * sin(radians(degrees))), 1000), 0


def nodes() -> Iterator[tuple[str, list[object], Fraction]]:
    """The 22 nodes: a name, contacts without clips, and the largest radius."""
    one, half, most = Fraction(1), Fraction(1, 2), Fraction(4, 5)
    for degrees in (60, 75, 90, 105, 120):
        yield f"bend {degrees}", [(X, 1), (_turned(degrees), 1)], one
    yield "bend 90, 1 : 4/5", [(X, 1), (Y, most)], one
    yield "bend 120, 1 : 1/2", [(X, 1), (_turned(120), half)], one
    yield "T", [(X, 1), (_back(X), 1), (Z, 1)], one
    yield "T 1 : 4/5", [(X, 1), (_back(X), 1), (Z, most)], one
    yield "T 1 : 1/2", [(X, 1), (_back(X), 1), (Z, half)], one
    yield "T at 60 degrees", [(X, 1), (_back(X), 1), (_turned(60), most)], one
    yield "Y", [(_turned(d), 1) for d in (0, 120, 240)], one
    yield "Y 1 : 1 : 1/2", [(_turned(0), 1), (_turned(120), 1), (_turned(240), half)], one
    yield "corner", [(X, 1), (Y, 1), (Z, 1)], one
    yield "corner 1 : 3/4 : 1/2", [(X, 1), (Y, Fraction(3, 4)), (Z, half)], one
    yield "skew pipes", [((3, 1, 0), 1), ((-1, 3, 1), 1), ((0, -1, 3), most)], one
    yield "cross", [(X, 1), (_back(X), 1), (Y, 1), (_back(Y), 1)], one
    yield "cross 1 : 3/4", [(X, 1), (_back(X), 1), (Y, Fraction(3, 4)), (_back(Y), Fraction(3, 4))], one
    yield "tetrahedron", [((1, 1, 1), 1), ((1, -1, -1), 1), ((-1, 1, -1), 1), ((-1, -1, 1), 1)], one
    yield "pipe and cone", [pas.Pipe(X, 1, 2), pas.Cone(Y, 1, 2, "1/4")], one
    yield "cone, pipe and pipe", [pas.Cone(X, 1, 3, "1/8"), pas.Pipe(_back(X), 1, 3), pas.Pipe(Z, most, 3)], one
    yield "pipe and sphere", [pas.Pipe(X, 1, 2), pas.Sphere(_back(X), "3/2", "-1/2", (-3, 0, 0))], Fraction(3, 2)


def junctions() -> Iterator[tuple[str, list[object], Fraction]]:
    """The bottom bracket of a bicycle; the other junctions are among the nodes."""
    wide, narrow = Fraction("17.45"), Fraction("14.3")
    yield "bicycle joint", [(X, wide), (_back(X), wide), (_turned(73), narrow)], wide


def openings() -> Iterator[tuple[str, list[object], Fraction]]:
    """Feet of 0.3, 0.5 and 0.7 of the run's radius, and pipes on plates."""
    run = pas.Pipe(X, 1, "auto")
    for tenths, degrees in product((3, 5, 7), (75, 80, 90)):
        axis = Y if degrees == 90 else _turned(degrees)
        branch = pas.Pipe(axis, Fraction(tenths, 10), "auto")
        yield f"foot 0.{tenths} at {degrees}", list(Tee.of(run, branch).contacts), Fraction(1)
    yield "on a plate", [pas.Plate(Z, 2), pas.Pipe(Z, 1, "auto")], Fraction(1)
    yield "leaning on a plate", [pas.Plate(Z, 2), pas.Pipe((1, 0, 3), 1, "auto")], Fraction(1)


def proved(wall: pas.HollowBlend[pas.Blend], bound: Fraction) -> bool:
    """Whether a wall is proved to be thicker than a bound."""
    return wall.thicker_than(bound).proved


def report(name: str, contacts: list[object], radius: Fraction, order: int, prove: bool) -> tuple[float, float]:
    """Prints the line of one node; gives its thinnest and thickest wall over the thickness."""
    start, thickness = time.process_time(), radius / 8
    make = pas.node if isinstance(contacts[0], tuple) else pas.blend
    outer = make(contacts, order)
    blended = time.process_time() - start
    wall = outer.hollow(thickness, prove=False)
    seconds = time.process_time() - start - blended
    shares = Depth(outer.surface)(Depth(wall.inner.surface).samples)[0] / float(thickness)
    low, high = float(shares.min()), float(shares.max())
    said = "proved" if wall.certificate.proved else "NOT PROVED"
    fair = " ".join(name for name, side in (("outer", outer), ("inner", wall.inner)) if excess(side))
    degrees = f"{outer.surface.degree}/{wall.inner.surface.degree}"
    line = f"{name:<22} GC^{order}  {low:.3f} to {high:.3f}  {said}  {degrees}  {blended:5.1f} + {seconds:5.1f} s"
    print(line + (f"  not fair: {fair}" if fair else ""), flush=True)
    if prove:
        start = time.process_time()
        share = bisect_left(range(int(100 * low)), True, key=lambda n: not proved(wall, thickness * (n + 1) / 100))
        print(f"{'':<22} proved thicker than {share / 100:.2f} of it, {time.process_time() - start:.1f} s", flush=True)
    return low, high


def main() -> None:
    """Measure them all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--orders", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--only", default="")
    parser.add_argument("--prove", action="store_true")
    options = parser.parse_args()
    found = []
    for name, contacts, radius in (*nodes(), *junctions(), *openings()):
        for order in options.orders if options.only in name else ():
            if order > 1 and "foot" in name:  # of which walls are not even: see docs/guide/limits.md
                continue
            try:
                found.append(report(name, contacts, radius, order, options.prove))
            except pas.PasError as error:
                print(f"{name:<22} GC^{order}  {error}", flush=True)
    lows, highs = zip(*found, strict=True)
    print(f"{len(found)} walls of {min(lows):.3f} to {max(highs):.3f} of the thickness")


if __name__ == "__main__":
    main()
