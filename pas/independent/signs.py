"""Signs of polynomials on simplices, in integers: subdivision without any rounding.

Points are homogeneous, (x, y, z, 1), and so are polynomials, in the four variables of `RING`.  On a simplex with
corners v_i a polynomial becomes one of the same degree in barycentric coordinates b_i (x = sum b_i v_i); its
B-coefficients are its coefficients divided by multinomials.  They are kept as integers over one positive number and
halved at the longest edge by de Casteljau's algorithm.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import combinations, count, pairwise, product
from math import comb, factorial, lcm, prod
from typing import NamedTuple

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from pas.limits import checkpoint

Point = tuple[fmpq, ...]
Form = list[int]
"""B-coefficients on a simplex, times a positive number, in the order of `_indices`; empty for no polynomial."""

RING = fmpq_mpoly_ctx.get(("a", "b", "c", "d"), Ordering.lex)
ZERO, ONE = RING.constant(0), RING.constant(1)
PROVED, REFUTED, UNDECIDED = "proved", "refuted", "undecided"

BUDGET = 4_000_000
"""B-coefficients examined for one claim: random corners of order 3 took 2 million at most, of order 1 200 000."""

HALVINGS = 800
"""A simplex halved that often is left open: what fails by 10^-40 only is found in half as many."""


class Part(NamedTuple):
    """A simplex, a value in its barycentric coordinates, and what vanishes where the value matters (None: all over)."""

    corners: list[Point]
    value: fmpq_mpoly
    zero: fmpq_mpoly | None = None


def positive(parts: Iterable[Part], budget: int = BUDGET) -> tuple[str, tuple[Point, ...]]:
    """Whether value > 0 on all parts, or wherever the other polynomial vanishes; and a witness where it is not.

    Refuted by a corner with value <= 0; or, where only zeros matter, by a zero with value < 0: a corner, or some point
    of a segment on all of which value < 0 and at whose ends the other polynomial has opposite signs.  A claim that is
    undecided comes with a point of a simplex that was left open.
    """
    left = budget
    queue = deque((0, p.corners, _b_form(p.value, len(p.corners)), _b_form(p.zero, len(p.corners))) for p in parts)
    while queue:
        checkpoint("proving by the independent checker")
        halved, corners, value, zero = queue.popleft()
        if min(value) > 0 or (zero and (min(zero) > 0 or max(zero) < 0)):
            continue
        witness = _failing(corners, value, zero)
        if witness:
            return REFUTED, witness
        left -= len(value) + len(zero)
        if halved == HALVINGS or left < 0:
            return UNDECIDED, (corners[0],)
        queue.extend((halved + 1, *half) for half in _halves(corners, value, zero))
    return PROVED, ()


def on_simplex(p: fmpq_mpoly, corners: list[Point]) -> fmpq_mpoly:
    """A homogeneous polynomial in the barycentric coordinates of a simplex."""
    lines = (sum((b * v[i] for b, v in zip(RING.gens(), corners, strict=False)), ZERO) for i in range(4))
    return p.compose(*lines, ctx=RING)


def _b_form(p: fmpq_mpoly | None, size: int) -> Form:
    """The form on a simplex of `size` corners of a polynomial in its barycentric coordinates."""
    if p is None:
        return []
    terms, degree = p.to_dict(), max(p.total_degree(), 0)
    scale = lcm(*(int(c.q) for c in terms.values()))
    whole = {e: int((c * scale).p) * prod(map(factorial, e)) for e, c in terms.items()}
    return [whole.get(e, 0) for e in _indices(comb(degree + size - 1, degree), size)]


def _failing(corners: list[Point], value: Form, zero: Form) -> tuple[Point, ...]:
    at, zeros = ([form[k] for k in _corners(len(form), len(corners))] for form in (value, zero))
    if not zero:
        return tuple(p for p, v in zip(corners, at, strict=True) if v <= 0)[:1]
    if max(value) < 0 and min(zeros) < 0 < max(zeros):
        return corners[zeros.index(min(zeros))], corners[zeros.index(max(zeros))]
    return tuple(p for p, v, z in zip(corners, at, zeros, strict=True) if z == 0 and v < 0)[:1]


def _halves(corners: list[Point], value: Form, zero: Form) -> Iterator[tuple[list[Point], Form, Form]]:
    """The two simplices, with their forms, on either side of the middle of the longest edge."""
    i, j = max(combinations(range(len(corners)), 2), key=lambda e: _length(corners[e[0]], corners[e[1]]))
    middle = tuple((a + b) / 2 for a, b in zip(corners[i], corners[j], strict=True))
    for moved, *forms in zip((j, i), *(_split(form, len(corners), i, j) for form in (value, zero)), strict=True):
        yield [*corners[:moved], middle, *corners[moved + 1 :]], *forms


def _length(a: Point, b: Point) -> fmpq:
    """The square of a distance."""
    return sum(((x - y) ** 2 for x, y in zip(a, b, strict=True)), fmpq(0))


def _split(form: Form, size: int, i: int, j: int) -> tuple[Form, Form]:
    """De Casteljau's algorithm at the middle of edge i j: the halves with corner i and with corner j."""
    first, second, lines = list(form), list(form), _lines(len(form), size, i, j)
    degree = max(map(len, lines), default=1) - 1
    for line in lines:
        row = [form[k] for k in line]
        for step, (p, q) in enumerate(zip(line, reversed(line), strict=True)):
            first[p], second[q] = row[0] << (degree - step), row[-1] << (degree - step)
            row = [a + b for a, b in pairwise(row)]
    return first, second


@lru_cache(maxsize=None)
def _indices(length: int, size: int) -> list[tuple[int, ...]]:
    """The exponents of the `length` B-coefficients on a simplex of `size` corners, in four coordinates."""
    degree = next(n for n in count() if comb(n + size - 1, n) >= length)
    free = (e for e in product(range(degree + 1), repeat=size - 1) if sum(e) <= degree)
    return [(*e, degree - sum(e), *[0] * (4 - size)) for e in free][:length]


@lru_cache(maxsize=None)
def _corners(length: int, size: int) -> list[int]:
    """The positions of the corners' B-coefficients, which are values there."""
    return [max(range(length), key=lambda k: _indices(length, size)[k][i]) for i in range(size) if length]


@lru_cache(maxsize=None)
def _lines(length: int, size: int, i: int, j: int) -> list[list[int]]:
    """The positions of the B-coefficients along edge i j and along the lines parallel to it, from i to j."""
    lines = defaultdict(list)
    for position, e in enumerate(_indices(length, size)):
        lines[tuple(n for k, n in enumerate(e) if k not in (i, j))].append((e[j], position))
    return [[position for _, position in sorted(line)] for line in lines.values()]
