"""Signs of polynomials on simplices, in integers: subdivision without any rounding.

Points are homogeneous, (x, y, z, 1), and so are polynomials, in four variables.  On a simplex with corners v_i one
becomes a polynomial in barycentric coordinates b_i (x = sum b_i v_i), which is positive where its coefficients are.
Where it matters at the zeros of another one only, any multiple of that may be added to it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from itertools import combinations
from math import comb, lcm
from typing import NamedTuple

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpz, fmpz_mpoly, fmpz_mpoly_ctx

from pas.limits import checkpoint

Point = tuple[fmpq, ...]
Forms = list[fmpz_mpoly]
RING = fmpq_mpoly_ctx.get(("a", "b", "c", "d"), Ordering.lex)
WHOLE = fmpz_mpoly_ctx.get(("a", "b", "c", "d"), Ordering.lex)
ZERO, ONE = RING.constant(0), RING.constant(1)
PROVED, REFUTED, UNDECIDED = "proved", "refuted", "undecided"

BUDGET = 4_000_000
"""Coefficients examined for one claim: random corners of order 3 took 2 million at most, of order 1 200 000."""


class Query(NamedTuple):
    """A simplex, a value in its barycentric coordinates, and what vanishes where the value matters (None: all over)."""

    corners: tuple[Point, ...]
    value: fmpq_mpoly
    zero: fmpq_mpoly | None = None


def positive(parts: Iterable[Query], budget: int = BUDGET) -> tuple[str, tuple[Point, ...]]:
    """Whether value > 0 on all parts, or wherever the other polynomial vanishes; and a witness where it is not.

    Refuted by a corner with value <= 0; or, where only zeros matter, by a zero with value < 0: a corner, or some point
    of a segment on all of which value < 0 and at whose ends the other polynomial has opposite signs.  A claim that is
    undecided comes with a point of a simplex that was left open.
    """
    halvings = 800  # a simplex halved that often is left open: what fails by 10^-40 only is found in half as many
    queue = deque((0, p.corners, [_whole(q) for q in p[1:] if q is not None]) for p in parts)
    while queue:
        checkpoint("proving by the independent checker")
        halved, corners, forms = queue.popleft()
        (least, most), *zero = [_range(form, len(corners)) for form in forms]
        if least > 0 or any(low > 0 or high < 0 for low, high in zero):
            continue
        if zero and _by_multiple(forms[0], forms[1], len(corners)):
            continue
        values, *zeros = [[form(*(i == j for j in range(4))) for i in range(len(corners))] for form in forms]
        if not zeros:
            failing = [p for p, v in zip(corners, values, strict=True) if v <= 0][:1]
        elif most < 0 and min(zeros[0]) < 0 < max(zeros[0]):
            failing = [corners[zeros[0].index(end(zeros[0]))] for end in (min, max)]
        else:
            failing = [p for p, v, z in zip(corners, values, zeros[0], strict=True) if v < 0 and z == 0][:1]
        if failing:
            return REFUTED, tuple(failing)
        budget -= sum(map(len, forms))
        if halved == halvings or budget < 0:
            return UNDECIDED, (corners[0],)
        queue.extend((halved + 1, *half) for half in _halves(corners, forms))
    return PROVED, ()


def on_simplex(p: fmpq_mpoly, corners: Iterable[Point]) -> fmpq_mpoly:
    """A homogeneous polynomial in the barycentric coordinates of a simplex."""
    lines = (sum((b * x for b, x in zip(RING.gens(), axis, strict=False)), ZERO) for axis in zip(*corners, strict=True))
    return p.compose(*lines, ctx=RING)


def _whole(p: fmpq_mpoly) -> fmpz_mpoly:
    """The polynomial times a positive number."""
    scale = lcm(*(int(c.q) for c in p.coeffs()))
    return WHOLE.from_dict({e: int((c * scale).p) for e, c in p.to_dict().items()})


def _range(p: fmpz_mpoly, size: int) -> tuple[fmpz, fmpz]:
    """The least and the largest coefficient on a simplex of `size` corners, those that are missing included."""
    degree, found = max(p.total_degree(), 0), p.coeffs()
    found += [fmpz(0)] * (len(found) < comb(degree + size - 1, degree))
    return min(found), max(found)


def _by_multiple(value: fmpz_mpoly, zero: fmpz_mpoly, size: int) -> bool:
    """Whether all coefficients of value + t zero, both of one degree, are positive for some t."""
    degree, left, right = value.total_degree(), value.to_dict(), zero.to_dict()
    keys = left.keys() | right.keys()
    if degree != zero.total_degree() or len(keys) < comb(degree + size - 1, degree):
        return False
    pairs = [(left.get(e, fmpz(0)), right.get(e, fmpz(0))) for e in keys]
    if any(z == 0 >= v for v, z in pairs):
        return False
    least, most = ([fmpq(-v, z) for v, z in pairs if sign * z > 0] for sign in (1, -1))
    return not least or not most or max(least) < min(most)


def _halves(corners: tuple[Point, ...], forms: Forms) -> Iterator[tuple[tuple[Point, ...], Forms]]:
    """The two simplices, with their forms times powers of two, on either side of the middle of the longest edge."""
    edges = combinations(range(len(corners)), 2)
    i, j = max(edges, key=lambda e: sum((x - y) ** 2 for x, y in zip(corners[e[0]], corners[e[1]], strict=True)))
    middle = tuple((x + y) / 2 for x, y in zip(corners[i], corners[j], strict=True))
    for kept, moved in ((i, j), (j, i)):
        lines = [2 * b for b in WHOLE.gens()]
        lines[moved] = WHOLE.gens()[moved]
        lines[kept] += lines[moved]
        yield (*corners[:moved], middle, *corners[moved + 1 :]), [p.compose(*lines, ctx=WHOLE) for p in forms]
