"""The crossings of rays with a piecewise surface: all of them in order, none missed and none invented.

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
origin) are worked out exactly (see `exact_crossings`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import fmpq, fmpq_mat, fmpq_poly
from numpy.typing import NDArray

from pas.algebra.polynomial import GENERATORS, RING, Polynomial
from pas.algebra.rational import Vector, exact_vector, to_float
from pas.algebra.roots import RealRoot, between, in_one, middle_of, rational_root, real_roots
from pas.arrays import Floats, Integers
from pas.limits import blocks, checkpoint
from pas.surface.rays import Found, LocalRays, RayTarget

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
    for here in blocks(len(origins), BLOCK, "shooting rays"):
        local = LocalRays.of(target, origins[here], directions[here])
        rays, lengths, sides = _ordered(_of_block(target, local, origins[here], directions[here]))
        points = local.points(target, origins[here], rays, lengths)
        parts.append((rays + here.start, local.parameters(rays, lengths), points, sides.astype(np.int8)))
    rays, parameters, points, kinds = (np.concatenate(part) for part in zip(*parts, strict=True))
    return Crossings(rays, parameters, points, kinds, len(origins))


def _ordered(found: Found) -> Found:
    """Crossings by ray, and along each ray by rising parameters."""
    rays, lengths, sides = found
    after = (rays[1:] > rays[:-1]) | ((rays[1:] == rays[:-1]) & (lengths[1:] >= lengths[:-1]))
    if after.all():
        return found
    order = np.lexsort((lengths, rays))
    return rays[order], lengths[order], sides[order]


def _of_block(target: RayTarget, local: LocalRays, origins: Floats, directions: Floats) -> Found:
    """Rays, parameters and sides of a block of rays, in no order."""
    clear = np.flatnonzero(~local.doubtful)
    found, undecided = target.in_doubles(local if len(clear) == len(origins) else local.some(clear))
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


Stretch = tuple[RealRoot, RealRoot | None]
"""From one parameter to another, both counted, or to infinity."""

Span = tuple[RealRoot, RealRoot | None, fmpq_poly]
"""The stretch of a ray in a cell, and the polynomial along the ray that holds there."""


def exact_crossings(
    target: RayTarget, origin: Floats, direction: Floats, unit: fmpq | int = 1
) -> list[tuple[float, int]]:
    """The parameters t >= 0 of all crossings of a ray, over a unit, ascending, each with its side; see `Crossings`.

    The coordinates of the ray are taken as they are, so the result holds for exactly this ray.
    """
    frame = target.partition.frame
    start = frame.local_point(exact_vector(origin.tolist()))
    dx, dy, dz = (d * unit / frame.scale for d in exact_vector(direction.tolist()))
    spans = list(_spans(target, start, (dx, dy, dz)))
    inside = _joined([(low, high) for low, high, polynomial in spans if not polynomial and low != high])
    roots = {root for span in spans for root in _roots(span)}
    ends = roots | {end for stretch in inside for end in stretch if end is not None}
    points = {root for root in roots if not any(_holds(stretch, root) for stretch in inside)}
    sides = {low: 0 for low, _ in inside} | {root: _side(root, ends, spans) for root in points}
    return [(to_float(middle_of(root.ball())), sides[root]) for root in sorted(sides)]


def _spans(target: RayTarget, origin: Vector, direction: Vector) -> Iterator[Span]:
    """The stretches of a ray in the cells, some of which may be points; of cells that share one, that of the first."""
    if not target.local.cells:
        yield rational_root(fmpq(0)), None, _along(target.patches[0], origin, direction)
        return
    columns = fmpq_mat(4, 2, [fmpq(1), fmpq(0), *(x for pair in zip(origin, direction, strict=True) for x in pair)])
    lines = iter((target.barycentric * columns).entries())
    along: dict[int, fmpq_poly] = {}
    seen: set[tuple[fmpq, fmpq]] = set()
    for piece in target.local.piece_of.tolist():
        bounds = _positive([(next(lines), next(lines)) for _ in range(4)])
        if bounds is not None and bounds not in seen:
            if bounds[0] != bounds[1]:
                seen.add(bounds)
            if piece not in along:
                along[piece] = _along(target.patches[piece], origin, direction)
            yield (*map(rational_root, bounds), along[piece])  # type: ignore[misc]


def _positive(lines: list[tuple[fmpq, fmpq]]) -> tuple[fmpq, fmpq] | None:
    """From where to where in t >= 0 all of the four lines a + b t of a cell are not negative, None for nowhere."""
    if any(b == 0 and a < 0 for a, b in lines):
        return None
    low = max((-a / b for a, b in lines if b > 0), default=fmpq(0))
    high = min(-a / b for a, b in lines if b < 0)  # the four add up to 1, and not all of them are constant
    low = max(low, fmpq(0))
    return (low, high) if low <= high else None


def _joined(stretches: list[Stretch]) -> list[Stretch]:
    """Stretches without overlaps: those that meet are one."""
    result: list[Stretch] = []
    for low, high in sorted(stretches, key=lambda stretch: stretch[0]):
        if result and _holds(result[-1], low):
            first, last = result.pop()
            result.append((first, None if last is None or high is None else max(last, high)))
        else:
            result.append((low, high))
    return result


def _holds(stretch: Stretch, root: RealRoot) -> bool:
    low, high = stretch
    return low <= root and (high is None or root <= high)


def _along(patch: Polynomial, origin: Vector, direction: Vector) -> fmpq_poly:
    """The polynomial t -> patch(origin + t direction)."""
    t = GENERATORS[0]
    return in_one(patch.raw.compose(*(t * d + o for o, d in zip(origin, direction, strict=True)), ctx=RING))


def _roots(span: Span) -> Iterator[RealRoot]:
    """The zeros on a stretch, its ends counted; of one that lies in the surface, its start."""
    low, high, polynomial = span
    if not polynomial:
        return iter((low,))
    return (root for root in real_roots(polynomial) if _holds((low, high), root))


def _side(root: RealRoot, ends: set[RealRoot], spans: list[Span]) -> int:
    """1 where the sign rises, -1 where it falls, 0 where it is the same on both sides.

    Where the region ends there is one side only, and the sign is taken to change; where there is none, it is 0.
    """
    before = after = 0
    for low, high, polynomial in spans:
        if low < root and (high is None or root <= high):
            previous = max((end for end in ends if end < root), default=low)
            before = _sign(polynomial, between(max(previous, low), root))
        if low <= root and (high is None or root < high):
            following = min((end for end in ends if root < end), default=high)
            nearest = [end for end in (following, high) if end is not None]
            after = _sign(polynomial, between(root, min(nearest) if nearest else None))
    before, after = before or -after, after or -before
    return (after > before) - (after < before)


def _sign(polynomial: fmpq_poly, at: fmpq) -> int:
    value = polynomial(at)
    return int(value > 0) - int(value < 0)
