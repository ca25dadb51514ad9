"""Where rays cross a piecewise surface: all crossings in order, none missed.

In each cell the surface along a ray is a polynomial in one variable.  Its Bernstein form on the ray's segment there
is worked out with a bound on its rounding error and halved until each part certainly has no root, or is certainly
monotone and so has at most one (Lane and Riesenfeld 1981), which is then found by Newton's method within its
bracket.  Rays on which doubles cannot decide (tangent to the surface within rounding, or crossing it on the face of
a cell) are worked out exactly (see `pas.surface.exact_crossings`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.bernstein.subdivision import halving
from pas.limits import checkpoint
from pas.surface.exact_crossings import exact_crossings
from pas.surface.kernels import compiled
from pas.surface.ray_forms import Segments, bernstein_values, forms_on, joined, segments_of

if TYPE_CHECKING:
    from pas.surface.evaluator import Evaluator

BLOCK = 1 << 13
"""Rays that are worked on at once."""

EACH = 10_000
"""Products for a ray, about."""

DEEPEST = 40
"""Halvings of a segment, after which it is left to exact work."""

UNDECIDED = 4.0
"""Parts whose coefficients are all below so many error bounds are left to exact work: halving does not help them."""

STEPS, CLOSE = 60, 1e-11
"""Of Newton's method, or of bisection where that fails, and the last step over the part of the segment: the number of
right digits doubles with each step, and another step follows on the polynomial itself."""

Rows = NDArray[np.intp]
Bools = NDArray[np.bool_]
Found = tuple[Rows, Floats, Rows]
"""Numbers of rays, parameters and sides (M,) each."""


@dataclass(frozen=True)
class Crossings:
    """Crossings of `number` rays with a surface, by ray and along each ray in order.

    `rays` (M,) are the numbers of their rays, `parameters` (M,) the t of `origin + t direction`, `points` (M, 3)
    where that is; `sides` (M,) are 1 where the ray goes out (the value rises), -1 where it goes in, and 0 where it
    touches the surface from one side, and at the start of a stretch that lies in it.  A ray that starts on the
    surface within rounding crosses it at 0.
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
    rays, parameters, sides = _found(evaluator, origins, directions, False)
    points = origins[rays] + parameters[:, None] * directions[rays]
    return Crossings(rays, parameters, points, sides.astype(np.int8), len(origins))


def first_crossings(evaluator: Evaluator, origins: Floats, directions: Floats) -> Floats:
    """The parameters of first crossings (N,), NaN for rays that miss."""
    result = np.full(len(origins), np.nan)
    rays, parameters, _ = _found(evaluator, origins, directions, True)
    result[rays[::-1]] = parameters[::-1]
    return result


def _found(evaluator: Evaluator, origins: Floats, directions: Floats, first: bool) -> Found:
    """Rays, parameters and sides of all crossings, or of the first ones at least, in order."""
    parts: list[Found] = []
    for start in range(0, len(origins), BLOCK):
        checkpoint("shooting rays")
        here = slice(start, start + BLOCK)
        rays, parameters, sides = _of_block(evaluator, origins[here], directions[here], first)
        parts.append((rays + start, parameters, sides))
    rays, parameters, sides = (np.concatenate(part) for part in zip(*parts, strict=True))
    after = (rays[1:] > rays[:-1]) | ((rays[1:] == rays[:-1]) & (parameters[1:] >= parameters[:-1]))
    if after.all():
        return rays, parameters, sides
    order = np.lexsort((parameters, rays))
    return rays[order], parameters[order], sides[order]


def _of_block(evaluator: Evaluator, origins: Floats, directions: Floats, first: bool) -> Found:
    """The same of a block of rays, in no order; by compiled code where there is some."""
    kernel = None if evaluator.scene is None else compiled(EACH * len(origins))
    if kernel is not None and evaluator.scene is not None:
        local = evaluator.partition.frame.local_points(origins), directions / evaluator.scale
        shot = kernel.rays(evaluator.scene, *local, first)
        if shot is not None:
            *found, exact = shot
            parts = [(found[0], found[1], found[2])]
            for ray in np.flatnonzero(exact).tolist():
                _, parameters, sides = _exactly(evaluator, origins[ray], directions[ray])
                parts.append((np.full(len(parameters), ray), parameters, sides))
            rays, parameters, sides = (np.concatenate(column) for column in zip(*parts, strict=True))
            return rays, parameters, sides
    return _Search(evaluator, origins, directions, first).run()


def _exactly(evaluator: Evaluator, origin: Floats, direction: Floats) -> Found:
    """The crossings of one ray, numbered 0, worked out exactly."""
    checkpoint("working out rays exactly")
    known = exact_crossings(evaluator, origin, direction)
    parameters, sides = np.array([t for t, _ in known]), np.array([side for _, side in known], dtype=np.intp)
    return np.zeros(len(known), dtype=np.intp), parameters, sides


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
        return _Parts(
            np.tile(self.rows, 2),
            np.concatenate([self.low, self.low + self.width / 2]),
            np.tile(self.width / 2, 2),
            np.concatenate([left @ self.forms, right @ self.forms], axis=1),
            np.tile(self.errors, 2),
        )


class _Search:
    """The crossings of a block of rays."""

    def __init__(self, evaluator: Evaluator, origins: Floats, directions: Floats, first: bool) -> None:
        self.evaluator, self.origins, self.directions, self.first = evaluator, origins, directions, first
        self.exact = np.zeros(len(origins), dtype=bool)
        self.hit = np.zeros(len(origins), dtype=bool)
        self.before = np.zeros(len(origins))  # the sign at the end of the last segment, 0 where there is none
        self.reached = np.full(len(origins), np.nan)
        self.brackets: list[tuple[Segments, _Parts]] = []
        self.found: list[Found] = [(np.empty(0, dtype=np.intp), np.empty(0), np.empty(0, dtype=np.intp))]

    def run(self) -> Found:
        """Rays, parameters and sides, in no order."""
        for segments in segments_of(self.evaluator, self.origins, self.directions):
            wanted = ~self.exact[segments.rays]
            if self.first:
                wanted &= ~self.hit[segments.rays]
            if wanted.any():
                self._cross(segments.some(wanted))
        self._refine()
        for ray in np.flatnonzero(self.exact).tolist():
            zeros, parameters, sides = _exactly(self.evaluator, self.origins[ray], self.directions[ray])
            self.found.append((zeros - 1 - ray, parameters, sides))
        rays, parameters, sides = (np.concatenate(column) for column in zip(*self.found, strict=True))
        kept = (rays < 0) | ~self.exact[rays]  # numbers of rays that were worked out exactly are marked by -1 - number
        return np.where(rays < 0, -1 - rays, rays)[kept], parameters[kept], sides[kept]

    def _cross(self, segments: Segments) -> None:
        """Look into one segment of each of some rays."""
        forms, errors = forms_on(self.evaluator, segments)
        self._join(segments, forms, errors)
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
            self.hit[segments.rays[found.rows]] = True

    def _join(self, segments: Segments, forms: Floats, errors: Floats) -> None:
        """See that signs at the ends are certain and agree with those before; a ray may start on the surface."""
        rays = segments.rays
        signs = np.where(np.abs(forms[[0, -1]]) > errors, np.sign(forms[[0, -1]]), 0)
        begun = (signs[0] == 0) & (segments.start == 0) & (signs[1] != 0) & (self.before[rays] == 0)
        joined = self.reached[rays] == segments.start
        doubtful = (signs == 0).any(axis=0) & ~begun
        doubtful |= joined & (self.before[rays] != signs[0]) & ~begun
        self.exact[rays[doubtful]] = True
        self.before[rays], self.reached[rays] = signs[1], segments.end
        self._start(segments, forms, errors, np.flatnonzero(begun))

    def _start(self, segments: Segments, forms: Floats, errors: Floats, begun: Rows) -> None:
        """Rays that start on the surface cross it there; their form is then given the sign that it has afterwards."""
        certain = np.abs(forms[:, begun]) > errors[begun]
        away = np.sign(forms[np.argmax(certain, axis=0), begun])
        forms[0, begun] = away * np.finfo(float).tiny
        self.found.append((segments.rays[begun], np.zeros(len(begun)), away.astype(np.intp)))
        self.hit[segments.rays[begun]] = True

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
    slopes = (jets[:, 1:] * segments.directions).sum(axis=1)
    with np.errstate(all="ignore"):
        better = parameters - jets[:, 0] / slopes
        ends = segments.at(parts.low), segments.at(parts.low + parts.width)
    fits = np.isfinite(better) & ((slopes > 0) == rising)
    return np.where(fits, np.clip(better, *ends), parameters)
