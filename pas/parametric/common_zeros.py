"""Whether polynomials in two parameters vanish together somewhere in a rectangle, by Bernstein branch and bound.

On a rectangle a polynomial lies in the convex hull of its Bernstein coefficients (Farin 2002, chapter 6); so does a
vector of them, and if the hull of the coefficient vectors has positive scalar products with one direction, it avoids
the origin.  Rectangles where this fails are halved.  A side at infinity is brought to [0, 1] by t -> 1/t.

PROVED: no common zero.  REFUTED: an exact point where all vanish, or for one polynomial exact values of both signs
around a small rectangle.  UNDECIDED: the effort ran out.

Rounding: the coefficients of each polynomial are scaled exactly to at most 1 (its zeros stay) and rounded once; each
halving averages neighbours, so after m halvings every coefficient errs by at most (2 + m (n+1)) 2^-53, n the degree
halved (Higham 2002, section 3.1), and comparisons are made against eight times that.  A rectangle that has been
halved RENEWED times, or whose coefficients have become small, gets them afresh: exact, scaled anew and rounded once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from flint import fmpq, fmpq_mpoly

from pas.algebra.monomials import Floats
from pas.algebra.rational import rational, to_fraction
from pas.algebra.rational_function import GENERATORS, ONE
from pas.bernstein.boxes import box_form
from pas.bernstein.forms import UNIT_ROUNDOFF, rounded
from pas.bernstein.subdivision import halves
from pas.limits import checkpoint
from pas.parametric.domain import Ends, ExactDomain
from pas.verdicts import Status

LOCATED = 24
"""Halvings after which a change of sign is reported: the place is then known to about 1 in 4000."""

RENEWED = 40
"""Halvings after which coefficients are worked out afresh: their error is then some 1e-13."""

WORN = 2.0**-24
"""Coefficients below this, whose error is some 1e-14, are worked out afresh as well."""

DEPTH = 200
"""Halvings in all after which a rectangle counts as undecided: it is then 2^-100 wide each way."""

RENEWALS = 64
"""Rectangles that are worked out afresh at most in one round; each takes as long as some hundred halvings."""

SHORT = 1000
"""Greatest denominator of the point near an open rectangle that is tried as an exact zero."""

HALF = Fraction(1, 2)
Place = tuple[fmpq, fmpq]


@dataclass(frozen=True)
class Outcome:
    """What came of one search; `place` is a common zero (`exact`), near one, or a place left open."""

    status: Status
    place: Place | None = None
    exact: bool = False
    cells: int = 0


@dataclass(frozen=True)
class Piece:
    """A rectangle of the domain, seen from [0, 1]^2 by t = f(u), h = g(v); each map is (a u + b) / (c u + d)."""

    maps: tuple[tuple[fmpq, ...], tuple[fmpq, ...]]

    def place(self, u: Fraction, v: Fraction) -> Place | None:
        """The exact parameters of a point; None at infinity."""
        found = []
        for (a, b, c, d), w in zip(self.maps, (u, v), strict=True):
            x = rational(w)
            below = c * x + d
            if below == 0:
                return None
            found.append((a * x + b) / below)
        return found[0], found[1]

    def holds(self, place: Place) -> bool:
        """Whether a point lies on the piece."""
        for (a, b, c, d), x in zip(self.maps, place, strict=True):
            across = a - c * x  # the inverse is (d x - b) / (a - c x)
            if across == 0 or not 0 <= (d * x - b) / across <= 1:
                return False
        return True

    def part(self, corner: tuple[Fraction, Fraction], size: tuple[Fraction, Fraction]) -> Piece:
        """The rectangle at a corner (u, v), of a size, as a piece of its own."""
        parts = []
        for (a, b, c, d), start, width in zip(self.maps, map(rational, corner), map(rational, size), strict=True):
            parts.append((a * width, a * start + b, c * width, c * start + d))
        return Piece((parts[0], parts[1]))


UNIT_SQUARE = Piece(((fmpq(1), fmpq(0), fmpq(0), fmpq(1)),) * 2)


def pieces_of(domain: ExactDomain) -> list[Piece]:
    """Pieces that cover a domain together."""
    return [Piece((first, second)) for first, second in product(*map(_maps, domain))]


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
class _Cell:
    """A rectangle of a piece, halved so often since its piece's coefficients were rounded, and in all."""

    piece: Piece
    net: Floats
    corner: tuple[Fraction, Fraction]
    size: tuple[Fraction, Fraction]
    halvings: int
    depth: int

    @property
    def middle(self) -> Place | None:
        u, v = (c + s / 2 for c, s in zip(self.corner, self.size, strict=True))
        return self.piece.place(u, v)

    @property
    def is_worn(self) -> bool:
        """Whether the coefficients of a polynomial have become small next to what they were when they were rounded."""
        greatest = np.abs(self.net).max(axis=(0, 1))
        return bool(((greatest > 0) & (greatest < WORN)).any())

    def halves(self) -> list[_Cell]:
        """Both halves across the parameter along which the coefficients change more."""
        steps = [float(np.abs(np.diff(self.net, axis=axis)).max(initial=0.0)) for axis in (0, 1)]
        axis = 0 if steps[0] > steps[1] or (steps[0] == steps[1] and self.depth % 2 == 0) else 1
        left, right = halves(self.net, axis)
        size, moved = list(self.size), list(self.corner)
        size[axis] /= 2
        moved[axis] += size[axis]
        counts = self.halvings + 1, self.depth + 1
        return [
            _Cell(self.piece, net, (corner[0], corner[1]), (size[0], size[1]), *counts)
            for net, corner in ((right, moved), (left, self.corner))
        ]


def without_common_zero(polynomials: Sequence[fmpq_mpoly], piece: Piece, effort: int) -> Outcome:
    """Whether the polynomials have no common zero on a piece; else a zero, or a place left open."""
    if effort <= 0:
        return Outcome(Status.UNDECIDED)
    if all(p.is_zero() for p in polynomials):
        return Outcome(Status.REFUTED, piece.place(HALF, HALF), True, 1)
    search = _Search(polynomials, [max(int(p.degrees()[a]) for p in polynomials if not p.is_zero()) for a in (0, 1)])
    pending = [search.fresh(piece, 0)]
    while pending:  # all rectangles are looked at before any is worked out afresh: zeros are mostly found before
        found, open_cells = search.through(pending, effort)
        if found is not None:
            return found
        for cell in open_cells:
            zero = search.simple_zero(cell)
            if zero is not None:
                return Outcome(Status.REFUTED, zero, True, search.cells)
        spent = search.cells >= effort or len(open_cells) > RENEWALS
        if open_cells and (spent or any(cell.depth >= DEPTH for cell in open_cells)):
            return Outcome(Status.UNDECIDED, open_cells[0].middle, False, search.cells)
        pending = [search.fresh(cell.piece.part(cell.corner, cell.size), cell.depth) for cell in open_cells]
    return Outcome(Status.PROVED, cells=search.cells)


@dataclass
class _Search:
    """A search for common zeros of polynomials of at most these degrees; counts the cells that were looked at."""

    polynomials: Sequence[fmpq_mpoly]
    degrees: list[int]
    cells: int = 0

    def through(self, pending: list[_Cell], effort: int) -> tuple[Outcome | None, list[_Cell]]:
        """A zero in some cells, if one is met, and what is open and to be renewed, or is when the effort is spent."""
        left: list[_Cell] = []
        while pending:
            if self.cells >= effort:
                return None, [*left, *pending]
            cell = pending.pop()
            self.cells += 1
            if self.cells % 256 == 0:
                checkpoint("looking for common zeros")
            error = _rounding(cell.halvings, self.degrees)
            if _avoids_origin(cell.net, error):
                continue
            zero = self._exact_zero(cell, error)
            if zero is not None:
                return Outcome(Status.REFUTED, zero, True, self.cells), left
            located = cell.depth >= LOCATED and cell.depth % 8 == 0
            if located and len(self.polynomials) == 1 and _changes_sign(self.polynomials[0], cell):
                return Outcome(Status.REFUTED, cell.middle, False, self.cells), left
            if cell.halvings < RENEWED and not cell.is_worn:
                pending += cell.halves()
                continue
            left.append(cell)
            if len(left) > RENEWALS:
                break
        return None, left

    def fresh(self, piece: Piece, depth: int) -> _Cell:
        """A whole piece with coefficients (n+1, m+1, k), those of each polynomial over the greatest, rounded."""
        tables = [box_form(_moved(p, piece, self.degrees), self.degrees) for p in self.polynomials]
        nets = [rounded([c for row in table for c in row]).reshape(len(table), -1) for table in tables]
        whole = (Fraction(0), Fraction(0)), (Fraction(1), Fraction(1))
        return _Cell(piece, np.stack(nets, axis=-1), *whole, 0, depth)

    def simple_zero(self, cell: _Cell) -> Place | None:
        """The simplest point near the middle of a cell, where it is a common zero in the cell's piece."""
        middle = cell.middle
        if middle is None:
            return None
        t, h = (rational(to_fraction(x).limit_denominator(SHORT)) for x in middle)
        return (t, h) if cell.piece.holds((t, h)) and self._vanish((t, h)) else None

    def _vanish(self, place: Place) -> bool:
        return all(p(*place) == 0 for p in self.polynomials)

    def _exact_zero(self, cell: _Cell, error: float) -> Place | None:
        """A corner of a cell where all polynomials are zero; its coefficients are the values there."""
        for i, j in product((0, 1), repeat=2):
            if float(np.abs(cell.net[-i, -j]).max()) <= error:
                u, v = (c + k * s for c, s, k in zip(cell.corner, cell.size, (i, j), strict=True))
                place = cell.piece.place(u, v)
                if place is not None and self._vanish(place):
                    return place
        return None


def _avoids_origin(net: Floats, error: float) -> bool:
    """Whether one direction has positive scalar products with all coefficient vectors, beyond rounding."""
    vectors = net.reshape(-1, net.shape[-1])
    for direction in (vectors.mean(axis=0), *np.eye(vectors.shape[1]), *-np.eye(vectors.shape[1])):
        length = float(np.abs(direction).sum())
        if length > 0 and float((vectors @ direction).min()) > error * length:
            return True
    return False


def _changes_sign(polynomial: fmpq_mpoly, cell: _Cell) -> bool:
    """Whether a polynomial has exact values of both signs around a cell, so that it vanishes near."""
    signs = set()
    rows = [[max(c - s, Fraction(0)), min(c + 2 * s, Fraction(1))] for c, s in zip(cell.corner, cell.size, strict=True)]
    for point in product(*rows):
        place = cell.piece.place(*point)
        if place is not None:
            value = polynomial(*place)
            signs.add((value > 0) - (value < 0))
    return {1, -1} <= signs


def _rounding(halvings: int, degrees: list[int]) -> float:
    return 8 * (2 + halvings * (max(degrees) + 1)) * UNIT_ROUNDOFF


def _moved(polynomial: fmpq_mpoly, piece: Piece, degrees: list[int]) -> fmpq_mpoly:
    """The numerator of the polynomial after the maps, as one of the degrees given."""
    powers = []
    for generator, (a, b, c, d), degree in zip(GENERATORS, piece.maps, degrees, strict=True):
        above, below = a * generator + b, c * generator + d
        powers.append([above**e * below ** (degree - e) for e in range(degree + 1)])
    result = ONE * 0
    rows: dict[int, Any] = {}
    for (i, j), coefficient in polynomial.to_dict().items():
        rows[int(i)] = rows.get(int(i), ONE * 0) + powers[1][int(j)] * coefficient
    for i, row in rows.items():
        result = result + row * powers[0][i]
    return result
