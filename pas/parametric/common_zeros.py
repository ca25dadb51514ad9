"""Whether polynomials in two parameters vanish together somewhere in a rectangle, by Bernstein branch and bound.

On a rectangle a polynomial lies in the convex hull of its Bernstein coefficients (Farin 2002, chapter 6); so does a
vector of them, and if the hull of the coefficient vectors has positive scalar products with one direction, it avoids
the origin.  Rectangles where this fails are halved.  A side at infinity is brought to [0, 1] by t -> 1/t.

PROVED: no common zero.  REFUTED: an exact point where all vanish, or for one polynomial values of both signs at two
corners of a rectangle, beyond rounding.  UNDECIDED: the effort ran out.

Rounding: the coefficients of each polynomial are scaled exactly to at most 1 (its zeros stay) and rounded once; what
halving adds is counted by `Nets`.  A rectangle whose coefficients have become small next to their rounding gets them
afresh: exact, scaled anew and rounded once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mpoly
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.algebra.rational import rational, to_fraction
from pas.algebra.rational_function import GENERATORS, ONE
from pas.bernstein.boxes import box_form
from pas.bernstein.forms import UNIT_ROUNDOFF, rounded
from pas.limits import checkpoint
from pas.mesh.field import Integers
from pas.parametric.domain import Ends, ExactDomain
from pas.parametric.nets import Nets
from pas.verdicts import Status

HALF = Fraction(1, 2)
Place = tuple[fmpq, fmpq]

HALVINGS, WORN = 40, 2.0**-27
"""Coefficients are worked out afresh after so many halvings, or where they are off by this share of a polynomial's."""

DEPTH = 200
"""Halvings in all after which a rectangle counts as undecided: it is then 2^-100 wide each way."""

RENEWALS = 64
"""Rectangles that wait to be worked out afresh at most; each takes as long as some hundred halvings."""

SHORT = 1000
"""Greatest denominator of the point near an open rectangle that is tried as an exact zero."""

BISECTIONS = 30
"""Of the segment on which a polynomial changes its sign: the zero is then known to 1e-9 of it."""


@dataclass(frozen=True)
class ZeroSearch:
    """What came of one search; `place` is a common zero (`exact`), near one, or a place left open."""

    status: Status
    place: Place | None = None
    exact: bool = False
    cells: int = 0


@dataclass(frozen=True)
class Chart:
    """A rectangle of the domain, seen from [0, 1]^2 by t = f(u), h = g(v); each map is (a u + b) / (c u + d)."""

    maps: tuple[tuple[fmpq, ...], tuple[fmpq, ...]]

    def place(self, u: Fraction, v: Fraction) -> Place | None:
        """The exact parameters of a point; None at infinity."""
        found = []
        for (a, b, c, d), w in zip(self.maps, (rational(u), rational(v)), strict=True):
            if c * w + d == 0:
                return None
            found.append((a * w + b) / (c * w + d))
        return found[0], found[1]

    def holds(self, place: Place) -> bool:
        """Whether a point lies in the rectangle."""
        for (a, b, c, d), x in zip(self.maps, place, strict=True):
            across = a - c * x  # the inverse is (d x - b) / (a - c x)
            if across == 0 or not 0 <= (d * x - b) / across <= 1:
                return False
        return True

    def part(self, corner: Sequence[Fraction], size: Sequence[Fraction]) -> Chart:
        """The rectangle at a corner (u, v), of a size, as one of its own."""
        first, second = (
            (a * width, a * start + b, c * width, c * start + d)
            for (a, b, c, d), start, width in zip(self.maps, map(rational, corner), map(rational, size), strict=True)
        )
        return Chart((first, second))


UNIT_SQUARE = Chart(((fmpq(1), fmpq(0), fmpq(0), fmpq(1)),) * 2)


def charts_of(domain: ExactDomain) -> list[Chart]:
    """Rectangles that cover a domain together."""
    return [Chart((first, second)) for first, second in product(*map(_maps, domain))]


def _maps(interval: Ends) -> list[tuple[fmpq, ...]]:
    """Maps of [0, 1] that cover an interval together."""
    zero, one = fmpq(0), fmpq(1)
    low, high = (None if end is None else rational(end) for end in interval)
    if low is not None and high is not None:
        return [(high - low, low, zero, one)]
    if low is not None:
        return [(one, low, zero, one), (low, one, one, zero)]
    if high is not None:
        return [(-one, high, zero, one), (high, -one, one, zero)]
    return [(fmpq(2), -one, zero, one), (zero, one, one, zero), (zero, -one, one, zero)]


@dataclass(frozen=True)
class _Cells:
    """C rectangles of a chart, nets of all polynomials on them: lower corners `start` / 2^`steps`, `steps` halvings."""

    chart: Chart
    nets: Nets
    start: Integers
    steps: Integers

    def __len__(self) -> int:
        return len(self.start)

    def part(self, chosen: Any) -> _Cells:
        return _Cells(self.chart, self.nets.part(chosen), self.start[chosen], self.steps[chosen])

    def point(self, number: int, shares: Sequence[Any]) -> list[Fraction]:
        """Where shares of a rectangle's sides end, in the chart."""
        pairs = zip(self.start[number].tolist(), self.steps[number].tolist(), shares, strict=True)
        return [(s + Fraction(share)) / (1 << n) for s, n, share in pairs]

    def place(self, number: int, shares: Sequence[Any] = (HALF, HALF)) -> Place | None:
        """The parameters there, by default in the middle."""
        u, v = self.point(number, shares)
        return self.chart.place(u, v)

    def halves(self) -> _Cells:
        """Both halves of all, across the parameter along which the coefficients change more."""
        changes = [np.abs(np.diff(self.nets.table, axis=a)).max(axis=(1, 2, 3), initial=0.0) for a in (1, 2)]
        across = np.where(changes[0] == changes[1], self.steps.sum(axis=1) % 2, changes[0] < changes[1])
        parts = []
        for axis in sorted(set(across.tolist())):
            cells = self.part(across == axis)
            start, steps = np.concatenate([cells.start] * 2), np.concatenate([cells.steps] * 2)
            steps[:, axis] += 1
            start[:, axis] *= 2
            start[len(cells) :, axis] += 1
            nets = cells.nets.halves(axis)
            parts.append((nets.table, nets.off, start, steps))
        table, off, start, steps = (np.concatenate(pair) for pair in zip(*parts, strict=True))
        return _Cells(self.chart, Nets(table, off), start, steps)


def without_common_zero(polynomials: Sequence[fmpq_mpoly], chart: Chart, effort: int) -> ZeroSearch:
    """Whether the polynomials have no common zero on a rectangle; else a zero, or a place left open.

    `effort` bounds the rectangles that are looked at.
    """
    if effort <= 0:
        return ZeroSearch(Status.UNDECIDED)
    if all(p.is_zero() for p in polynomials):
        return ZeroSearch(Status.REFUTED, chart.place(HALF, HALF), True, 1)
    degrees = [max(int(p.degrees()[a]) for p in polynomials if not p.is_zero()) for a in (0, 1)]
    search = _Search(polynomials, degrees, effort)
    pending = [(chart, 0)]
    while pending and search.found is None:
        part, depth = pending.pop()
        if depth >= DEPTH or len(pending) > RENEWALS:
            return ZeroSearch(Status.UNDECIDED, part.place(HALF, HALF), False, search.cells)
        pending += search.look(part, depth)
    return search.found or ZeroSearch(Status.PROVED, cells=search.cells)


@dataclass
class _Search:
    """A search for common zeros of polynomials of at most these degrees; counts the cells that were looked at."""

    polynomials: Sequence[fmpq_mpoly]
    degrees: list[int]
    effort: int
    cells: int = 0
    found: ZeroSearch | None = None

    def look(self, chart: Chart, depth: int) -> list[tuple[Chart, int]]:
        """Halve a chart, reached by so many halvings, until what is open is to be worked out afresh: returned."""
        cells, left = self._whole(chart), list[tuple[Chart, int]]()
        for halvings in range(HALVINGS + 1):
            checkpoint("looking for common zeros")
            if self.cells + len(cells) > self.effort:
                self.found = ZeroSearch(Status.UNDECIDED, cells.place(0), False, self.cells)
                return []
            self.cells += len(cells)
            cells = cells.part(~avoids_origin(cells.nets.table, cells.nets.off))
            greatest, off = np.abs(cells.nets.table).max(axis=(1, 2)), cells.nets.off[:, None]
            worn = ((greatest > 0) & (off > WORN * greatest)).any(axis=1) | (halvings == HALVINGS)
            open_ones = np.flatnonzero(worn).tolist()
            middles = (cells.place(number) for number in open_ones[:RENEWALS])
            if self._finds_zero(cells) or any(self._near(place, chart) for place in middles):
                return []
            for number in open_ones:
                size = [Fraction(1, 1 << n) for n in cells.steps[number].tolist()]
                left.append((chart.part(cells.point(number, (0, 0)), size), depth + halvings))
            cells = cells.part(~worn)
            if not len(cells):
                break
            cells = cells.halves()
        return left

    def _whole(self, chart: Chart) -> _Cells:
        """A whole chart with coefficients (1, n+1, m+1, k), those of each polynomial over the greatest, rounded."""
        tables = [box_form(_moved(p, chart, self.degrees), self.degrees) for p in self.polynomials]
        nets = [rounded([c for row in table for c in row]).reshape(len(table), -1) for table in tables]
        none = np.zeros((1, 2), dtype=np.intp)
        return _Cells(chart, Nets(np.stack(nets, axis=-1)[None], np.array([UNIT_ROUNDOFF])), none, none)

    def _finds_zero(self, cells: _Cells) -> bool:
        """Whether all polynomials vanish at a corner, where coefficients are values, or the only one changes sign."""
        ends, off = cells.nets.table[:, [0, 0, -1, -1], [0, -1, 0, -1]], cells.nets.off[:, None]
        for number, corner in zip(*np.nonzero(np.abs(ends).max(axis=2) <= off), strict=True):
            place = cells.place(number, divmod(int(corner), 2))
            if place is not None and self._vanish(place):
                self.found = ZeroSearch(Status.REFUTED, place, True, self.cells)
                return True
        if len(self.polynomials) > 1:
            return False
        values = ends[:, :, 0]
        for number in np.flatnonzero((values < -off).any(axis=1) & (values > off).any(axis=1)).tolist():
            corners = [divmod(int(i), 2) for i in (values[number].argmin(), values[number].argmax())]
            if all(cells.place(number, corner) is not None for corner in corners):
                self._bisect(cells.chart, *(cells.point(number, corner) for corner in corners))
                return True
        return False

    def _bisect(self, chart: Chart, negative: list[Fraction], positive: list[Fraction]) -> None:
        """Find a zero between two finite points at which the only polynomial has values of both signs."""
        place: Place | None = None
        for _ in range(BISECTIONS):
            u, v = ((a + b) / 2 for a, b in zip(negative, positive, strict=True))
            place = chart.place(u, v)
            assert place is not None
            if self._near(place, chart):
                return
            negative, positive = ([u, v], positive) if self.polynomials[0](*place) < 0 else (negative, [u, v])
        self.found = ZeroSearch(Status.REFUTED, place, False, self.cells)

    def _near(self, place: Place | None, chart: Chart) -> bool:
        """Whether the simplest point near a place is a common zero in a chart."""
        if place is None:
            return False
        t, h = (rational(to_fraction(x).limit_denominator(SHORT)) for x in place)
        if not (chart.holds((t, h)) and self._vanish((t, h))):
            return False
        self.found = ZeroSearch(Status.REFUTED, (t, h), True, self.cells)
        return True

    def _vanish(self, place: Place) -> bool:
        return all(p(*place) == 0 for p in self.polynomials)


def avoids_origin(nets: Floats, off: Floats) -> NDArray[np.bool_]:
    """For which of nets (C, n+1, m+1, k) one direction has positive scalar products with all vectors, beyond `off`."""
    vectors = nets.reshape(len(nets), -1, nets.shape[-1])
    clear = ((vectors.min(axis=1) > off[:, None]) | (vectors.max(axis=1) < -off[:, None])).any(axis=1)
    direction = vectors.mean(axis=1)
    length = np.abs(direction).sum(axis=1)
    least = np.einsum("cpk,ck->cp", vectors, direction).min(axis=1)
    return np.asarray(clear | ((length > 0) & (least > 8 * off * length)))  # the rest is for the sums' own rounding


def _moved(polynomial: fmpq_mpoly, chart: Chart, degrees: list[int]) -> fmpq_mpoly:
    """The numerator of the polynomial after the maps, as one of the degrees given."""
    powers = []
    for generator, (a, b, c, d), degree in zip(GENERATORS, chart.maps, degrees, strict=True):
        above, below = a * generator + b, c * generator + d
        powers.append([above**e * below ** (degree - e) for e in range(degree + 1)])
    rows: dict[int, Any] = {}
    for (i, j), coefficient in polynomial.to_dict().items():
        rows[int(i)] = rows.get(int(i), ONE * 0) + powers[1][int(j)] * coefficient
    return sum((row * powers[0][i] for i, row in rows.items()), ONE * 0)
