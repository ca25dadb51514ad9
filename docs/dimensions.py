"""Writes docs/dimensions.md: dimensions of spline spaces on splits of one cell, counted and by published formulas.

    python docs/dimensions.py

Everything in the tables is measured: `pas.solutions([], order, degree, partition).dimension`, of a layout
`layout.dimensions([], order, [degree])`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, permutations
from math import comb
from pathlib import Path

import pas

HIGHEST = {0: 4, 1: 7, 2: 8, 3: 9}
"""The degree up to which an order is counted."""


@dataclass(frozen=True)
class Bench:
    """A partition, a formula for dimensions by order and degree, the orders for which it holds, and where it stands.

    Where `homogeneous` is set, the formula is for splines that are homogeneous of degree n, of which there are as many
    as the dimensions up to n and up to n - 1 differ by.  `degrees` are those for which it holds, of an order.
    """

    title: str
    partition: Callable[[], pas.Partition | pas.Layout]
    formula: Callable[[int, int], int]
    orders: tuple[int, ...]
    words: str
    homogeneous: bool = False
    degrees: Callable[[int], Iterable[int]] = lambda r: range(1, HIGHEST[r] + 1)


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


def octahedron(rays: list[tuple[int, int, int]]) -> pas.Layout:
    """Eight pieces around one point: each takes one ray of each of three pairs."""
    return star(rays, [(a, b, c) for a in (0, 1) for b in (2, 3) for c in (4, 5)], "octahedron")


def star(rays: Sequence[tuple[Fraction | int, ...]], pieces: Iterable[tuple[int, ...]], name: str) -> pas.Layout:
    """The layout of pieces with three rays each, in any order."""

    def turned(a: int, b: int, c: int) -> tuple[int, int, int]:
        p, q, r = (rays[i] for i in (a, b, c))
        volume = sum(p[i] * (q[i - 2] * r[i - 1] - q[i - 1] * r[i - 2]) for i in range(3))
        return (a, b, c) if volume > 0 else (a, c, b)

    return pas.Layout(list(rays), [turned(*piece) for piece in pieces], name=name)


def regular_octahedron() -> pas.Layout:
    """Eight pieces between three planes."""
    return octahedron([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])


def generic_octahedron() -> pas.Layout:
    """Eight pieces around one point, no two of whose inner triangles lie in one plane."""
    return octahedron([(9, 1, 2), (-8, 3, 1), (1, 9, -2), (2, -9, 3), (-1, 2, 9), (3, 1, -8)])


def three_planes(r: int, n: int) -> int:
    """One polynomial, times the truncated power of order r + 1 of each choice among three planes."""
    return sum(comb(3, chosen) * choose(n + 3 - (r + 1) * chosen, 3) for chosen in range(4))


CORNERS = ((3, 3, 3), (3, -3, -3), (-3, 3, -3), (-3, -3, 3))
"""Of a tetrahedron around the origin."""


def worsey_piper(edge: Callable[..., int], face: Callable[..., int]) -> pas.Layout:
    """The 24 pieces of a tetrahedron, cut at a point of each edge and face: means of its corners by such weights."""

    def mean(corners: tuple[int, ...], weight: Callable[..., int]) -> tuple[Fraction, ...]:
        return tuple(sum((Fraction(weight(i) * CORNERS[i][j]) for i in corners), Fraction(0)) for j in range(3))

    points = {(i,): CORNERS[i] for i in range(4)}
    points |= {corners: mean(corners, edge) for corners in combinations(range(4), 2)}
    points |= {corners: mean(corners, face) for corners in combinations(range(4), 3)}
    number = {corners: i for i, corners in enumerate(points)}
    flags = [tuple(number[tuple(sorted(order[:k]))] for k in (1, 2, 3)) for order in permutations(range(4), 3)]
    return star(list(points.values()), flags, "Worsey-Piper split")


def barycentric() -> pas.Layout:
    """The Worsey-Piper split at the middles of edges and faces: each edge's point, face points and centre coplanar."""
    return worsey_piper(lambda i: 1, lambda i: 1)


def generic_piper() -> pas.Layout:
    """Twenty-four pieces cut in the same way at other points."""
    return worsey_piper(lambda i: 1 + i * i, lambda i: 2 + 3 * i - i * i // 2)


def on_a_star(slopes: tuple[int, ...]) -> Callable[[int, int], int]:
    """The formula for homogeneous splines around a point, with the number of slopes at each of the rays."""

    def formula(r: int, n: int) -> int:
        excess = sum(max(r + j + 1 - j * m, 0) for m in slopes for j in range(1, n - r + 1))
        return (n - r) * (n - 2 * r) * len(slopes) - 2 * n * n + 6 * r * n - 3 * r * r + 3 * r + 2 + excess

    return formula


def high(r: int) -> range:
    """Degrees for which the formula of homogeneous splines is proved."""
    return range(3 * r + 2, 3 * r + 4)


STAR = (
    "`(n - r)(n - 2r) V - 2 n^2 + 6 r n - 3 r^2 + 3 r + 2 + sum over rays and j of (r + j + 1 - j m)+` for "
    "the splines that are homogeneous of degree n >= 3r + 2, with V rays, m slopes of planes at each (Alfeld, Neamtu "
    "and Schumaker 1996); "
)


def count_of(partition: pas.Partition | pas.Layout, r: int, n: int, homogeneous: bool = False) -> int:
    """The dimension that is counted."""
    if isinstance(partition, pas.Layout):
        counted = partition.dimensions([], r, [n - 1, n] if homogeneous else [n])
        return counted[n] - counted.get(n - 1, 0)
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
    Bench(
        "Octahedral split, eight pieces between three planes",
        regular_octahedron,
        three_planes,
        (0, 1, 2),
        "`sum over i = 0 .. 3 of C(3, i) C(n + 3 - (r + 1) i, 3)`: a polynomial for each choice of planes, times the "
        "truncated powers of these",
    ),
    Bench(
        "Octahedral split in the special position, by degree",
        regular_octahedron,
        on_a_star((2,) * 6),
        (0, 1, 2),
        STAR + "here m = 2",
        homogeneous=True,
        degrees=high,
    ),
    Bench(
        "Star of eight pieces in general position, by degree",
        generic_octahedron,
        on_a_star((4,) * 6),
        (0, 1, 2),
        STAR + "here m = 4",
        homogeneous=True,
        degrees=high,
    ),
    Bench(
        "Worsey-Piper split, one tetrahedron in twenty-four",
        barycentric,
        lambda r, n: 4 * 4,
        (1,),
        "values and gradients at the corners, 4 for each, for r = 1 and n = 2 (Worsey and Piper 1988)",
        degrees=lambda r: (2,),
    ),
    Bench(
        "Worsey-Piper split, by degree",
        barycentric,
        on_a_star((3,) * 4 + (2,) * 6 + (3,) * 4),
        (0, 1, 2),
        STAR + "here m = 3 at corners and faces, 2 at edges",
        homogeneous=True,
        degrees=high,
    ),
    Bench(
        "Twenty-four pieces in general position, by degree",
        generic_piper,
        on_a_star((6,) * 4 + (3,) * 6 + (6,) * 4),
        (0, 1, 2),
        STAR + "here m = 6 at corners and faces, 3 at edges",
        homogeneous=True,
        degrees=high,
    ),
)

HEAD = """# Dimensions of spline spaces on splits and layouts

Splines of degree at most n that are C^r on a split of one cell or on a layout, with no contacts to meet: counted by
exact linear algebra (`pas.solutions([], order=r, degree=n, partition=...).dimension`, `layout.dimensions`) and by a
published formula.  Tables "by degree" count splines that are homogeneous of degree n: the dimensions up to n and up to
n - 1 differ by these.  Pieces in general position have fewer splines than those whose triangles lie in few planes.
Made by `python docs/dimensions.py`; of the counts for r = 1 those of low degrees are tests, those of splits there
checked by floating-point ranks as well.
"""


def table(bench: Bench) -> str:
    """The section of one partition; raises `ValueError` where count and formula differ."""
    partition = bench.partition()
    lines = [f"## {bench.title}\n", f"Formula: {bench.words}.\n", "| r | n | counted | formula |", "|---|---|---|---|"]
    for r in bench.orders:
        for n in bench.degrees(r):
            counted, expected = count_of(partition, r, n, bench.homogeneous), bench.formula(r, n)
            if counted != expected:
                raise ValueError(
                    f"{bench.title}: {counted} counted for r = {r}, n = {n}, where {expected} are published"
                )
            lines.append(f"| {r} | {n} | {counted} | {expected} |")
    return "\n".join(lines)


if __name__ == "__main__":
    page = "\n\n".join([HEAD.strip(), *map(table, BENCHES)]) + "\n"
    Path(__file__).with_suffix(".md").write_text(page, encoding="utf-8")
