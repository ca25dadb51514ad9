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
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.rational import rational, to_fraction
from pas.algebra.rational_function import GENERATORS, ONE, RING
from pas.algebra.roots import in_one
from pas.arrays import Bools, Floats, Integers
from pas.bernstein.forms import UNIT_ROUNDOFF, rounded
from pas.bernstein.search import Fate, Fates, Limits, search
from pas.parametric.maps import Ends, ExactDomain
from pas.parametric.nets import PlacedNets, box_form
from pas.parametric.series import rounded_roots
from pas.verdicts import Status

HALF = Fraction(1, 2)
Place = tuple[fmpq, fmpq]

RENEWALS = 64
"""Rectangles that wait to be worked out afresh at most; each takes as long as some hundred halvings."""


@dataclass(frozen=True)
class ZeroSearch:
    """The result of one search; `place` is a common zero (`exact`), near one, or a place left open."""

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
class _Rectangles(PlacedNets):
    """C rectangles of a chart, and nets (C, n+1, m+1, k) of all polynomials on them."""

    chart: RationalChart

    def point(self, number: int, shares: Sequence[Any]) -> list[Fraction]:
        """Where shares of a rectangle's sides end, in the chart."""
        pairs = zip(self.start[number], self.steps[number].tolist(), shares, strict=True)
        return [(s + Fraction(share)) / (1 << n) for s, n, share in pairs]

    def place(self, number: int, shares: Sequence[Any] = (HALF, HALF)) -> Place | None:
        """The parameters there, by default in the middle."""
        u, v = self.point(number, shares)
        return self.chart.place(u, v)

    @property
    def imprecise(self) -> Bools:
        """Which have a polynomial whose coefficients may be off by much of their size."""
        greatest, share = np.abs(self.table).max(axis=(1, 2)), 2.0**-12
        return ((greatest > 0) & (self.off.max(axis=(1, 2))[:, None] > share * greatest)).any(axis=1)

    @property
    def axes(self) -> Integers:
        """The parameter along which the coefficients change more, or where none is, the other than at last."""
        changes = [np.abs(np.diff(self.table, axis=a)).max(axis=(1, 2, 3), initial=0.0) for a in (1, 2)]
        return np.where(changes[0] == changes[1], self.steps.sum(axis=1) % 2, changes[0] < changes[1])


def without_common_zero(polynomials: Sequence[fmpq_mpoly], chart: RationalChart, effort: int) -> ZeroSearch:
    """Whether the polynomials have no common zero on a rectangle; else a zero, or a place left open.

    `effort` bounds the rectangles that are looked at.
    """
    if effort <= 0:
        return ZeroSearch(Status.UNDECIDED)
    if all(p.is_zero() for p in polynomials):
        return ZeroSearch(Status.REFUTED, chart.place(HALF, HALF), True, 1)
    degrees = [max(int(p.degrees()[a]) for p in polynomials if not p.is_zero()) for a in (0, 1)]
    seeker = _Seeker(polynomials, degrees, effort)
    table, off = seeker.net(chart)
    whole = _Rectangles(table[None], off[None], np.array([[0, 0]], dtype=object), np.zeros((1, 2), int), chart)
    depth = 200  # halvings in all after which a rectangle counts as undecided: it is then 2^-100 wide each way
    found = search(whole, seeker.judge, seeker.split, Limits(depth, effort), "looking for common zeros")
    if len(found.refuted):
        return ZeroSearch(Status.REFUTED, seeker.zero, seeker.exact, seeker.cells)
    return ZeroSearch(found.status, found.open.place(0) if len(found.open) else None, False, seeker.cells)


@dataclass
class _Seeker:
    """The search for a zero, which judges and halves rectangles: `cells` were examined, `zero` is the one found."""

    polynomials: Sequence[fmpq_mpoly]
    degrees: list[int]
    effort: int
    cells: int = 0
    zero: Place | None = None
    exact: bool = True

    def net(self, chart: RationalChart) -> tuple[Floats, Floats]:
        """The net (n+1, m+1, k) of all polynomials on a chart, each scaled exactly to at most 1 and rounded once, and
        what it may be off by (n+1, m+1)."""
        tables = [box_form(_moved(p, chart, self.degrees), self.degrees) for p in self.polynomials]
        nets = [rounded([c for row in table for c in row]).reshape(len(table), -1) for table in tables]
        return np.stack(nets, axis=-1), np.full(nets[0].shape, UNIT_ROUNDOFF)

    def split(self, cells: _Rectangles) -> _Rectangles:
        """Both halves of all; what is imprecise is worked out afresh before."""
        table, off = cells.table.copy(), cells.off.copy()
        for number in np.flatnonzero(cells.imprecise).tolist():
            size = [Fraction(1, 1 << n) for n in cells.steps[number].tolist()]
            table[number], off[number] = self.net(cells.chart.part(cells.point(number, (0, 0)), size))
        return replace(cells, table=table, off=off).split(cells.axes)

    def judge(self, cells: _Rectangles, _: int) -> Fates:
        """Settled where there is no zero."""
        if self.cells + len(cells) > self.effort:
            return np.full(len(cells), int(Fate.WAIT))
        self.cells += len(cells)
        fates = np.where(avoids_origin(cells.table, cells.off.max(axis=(1, 2))), int(Fate.SETTLED), int(Fate.SPLIT))
        left = np.flatnonzero(fates)
        rest = cells.select(left)
        imprecise = np.flatnonzero(rest.imprecise)
        number = self._with_zero(rest, imprecise)
        if number is not None:
            fates[left[number]] = Fate.REFUTE
        elif len(imprecise) > RENEWALS:
            fates[left] = Fate.WAIT
        return fates

    def _with_zero(self, cells: _Rectangles, imprecise: Integers) -> int | None:
        """A rectangle with a zero: at a corner, where coefficients are values, by a change of sign, or near the middle
        of one that is to be worked out afresh."""
        ends, off = cells.table[:, [0, 0, -1, -1], [0, -1, 0, -1]], cells.off.max(axis=(1, 2))[:, None]
        for number, corner in np.argwhere(np.abs(ends).max(axis=2) <= off).tolist():
            place = cells.place(number, divmod(corner, 2))
            if place is not None and self._vanish(place):
                self.zero = place
                return int(number)
        values, signs = ends[:, :, 0], np.zeros(0, dtype=np.intp)
        if len(self.polynomials) == 1:
            signs = np.flatnonzero((values < -off).any(axis=1) & (values > off).any(axis=1))
        for number in signs.tolist():
            low, high = (cells.place(number, divmod(int(i(values[number])), 2)) for i in (np.argmin, np.argmax))
            if low is not None and high is not None:
                self._between(low, high, cells.chart)
                return int(number)
        return next((n for n in imprecise[:RENEWALS].tolist() if self._near(cells.place(n), cells.chart)), None)

    def _between(self, first: Place, last: Place, chart: RationalChart) -> None:
        """Find a zero between two places at which the only polynomial has values of different signs, to rounding."""
        along = [a + (b - a) * GENERATORS[0] for a, b in zip(first, last, strict=True)]
        line = in_one(self.polynomials[0].compose(*along, ctx=RING), 0)
        share = rational(rounded_roots(line, fmpq(0), fmpq(1))[0])
        place = first[0] + (last[0] - first[0]) * share, first[1] + (last[1] - first[1]) * share
        if not self._near(place, chart):
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


def avoids_origin(nets: Floats, off: Floats) -> Bools:
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
