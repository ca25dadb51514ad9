"""Where a ray crosses the zeros of polynomials on closed tetrahedra, exactly, from the definition.

It shares no code with `pas.surface.crossings`: cells are those of the vertices in the user's coordinates, roots
are counted and isolated by Sturm's theorem and signs are read off Taylor expansions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from flint import fmpq, fmpq_mat, fmpq_poly

from pas import Evaluator, Polynomial

Zero = tuple[fmpq, int]
"""Where a ray crosses, to about twenty digits, and the side."""

Span = tuple[fmpq, fmpq | None, fmpq_poly]
"""From where to where a ray is in a cell, both counted, and the polynomial along it there."""

WIDTH = fmpq(1, 1 << 70)
"""Of brackets of roots, over their size."""


@dataclass(frozen=True)
class Ground:
    """Cells, each the exact inverse of the matrix of its corners, and its polynomial; none: all of space."""

    evaluator: Evaluator

    @cached_property
    def polynomials(self) -> list[dict[tuple[int, ...], fmpq]]:
        frame = self.evaluator.partition.frame
        return [_terms(frame.globalise(patch)) for patch in self.evaluator.patches]

    @cached_property
    def cells(self) -> list[fmpq_mat]:
        partition = self.evaluator.partition
        found = []
        for cell in partition.cells:
            corners = [(*partition.vertices[v], fmpq(1)) for v in cell]
            found.append(fmpq_mat(4, 4, [corner[row] for row in range(4) for corner in corners]).inv())
        return found

    def crossings(self, origin: Sequence[float], direction: Sequence[float]) -> list[Zero]:
        """All crossings of a ray, ascending."""
        start, way = ([fmpq(*float(v).as_integer_ratio()) for v in values] for values in (origin, direction))
        spans: dict[tuple[fmpq, fmpq | None, int], fmpq_poly] = {}
        for cell, inverse in enumerate(self.cells):
            lines = inverse * fmpq_mat(4, 2, [v for pair in zip([*start, 1], [*way, 0], strict=True) for v in pair])
            ends = _ends([(lines[i, 0], lines[i, 1]) for i in range(4)])
            if ends is not None:
                piece = next(i for i, piece in enumerate(self.evaluator.partition.pieces) if cell in piece)
                among = cell if ends[0] == ends[1] else -1  # of cells around a stretch the first counts
                spans.setdefault((*ends, among), _along(self.polynomials[piece], start, way))
        if not self.cells:
            spans[fmpq(0), None, -1] = _along(self.polynomials[0], start, way)
        return sorted(_zeros([(low, high, p) for (low, high, _), p in spans.items()]))


def _terms(polynomial: Polynomial) -> dict[tuple[int, ...], fmpq]:
    return {e: fmpq(c.numerator, c.denominator) for e, c in polynomial.coefficients().items()}


def _along(terms: dict[tuple[int, ...], fmpq], start: list[fmpq], way: list[fmpq]) -> fmpq_poly:
    highest = max((max(e) for e in terms), default=0)
    powers = []
    for o, d in zip(start, way, strict=True):
        powers.append([fmpq_poly([1])])
        for _ in range(highest):
            powers[-1].append(powers[-1][-1] * fmpq_poly([o, d]))
    total = fmpq_poly([])
    for (a, b, c), value in terms.items():
        total += value * powers[0][a] * powers[1][b] * powers[2][c]
    return total


def _ends(lines: list[tuple[fmpq, fmpq]]) -> tuple[fmpq, fmpq] | None:
    """Where all of a + b t are at least 0, of t >= 0."""
    low, high = fmpq(0), None
    for a, b in lines:
        if b == 0:
            if a < 0:
                return None
        elif b > 0:
            low = max(low, -a / b)
        else:
            high = -a / b if high is None else min(high, -a / b)
    assert high is not None
    return (low, high) if low <= high else None


def _zeros(spans: list[Span]) -> Iterator[Zero]:
    flat = [(low, high) for low, high, p in spans if p.degree() < 0 and low != high]
    starts = [low for low, _ in flat if not any(a < low and _in(low, b) for a, b in flat)]
    yield from ((low, 0) for low in set(starts))
    for t in {t for low, high, p in spans for t in (low, high) if t is not None and p(t) == 0}:
        if not any(a <= t and _in(t, b) for a, b in flat):
            after = next((_sign_after(p, t) for low, high, p in spans if low <= t != high and _in(t, high)), 0)
            before = next((_sign_before(p, t) for low, high, p in spans if low < t and _in(t, high)), 0)
            before, after = before or -after, after or -before
            yield t, (after > before) - (after < before)
    for low, high, p in spans:
        if p.degree() > 0 and low != high:
            yield from _inner(p, low, high)


def _in(t: fmpq, high: fmpq | None) -> bool:
    return high is None or t <= high


def _taylor(p: fmpq_poly, t: fmpq) -> list[fmpq]:
    return p(fmpq_poly([t, 1])).coeffs()


def _sign_after(p: fmpq_poly, t: fmpq) -> int:
    return next((_sign(c) for c in _taylor(p, t) if c != 0), 0)


def _sign_before(p: fmpq_poly, t: fmpq) -> int:
    return next((_sign(c) * (-1) ** k for k, c in enumerate(_taylor(p, t)) if c != 0), 0)


def _sign(value: fmpq) -> int:
    return int(value > 0) - int(value < 0)


def _inner(p: fmpq_poly, low: fmpq, high: fmpq | None) -> Iterator[Zero]:
    """The roots strictly between two numbers."""
    simple = p // p.gcd(p.derivative())
    for end in (low, high):
        if end is not None and simple(end) == 0:
            simple //= fmpq_poly([-end, 1])
    if simple.degree() < 1:
        return
    if high is None:
        lead = abs(simple.coeffs()[-1])
        high = low + 2 + max(abs(c) / lead for c in simple.coeffs()) + abs(low)
    chain = [simple, simple.derivative()]
    while chain[-1].degree() > 0:
        rest = -(chain[-2] % chain[-1])
        chain.append(rest / max(abs(c) for c in rest.coeffs()))
    waiting = [(low, high, _changes(chain, low) - _changes(chain, high))]
    while waiting:
        a, b, count = waiting.pop()
        if count == 0:
            continue
        if count == 1 and p(a) != 0 and p(b) != 0:
            yield _root(p, simple, a, b)
            continue
        middle = next(m for k in range(1, 99) if simple(m := a + (b - a) * fmpq(k, k + 1)) != 0)
        inside = _changes(chain, a) - _changes(chain, middle)
        waiting += [(a, middle, inside), (middle, b, count - inside)]


def _changes(chain: list[fmpq_poly], t: fmpq) -> int:
    signs = [s for s in (_sign(p(t)) for p in chain) if s]
    return sum(a != b for a, b in pairwise(signs))


def _root(p: fmpq_poly, simple: fmpq_poly, a: fmpq, b: fmpq) -> Zero:
    """The only root between two numbers, by bisection, and the side."""
    side = _sign(p(b)) - _sign(p(a))
    left = _sign(simple(a))
    while b - a > WIDTH * max(abs(a), abs(b)):
        middle = _short((a + b) / 2, b - a)
        sign = _sign(simple(middle))
        if sign == 0:
            a = b = middle
        elif sign == left:
            a = middle
        else:
            b = middle
    return (a + b) / 2, (side > 0) - (side < 0)


def _short(value: fmpq, width: fmpq) -> fmpq:
    """A number with few digits that is close to another, compared to a width."""
    bits = int(width.q).bit_length() - int(width.p).bit_length() + 3
    step = fmpq(2) ** -bits
    return fmpq((value / step).floor()) * step
