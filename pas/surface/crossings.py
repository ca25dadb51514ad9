"""Where rays cross a piecewise surface: all crossings in order, none missed and none invented.

What is counted: the numbers of the ray, of the region's corners and of the polynomials are taken as they are, exactly.
A crossing is a t >= 0 for which `origin + t direction` is in a closed cell whose polynomial is 0 there; where a whole
stretch of the ray is such, its start.  (Of cells that share a face in which the ray runs the first counts, should their
polynomials differ there.)  So rays that pass the region or the surface within rounding do not cross it, and
rays from a point that is on the surface only within rounding cross it there or not as these numbers have it.

In each cell the surface along a ray is a polynomial in one variable.  Its Bernstein form on the longest stretch on
which the ray may be in the cell (see `pas.surface.rays`) is worked out with a bound on its rounding error and
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

import numpy as np
from flint import fmpq
from numpy.typing import NDArray

from pas.algebra.monomials import Floats
from pas.limits import checkpoint
from pas.surface.exact_crossings import exact_crossings
from pas.surface.rays import Found, Integers, LocalRays, RayTarget

BLOCK = 1 << 13
"""Rays that are worked on at once."""


@dataclass(frozen=True)
class Crossings:
    """Crossings of `number` rays with a surface, by ray and along each ray in order.

    `rays` (M,) are the numbers of their rays, `parameters` (M,) the t of `origin + t direction`, `points` (M, 3)
    where that is; `sides` (M,) are 1 where the ray goes out (the value rises), -1 where it goes in, and 0 where it
    touches the surface from one side, and at the start of a stretch that lies in it.  Counts and sides are exact (for
    what is counted see `Evaluator.rays`); parameters are right to rounding, and infinite beyond the range of doubles.
    """

    rays: Integers
    parameters: Floats
    points: Floats
    sides: NDArray[np.int8]
    number: int

    @cached_property
    def counts(self) -> Integers:
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


def crossings(target: RayTarget, origins: Floats, directions: Floats) -> Crossings:
    """All crossings of rays (N, 3), t >= 0."""
    parts: list[tuple[Integers, Floats, Floats, NDArray[np.int8]]] = []
    for start, local, (rays, lengths, sides) in _blocks(target, origins, directions, False):
        points = local.points(target, origins[start:], rays, lengths)
        parts.append((rays + start, local.parameters(rays, lengths), points, sides.astype(np.int8)))
    rays, parameters, points, kinds = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Crossings(rays, parameters, points, kinds, len(origins))


def first_crossings(target: RayTarget, origins: Floats, directions: Floats) -> Floats:
    """The parameters of first crossings (N,), NaN for rays that miss."""
    result = np.full(len(origins), np.nan)
    for start, local, (rays, lengths, _) in _blocks(target, origins, directions, True):
        result[start + rays[::-1]] = local.parameters(rays, lengths)[::-1]
    return result


def _blocks(
    target: RayTarget, origins: Floats, directions: Floats, first: bool
) -> Iterator[tuple[int, LocalRays, Found]]:
    """Blocks of rays, each from which number on, and all their crossings, or the first ones at least, in order."""
    for start in range(0, len(origins), BLOCK):
        checkpoint("shooting rays")
        here = slice(start, start + BLOCK)
        local = LocalRays.of(target, origins[here], directions[here])
        yield start, local, _ordered(_of_block(target, local, origins[here], directions[here], first))


def _ordered(found: Found) -> Found:
    """Crossings by ray, and along each ray by rising parameters."""
    rays, lengths, sides = found
    after = (rays[1:] > rays[:-1]) | ((rays[1:] == rays[:-1]) & (lengths[1:] >= lengths[:-1]))
    if after.all():
        return found
    order = np.lexsort((lengths, rays))
    return rays[order], lengths[order], sides[order]


def _of_block(target: RayTarget, local: LocalRays, origins: Floats, directions: Floats, first: bool) -> Found:
    """Rays, parameters and sides of a block of rays, in no order."""
    clear = np.flatnonzero(~local.doubtful)
    found, undecided = target.in_doubles(local if len(clear) == len(origins) else local.some(clear), first)
    parts: list[Found] = [(clear[found[0]], found[1], found[2])]
    exact = local.doubtful.copy()
    exact[clear[undecided]] = True
    for ray in np.flatnonzero(exact).tolist():
        checkpoint("working out rays exactly")
        unit = fmpq(2) ** -int(local.exponents[ray])
        known = exact_crossings(target, origins[ray], directions[ray], unit)
        lengths, sides = np.array([t for t, _ in known]), np.array([side for _, side in known], dtype=np.intp)
        parts.append((np.full(len(known), ray), lengths, sides))
    rays, lengths, sides = (np.concatenate(column) for column in zip(*parts, strict=True))
    return rays, lengths, sides
