"""Writes docs/dimensions.md: dimensions of spline spaces on splits of one cell, counted and by published formulas.

    python docs/dimensions.py

Everything in the tables is measured: `pas.solutions([], order, degree, partition).dimension`, of a layout
`layout.dimensions([], order, [degree])`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import comb
from pathlib import Path

import pas

HIGHEST = {0: 4, 1: 7, 2: 8, 3: 9}
"""The degree up to which an order is counted."""


@dataclass(frozen=True)
class Bench:
    """A partition, a formula for dimensions by order and degree, the orders for which it holds, and where it stands."""

    title: str
    partition: Callable[[], pas.Partition | pas.Layout]
    formula: Callable[[int, int], int]
    orders: tuple[int, ...]
    words: str


def alfeld(r: int, n: int) -> int:
    """Schenck 2014, as conjectured by Foucart and Sorokina 2013; for r = 1 Kolesnikov and Sorokina 2014."""
    if r % 2:
        return comb(n + 3, 3) + 3 * choose(n + 3 - 2 * (r + 1), 3)
    return comb(n + 3, 3) + sum(choose(n + 2 - i - 2 * r, 3) for i in range(3))


def worsey_farin(r: int, n: int) -> int:
    """Guzman, Lischke and Neilan 2022, for r = 1; continuous ones are counted by their B-coefficients."""
    if r == 0:
        vertices, edges, triangles, cells = 9, 26, 30, 12
        return vertices + edges * (n - 1) + triangles * choose(n - 1, 2) + cells * choose(n - 1, 3)
    return 2 * n**3 - 6 * n**2 + 10 * n - 2


def kuhn(r: int, n: int) -> int:
    """The sum over the degrees up to n of dimensions around a vertex of 6 edges with 3 slopes.

    Across the diagonal the partition is that plane one, whose dimensions are Schumaker's (1979; Lai and Schumaker 2007,
    theorem 9.3), and along it there is no condition.
    """
    return sum(around_a_vertex(r, k, edges=6, slopes=3) for k in range(n + 1))


def around_a_vertex(r: int, n: int, edges: int, slopes: int) -> int:
    """Plane splines of C^r and degree n around a vertex with so many edges of so many slopes."""
    if n <= r:
        return comb(n + 2, 2)
    excess = sum(max(r + j + 1 - j * slopes, 0) for j in range(1, n - r + 1))
    return comb(r + 2, 2) + edges * comb(n - r + 1, 2) + excess


def choose(n: int, k: int) -> int:
    """The binomial coefficient, 0 for a negative n."""
    return comb(n, k) if n >= 0 else 0


AROUND = ((7, -1, 1), (3, 8, -2), (-4, 6, 1), (-9, 1, 2), (-3, -7, 3), (2, -9, 1))
"""Rays of six half-planes through the line along (1, 2, 5), no two of which make a plane."""


def fan() -> pas.Layout:
    """Six half-planes through one line."""
    count = len(AROUND)
    pieces = [(0, 2 + i, 1, 2 + (i + 1) % count) for i in range(count)]
    return pas.Layout([(1, 2, 5), (-1, -2, -5), *AROUND], pieces, name="fan of 6 half-planes")


def lunes(r: int, n: int) -> int:
    """The sum over the degrees up to n of dimensions around a vertex of 6 edges with 6 slopes, as for the cube."""
    return sum(around_a_vertex(r, k, edges=len(AROUND), slopes=len(AROUND)) for k in range(n + 1))


def count_of(partition: pas.Partition | pas.Layout, r: int, n: int) -> int:
    """The dimension that is counted."""
    if isinstance(partition, pas.Layout):
        return partition.dimensions([], r, [n])[n]
    return pas.solutions([], r, n, partition).dimension


BENCHES = (
    Bench(
        "Alfeld split, one tetrahedron in four",
        pas.AlfeldSplit,
        alfeld,
        (0, 1, 2, 3),
        "`C(n+3, 3) + 3 C(n+1-2r, 3)` for odd r, `C(n+3, 3)` and `C(n+2-2r, 3) + C(n+1-2r, 3) + C(n-2r, 3)` for even r "
        "(conjectured by Foucart and Sorokina 2013, proved by Schenck 2014; the split is that of Alfeld 1984)",
    ),
    Bench(
        "Worsey-Farin split, one tetrahedron in twelve",
        pas.WorseyFarinSplit,
        worsey_farin,
        (0, 1),
        "`2 n^3 - 6 n^2 + 10 n - 2` for r = 1 (Guzman, Lischke and Neilan 2022; 28 cubics: Worsey and Farin 1987), "
        "vertices, edges, triangles and cells counted for r = 0",
    ),
    Bench(
        "Kuhn's cube, a box in six",
        pas.KuhnCube,
        kuhn,
        (0, 1, 2, 3),
        "the sum over k = 0 .. n of `C(r+2, 2) + 6 C(k-r+1, 2) + sum over j of (r + j + 1 - 3 j)+`, Schumaker's (1979) "
        "for plane splines around a vertex with six edges of three slopes (Lai and Schumaker 2007, theorem 9.3)",
    ),
    Bench(
        "Fan of six half-planes, a layout",
        fan,
        lunes,
        (1, 2, 3),
        "the same with six slopes, `(r + j + 1 - 6 j)+`; for r = 1 that is 13 + 10 N for n = 4 and N half-planes, for "
        "r = 2 it is 28 + 10 N for n = 5 and 34 + 20 N for n = 6",
    ),
)

HEAD = """# Dimensions of spline spaces on splits and layouts

Splines of degree at most n that are C^r on a split of one cell or on a layout, with no contacts to meet: counted by
exact linear algebra (`pas.solutions([], order=r, degree=n, partition=...).dimension`, `layout.dimensions`) and by a
published formula.  Made by `python docs/dimensions.py`; of the counts for r = 1 those up to n = 4 and 5 are tests,
there checked by floating-point ranks as well.
"""


def table(bench: Bench) -> str:
    """The section of one partition; raises `ValueError` where count and formula differ."""
    partition = bench.partition()
    lines = [f"## {bench.title}\n", f"Formula: {bench.words}.\n", "| r | n | counted | formula |", "|---|---|---|---|"]
    for r in bench.orders:
        for n in range(1, HIGHEST[r] + 1):
            counted, expected = count_of(partition, r, n), bench.formula(r, n)
            if counted != expected:
                raise ValueError(
                    f"{bench.title}: {counted} counted for r = {r}, n = {n}, where {expected} are published"
                )
            lines.append(f"| {r} | {n} | {counted} | {expected} |")
    return "\n".join(lines)


if __name__ == "__main__":
    page = "\n\n".join([HEAD.strip(), *map(table, BENCHES)]) + "\n"
    Path(__file__).with_suffix(".md").write_text(page, encoding="utf-8")
