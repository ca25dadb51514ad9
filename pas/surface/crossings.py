"""Where rays cross a piecewise surface: all crossings in order, none missed and none invented.

What is counted: the numbers of the ray, of the region's corners and of the polynomials are taken as they are, exactly.
A crossing is a t >= 0 for which `origin + t direction` is in a closed cell whose polynomial is 0 there; where a whole
stretch of the ray is such, its start.  (Of cells that share a face in which the ray runs the first counts, should their
polynomials differ there.)  So rays that pass the region or the surface within rounding do not cross it, and
rays from a point that is on the surface only within rounding cross it there or not as these numbers have it.

In each cell the surface along a ray is a polynomial in one variable.  Its Bernstein form on the longest stretch on
which the ray may be in the cell (see `pas.surface.ray_cells`) is worked out with a bound on its rounding error and
halved until each part certainly has no root, or is certainly monotone and so has at most one (Lane and Riesenfeld
1981), which is then found by Newton's method within its bracket.  Near the ends, where it is not certain that the ray
is in the cell, there must certainly be no root; so the roots of all cells are crossings, and different ones.  Rays on
which doubles cannot decide that (tangent to the surface within rounding, or crossing it on the face of a cell or at the
origin) are worked out exactly (see `pas.surface.exact_crossings`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.bernstein.subdivision import halving
from pas.limits import checkpoint
from pas.surface.exact_crossings import exact_crossings
from pas.surface.kernels import compiled
from pas.surface.ray_cells import Bools, LocalRays, Rows
from pas.surface.ray_forms import Segments, bernstein_values, forms_on, joined, segments_of

if TYPE_CHECKING:
    from pas.surface.evaluator import Evaluator

BLOCK = 1 << 13
"""Rays that are worked on at once."""


DEEPEST = 40
"""Halvings of a segment, after which it is left to exact work."""

UNDECIDED = 4.0
"""Parts whose coefficients are all below so many error bounds are left to exact work: halving does not help them."""

STEPS, CLOSE = 60, 1e-11
"""Of Newton's method, or of bisection where that fails, and the last step over the part of the segment: the number of
right digits doubles with each step, and another step follows on the polynomial itself."""

Found = tuple[Rows, Floats, Rows]
"""Numbers of rays, parameters in units of `LocalRays`, and sides (M,) each."""


@dataclass(frozen=True)
class Crossings:
    """Crossings of `number` rays with a surface, by ray and along each ray in order.

    `rays` (M,) are the numbers of their rays, `parameters` (M,) the t of `origin + t direction`, `points` (M, 3)
    where that is; `sides` (M,) are 1 where the ray goes out (the value rises), -1 where it goes in, and 0 where it
    touches the surface from one side, and at the start of a stretch that lies in it.  Counts and sides are exact (for
    what is counted see `Evaluator.rays`); parameters are right to rounding, and infinite beyond the range of doubles.
    """

    rays: Rows
    parameters: Floats
    points: Floats
    sides: NDArray[np.int8]
    number: int

    @cached_property
    def counts(self) -> Rows:
        """How many crossings each ray has, (number,)."""
        return np.bincount(self.rays, minlength=self.number)

    @cached_property
    def first(self) -> Floats:
        """The parameter of each ray's first crossing, (number,), NaN for those that miss."""
        result = np.full(self.number, np.nan)
        result[self.rays[::-1]] = self.parameters[::-1]
        return result

    def along(self, ray: int) -> Floats:
        """The parameters of one ray's crossings, ascending.  Raises `ValueError` for a number that no ray has."""
        if not 0 <= ray < self.number:
            raise ValueError(f"ray must be a number from 0 to {self.number - 1}, not {ray}")
        return self.parameters[slice(*np.searchsorted(self.rays, (ray, ray + 1)))]

    def __repr__(self) -> str:
        return f"<Crossings: {len(self.rays)} on {self.number} rays>"


def crossings(evaluator: Evaluator, origins: Floats, directions: Floats) -> Crossings:
    """All crossings of rays (N, 3), t >= 0."""
    parts: list[tuple[Rows, Floats, Floats, NDArray[np.int8]]] = []
    for start, local, (rays, lengths, sides) in _blocks(evaluator, origins, directions, False):
        points = local.points(evaluator, origins[start:], rays, lengths)
        parts.append((rays + start, local.parameters(rays, lengths), points, sides.astype(np.int8)))
    rays, parameters, points, kinds = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Crossings(rays, parameters, points, kinds, len(origins))


def first_crossings(evaluator: Evaluator, origins: Floats, directions: Floats) -> Floats:
    """The parameters of first crossings (N,), NaN for rays that miss."""
    result = np.full(len(origins), np.nan)
    for start, local, (rays, lengths, _) in _blocks(evaluator, origins, directions, True):
        result[start + rays[::-1]] = local.parameters(rays, lengths)[::-1]
    return result


def _blocks(
    evaluator: Evaluator, origins: Floats, directions: Floats, first: bool
) -> Iterator[tuple[int, LocalRays, Found]]:
    """Blocks of rays, each from which number on, and all their crossings, or the first ones at least, in order."""
    for start in range(0, len(origins), BLOCK):
        checkpoint("shooting rays")
        here = slice(start, start + BLOCK)
        local = LocalRays.of(evaluator, origins[here], directions[here])
        yield start, local, _ordered(_of_block(evaluator, local, origins[here], directions[here], first))


def _ordered(found: Found) -> Found:
    """Crossings by ray, and along each ray by rising parameters."""
    rays, lengths, sides = found
    after = (rays[1:] > rays[:-1]) | ((rays[1:] == rays[:-1]) & (lengths[1:] >= lengths[:-1]))
    if after.all():
        return found
    order = np.lexsort((lengths, rays))
    return rays[order], lengths[order], sides[order]


def _of_block(evaluator: Evaluator, local: LocalRays, origins: Floats, directions: Floats, first: bool) -> Found:
    """Rays, parameters and sides of a block of rays, in no order."""
    clear = np.flatnonzero(~local.doubtful)
    found, undecided = in_doubles(evaluator, local if len(clear) == len(origins) else local.some(clear), first)
    parts: list[Found] = [(clear[found[0]], found[1], found[2])]
    exact = local.doubtful.copy()
    exact[clear[undecided]] = True
    for ray in np.flatnonzero(exact).tolist():
        checkpoint("working out rays exactly")
        unit = fmpq(2) ** -int(local.exponents[ray])
        known = exact_crossings(evaluator, origins[ray], directions[ray], unit)
        lengths, sides = np.array([t for t, _ in known]), np.array([side for _, side in known], dtype=np.intp)
        parts.append((np.full(len(known), ray), lengths, sides))
    rays, lengths, sides = (np.concatenate(column) for column in zip(*parts, strict=True))
    return rays, lengths, sides


def in_doubles(evaluator: Evaluator, local: LocalRays, first: bool) -> tuple[Found, Bools]:
    """The crossings of rays that are not doubtful, and on which of them (N,) these decide nothing.

    Compiled code shoots them at polynomials of degrees up to 15 on the cells of a region; the search with numpy serves
    polynomials without a region and those of higher degrees (see `pas.surface.ray_forms.scene_of`).
    """
    if evaluator.scene is None:
        return RaySearch(evaluator, local, first).run()
    shot = compiled().rays(evaluator.scene, local.origins, local.ways, first)
    return shot[:3], shot[3]


@dataclass(frozen=True)
class _Parts:
    """Parts [low, low + width] of segments, as shares of these, with Bernstein forms (n+1, M) and error bounds."""

    rows: Rows
    low: Floats
    width: Floats
    forms: Floats
    errors: Floats

    def some(self, chosen: Bools) -> _Parts:
        low, width, errors = self.low[chosen], self.width[chosen], self.errors[chosen]
        return _Parts(self.rows[chosen], low, width, self.forms[:, chosen], errors)

    def halves(self) -> _Parts:
        left, right = halving(len(self.forms) - 1, 2, 0)
        errors = self.errors + (len(self.forms) + 1) * UNIT_ROUNDOFF * np.abs(self.forms).max(axis=0)
        return _Parts(
            np.tile(self.rows, 2),
            np.concatenate([self.low, self.low + self.width / 2]),
            np.tile(self.width / 2, 2),
            np.concatenate([left @ self.forms, right @ self.forms], axis=1),
            np.tile(errors, 2),
        )


class RaySearch:
    """The crossings of a block of rays, with numpy: of any degree, in cells or in all of space (see `in_doubles`)."""

    def __init__(self, evaluator: Evaluator, local: LocalRays, first: bool) -> None:
        self.evaluator, self.local, self.first = evaluator, local, first
        self.exact = np.zeros(len(local.origins), dtype=bool)
        self.until = np.full(len(local.origins), np.inf)  # the end of the segment with the first crossing
        self.brackets: list[tuple[Segments, _Parts]] = []
        self.found: list[Found] = [(np.empty(0, dtype=np.intp), np.empty(0), np.empty(0, dtype=np.intp))]

    def run(self) -> tuple[Found, Bools]:
        """Rays, parameters and sides, in no order, of rays on which doubles decide, and which (N,) the others are."""
        if len(self.local.origins):
            for segments in segments_of(self.evaluator, self.local):
                wanted = ~self.exact[segments.rays]
                if self.first:
                    wanted &= segments.start <= self.until[segments.rays]
                if wanted.any():
                    self._cross(segments.some(wanted))
        self._refine()
        rays, parameters, sides = (np.concatenate(column) for column in zip(*self.found, strict=True))
        kept = ~self.exact[rays]
        return (rays[kept], parameters[kept], sides[kept]), self.exact

    def _cross(self, segments: Segments) -> None:
        """Look into one segment of each of some rays."""
        forms, errors = forms_on(self.evaluator, segments)
        some = ~((forms.min(axis=0) > errors) | (forms.max(axis=0) < -errors))
        segments, forms, errors = segments.some(some), forms[:, some], errors[some]
        self.exact[segments.rays[~_rootless(segments, forms, errors)]] = True
        size = len(errors)
        parts = _Parts(np.arange(size), np.zeros(size), np.ones(size), forms, errors)
        brackets = []
        for _ in range(DEEPEST):
            lowest, highest = parts.forms.min(axis=0), parts.forms.max(axis=0)
            possible = (lowest <= parts.errors) & (highest >= -parts.errors)
            possible &= ~self.exact[segments.rays[parts.rows]]
            parts, lowest, highest = parts.some(possible), lowest[possible], highest[possible]
            if not len(parts.rows):
                break
            monotone = _monotone(parts)
            brackets.append(parts.some(monotone & ((parts.forms[0] < 0) != (parts.forms[-1] < 0))))
            hopeless = ~monotone & (np.maximum(-lowest, highest) <= UNDECIDED * parts.errors)
            self.exact[segments.rays[parts.rows[hopeless]]] = True
            parts = parts.some(~monotone & ~hopeless).halves()
        self.exact[segments.rays[parts.rows]] = True
        for found in brackets:
            self.brackets.append((segments.some(found.rows), found))
            rays = segments.rays[found.rows]
            self.until[rays] = np.minimum(self.until[rays], segments.end[found.rows])

    def _refine(self) -> None:
        """The roots in all parts that have one."""
        if not self.brackets:
            return
        segments = joined([own for own, _ in self.brackets])
        columns = zip(*((p.rows, p.low, p.width, p.forms, p.errors) for _, p in self.brackets), strict=True)
        parts = _Parts(*(np.concatenate(column, axis=-1) for column in columns))
        rising = parts.forms[-1] > parts.forms[0]
        shares = parts.low + parts.width * roots_of(parts.forms)
        parameters = _polished(self.evaluator, segments, segments.at(shares), parts, rising)
        self.found.append((segments.rays, parameters, np.where(rising, 1, -1)))


def _rootless(segments: Segments, forms: Floats, errors: Floats) -> Bools:
    """Whether there certainly is no root near the ends of segments, where rays may be outside the piece.

    The slope, in shares, is at most n times the largest difference of the coefficients.
    """
    slopes = np.abs(np.diff(forms, axis=0)).max(axis=0, initial=0.0) + 2 * errors
    changes = (len(forms) - 1) * slopes * segments.slack()
    return np.asarray((np.abs(forms[[0, -1]]) > errors + changes).all(axis=0) & np.isfinite(changes).all(axis=0))


def _monotone(parts: _Parts) -> Bools:
    slopes = np.diff(parts.forms, axis=0)
    rises = slopes.min(axis=0, initial=np.inf) > 2 * parts.errors
    return np.asarray(rises | (slopes.max(axis=0, initial=-np.inf) < -2 * parts.errors))


def roots_of(forms: Floats) -> Floats:
    """The roots in [0, 1] of monotone polynomials in Bernstein form (n+1, M) whose ends differ in sign."""
    low, high = np.zeros(forms.shape[1]), np.ones(forms.shape[1])
    shares = forms[0] / (forms[0] - forms[-1])
    slopes = (len(forms) - 1) * np.diff(forms, axis=0)
    falling = forms[0] >= 0
    rows = np.arange(forms.shape[1])
    for _ in range(STEPS):
        here = shares[rows]
        values = bernstein_values(forms[:, rows], here)
        left = (values >= 0) == falling[rows]
        low[rows[left]], high[rows[~left]] = here[left], here[~left]
        with np.errstate(all="ignore"):
            after = here - values / bernstein_values(slopes[:, rows], here)
        fails = ~((after >= low[rows]) & (after <= high[rows]))
        after[fails] = (low[rows[fails]] + high[rows[fails]]) / 2
        shares[rows] = after
        rows = rows[np.abs(after - here) > CLOSE]
        if not len(rows):
            break
    return shares


def _polished(evaluator: Evaluator, segments: Segments, parameters: Floats, parts: _Parts, rising: Bools) -> Floats:
    """One step of Newton's method on the polynomial itself, within the part: its form is less accurate."""
    points = segments.points(parameters)
    jets = evaluator.local_derivatives(points, segments.pieces, (0, 1))
    slopes = (jets[:, 1:] * segments.ways).sum(axis=1)
    with np.errstate(all="ignore"):
        better = parameters - jets[:, 0] / slopes
        ends = segments.at(parts.low), segments.at(parts.low + parts.width)
    fits = np.isfinite(better) & ((slopes > 0) == rising)
    return np.clip(np.where(fits, np.clip(better, *ends), parameters), segments.first, segments.last)
