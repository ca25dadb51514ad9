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
from pas.bernstein.search import Cells, Fate, Fates, Limits, search
from pas.mesh.rows import Integers
from pas.parametric.domain import Ends, ExactDomain
from pas.parametric.nets import Nets
from pas.verdicts import Status

HALF = Fraction(1, 2)
Place = tuple[fmpq, fmpq]

HALVINGS, WORN = 40, 2.0**-12
"""Coefficients are worked out afresh after so many halvings, or where they are off by this share of a polynomial's."""

DEPTH = 200
"""Halvings in all after which a rectangle counts as undecided: it is then 2^-100 wide each way."""

RENEWALS = 64
"""Rectangles that wait to be worked out afresh at most; each takes as long as some hundred halvings."""


@dataclass(frozen=True)
class ZeroSearch:
    """What came of one search; `place` is a common zero (`exact`), near one, or a place left open."""

    status: Status
    place: Place | None = None
    exact: bool = False
    cells: int = 0


@dataclass(frozen=True)
class RationalChart:
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

    def part(self, corner: Sequence[Fraction], size: Sequence[Fraction]) -> RationalChart:
        """The rectangle at a corner (u, v), of a size, as one of its own."""
        first, second = (
            (a * width, a * start + b, c * width, c * start + d)
            for (a, b, c, d), start, width in zip(self.maps, map(rational, corner), map(rational, size), strict=True)
        )
        return RationalChart((first, second))


UNIT_SQUARE = RationalChart(((fmpq(1), fmpq(0), fmpq(0), fmpq(1)),) * 2)


def charts_of(domain: ExactDomain) -> list[RationalChart]:
    """Rectangles that cover a domain together."""
    return [RationalChart((first, second)) for first, second in product(*map(_maps, domain))]


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
class _Rectangles(Cells):
    """C rectangles of a chart: lower corners `start` / 2^`steps` (C, 2), and nets of all polynomials on them.

    `table` (C, n+1, m+1, k) and `off` (C,) are those of `Nets`, `steps` (C, 2) the halvings so far.
    """

    chart: RationalChart
    table: Floats
    off: Floats
    start: Integers
    steps: Integers

    def point(self, number: int, shares: Sequence[Any]) -> list[Fraction]:
        """Where shares of a rectangle's sides end, in the chart."""
        pairs = zip(self.start[number].tolist(), self.steps[number].tolist(), shares, strict=True)
        return [(s + Fraction(share)) / (1 << n) for s, n, share in pairs]

    def place(self, number: int, shares: Sequence[Any] = (HALF, HALF)) -> Place | None:
        """The parameters there, by default in the middle."""
        u, v = self.point(number, shares)
        return self.chart.place(u, v)

    def halves(self) -> _Rectangles:
        """Both halves of all, across the parameter along which the coefficients change more."""
        changes = [np.abs(np.diff(self.table, axis=a)).max(axis=(1, 2, 3), initial=0.0) for a in (1, 2)]
        across = np.where(changes[0] == changes[1], self.steps.sum(axis=1) % 2, changes[0] < changes[1])
        if across.min() == across.max():
            return self._halved(int(across[0]))
        return self.select(across == 0)._halved(0).joined([self.select(across == 1)._halved(1)])

    def _halved(self, axis: int) -> _Rectangles:
        nets = Nets(self.table, self.off).halves(axis)
        step = np.arange(2) == axis
        start = self.start * (1 + step)
        starts, steps = np.concatenate([start, start + step]), np.concatenate([self.steps + step] * 2)
        return _Rectangles(self.chart, nets.table, nets.off, starts, steps)


def without_common_zero(polynomials: Sequence[fmpq_mpoly], chart: RationalChart, effort: int) -> ZeroSearch:
    """Whether the polynomials have no common zero on a rectangle; else a zero, or a place left open.

    `effort` bounds the rectangles that are looked at.
    """
    if effort <= 0:
        return ZeroSearch(Status.UNDECIDED)
    if all(p.is_zero() for p in polynomials):
        return ZeroSearch(Status.REFUTED, chart.place(HALF, HALF), True, 1)
    degrees = [max(int(p.degrees()[a]) for p in polynomials if not p.is_zero()) for a in (0, 1)]
    seeker, pending = _Seeker(polynomials, degrees, effort), [(chart, 0)]
    while pending:
        part, depth = pending.pop(0)
        if depth >= DEPTH or len(pending) > RENEWALS:
            return ZeroSearch(Status.UNDECIDED, part.place(HALF, HALF), False, seeker.cells)
        whole = seeker.whole(part)
        if avoids_origin(whole.table, whole.off)[0]:  # mostly, and then sooner than by a search
            seeker.cells += 1
            continue
        found = search(whole, seeker.judge, _Rectangles.halves, Limits(HALVINGS, effort), "looking for common zeros")
        if len(found.refuted):
            return ZeroSearch(Status.REFUTED, seeker.zero, seeker.exact, seeker.cells)
        if len(found.open):
            return ZeroSearch(Status.UNDECIDED, found.open.place(0), False, seeker.cells)
        for number in range(len(found.kept)):
            steps = found.kept.steps[number].tolist()
            corner, size = found.kept.point(number, (0, 0)), [Fraction(1, 1 << n) for n in steps]
            pending.append((part.part(corner, size), depth + sum(steps)))
    return ZeroSearch(Status.PROVED, cells=seeker.cells)


@dataclass
class _Seeker:
    """Judges rectangles for common zeros of polynomials of at most these degrees, and counts them.

    `zero` is one, or near one where it is not `exact`.
    """

    polynomials: Sequence[fmpq_mpoly]
    degrees: list[int]
    effort: int
    cells: int = 0
    zero: Place | None = None
    exact: bool = True

    def whole(self, chart: RationalChart) -> _Rectangles:
        """A whole chart, coefficients of each polynomial over its greatest, rounded."""
        tables = [box_form(_moved(p, chart, self.degrees), self.degrees) for p in self.polynomials]
        nets = [rounded([c for row in table for c in row]).reshape(len(table), -1) for table in tables]
        none = np.zeros((1, 2), dtype=np.intp)
        return _Rectangles(chart, np.stack(nets, axis=-1)[None], np.array([UNIT_ROUNDOFF]), none, none)

    def judge(self, cells: _Rectangles, depth: int) -> Fates:
        """Settled where there is no zero; kept where coefficients are to be worked out afresh."""
        if self.cells + len(cells) > self.effort:
            return np.full(len(cells), int(Fate.WAIT))
        self.cells += len(cells)
        fates = np.where(avoids_origin(cells.table, cells.off), int(Fate.SETTLED), int(Fate.SPLIT))
        if not fates.any():
            return fates
        greatest, off = np.abs(cells.table).max(axis=(1, 2)), cells.off[:, None]
        worn = ((greatest > 0) & (off > WORN * greatest)).any(axis=1) | (depth == HALVINGS)
        fates[worn & (fates == Fate.SPLIT)] = Fate.KEEP
        number = self._with_zero(cells, fates)
        if number is not None:
            fates[number] = Fate.REFUTE
        return fates

    def _with_zero(self, cells: _Rectangles, fates: Fates) -> int | None:
        """A rectangle with a zero: at a corner, where coefficients are values, by a change of sign, or near the middle
        of one that is worked out afresh."""
        ends, off = cells.table[:, [0, 0, -1, -1], [0, -1, 0, -1]], cells.off[:, None]
        values = ends[:, :, 0]
        flat = (np.abs(ends).max(axis=2) <= off) & (fates != Fate.SETTLED)[:, None]
        for number, corner in zip(*(a.tolist() for a in np.nonzero(flat)), strict=True):
            place = cells.place(number, divmod(corner, 2))
            if place is not None and self._vanish(place):
                self.zero = place
                return int(number)
        signs = np.zeros(0, dtype=np.intp)
        if len(self.polynomials) == 1:
            signs = np.flatnonzero((values < -off).any(axis=1) & (values > off).any(axis=1))
        for number in signs.tolist():
            corners = [divmod(int(i), 2) for i in (values[number].argmin(), values[number].argmax())]
            if all(cells.place(number, corner) is not None for corner in corners):
                self._bisect(cells.chart, *(cells.point(number, corner) for corner in corners))
                return int(number)
        kept = np.flatnonzero(fates == Fate.KEEP)[:RENEWALS].tolist()
        return next((number for number in kept if self._near(cells.place(number), cells.chart)), None)

    def _bisect(self, chart: RationalChart, negative: list[Fraction], positive: list[Fraction]) -> None:
        """Find a zero between two finite points at which the only polynomial has values of both signs, to 1e-9."""
        for _ in range(30):
            u, v = ((a + b) / 2 for a, b in zip(negative, positive, strict=True))
            place = chart.place(u, v)
            assert place is not None
            if self._near(place, chart):
                return
            negative, positive = ([u, v], positive) if self.polynomials[0](*place) < 0 else (negative, [u, v])
        self.zero, self.exact = place, False

    def _near(self, place: Place | None, chart: RationalChart) -> bool:
        """Whether the simplest point near a place is a common zero in a chart."""
        if place is None:
            return False
        t, h = (rational(to_fraction(x).limit_denominator(1000)) for x in place)
        if not (chart.holds((t, h)) and self._vanish((t, h))):
            return False
        self.zero = t, h
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


def _moved(polynomial: fmpq_mpoly, chart: RationalChart, degrees: list[int]) -> fmpq_mpoly:
    """The numerator of the polynomial after the maps, as one of the degrees given."""
    powers = []
    for generator, (a, b, c, d), degree in zip(GENERATORS, chart.maps, degrees, strict=True):
        above, below = a * generator + b, c * generator + d
        powers.append([above**e * below ** (degree - e) for e in range(degree + 1)])
    rows: dict[int, Any] = {}
    for (i, j), coefficient in polynomial.to_dict().items():
        rows[int(i)] = rows.get(int(i), ONE * 0) + powers[1][int(j)] * coefficient
    return sum((row * powers[0][i] for i, row in rows.items()), ONE * 0)
