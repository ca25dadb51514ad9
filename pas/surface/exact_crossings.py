"""All crossings of one ray with a piecewise surface, in exact arithmetic: for rays on which doubles cannot decide."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

from flint import fmpq, fmpq_poly

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, RING, Polynomial
from pas.algebra.rational import Vector, exact_vector, to_float
from pas.algebra.roots import RealRoot, between, rational_root, real_roots
from pas.algebra.roots import exact as middle_of

if TYPE_CHECKING:
    from pas.surface.evaluator import Evaluator

Span = tuple[fmpq, fmpq | None, fmpq_poly]
"""A stretch of the ray (to infinity for None), and the polynomial along the ray that holds on it."""


def exact_crossings(evaluator: Evaluator, origin: Floats, direction: Floats) -> list[tuple[float, int]]:
    """The parameters t >= 0 of all crossings of a ray, ascending, each with its side; see `Crossings`.

    The coordinates of the ray are taken as they are, so the result holds for exactly this ray.
    """
    frame = evaluator.partition.frame
    start = frame.local_point(exact_vector(origin.tolist()))
    dx, dy, dz = (d / frame.scale for d in exact_vector(direction.tolist()))
    spans = list(_spans(evaluator, start, (dx, dy, dz)))
    found = {root for span in spans for root in _roots(span)}
    return [(to_float(middle_of(root.ball())), _side(root, found, spans)) for root in sorted(found)]


def _spans(evaluator: Evaluator, origin: Vector, direction: Vector) -> Iterator[Span]:
    """The stretches of a ray between the planes of cells, in the region."""
    partition = evaluator.partition.local
    along = [_along(patch, origin, direction) for patch in evaluator.patches]
    if not partition.cells:
        yield fmpq(0), None, along[0]
        return
    walls = [[_line(p, origin, direction) for p in partition.planes(cell)] for cell in range(len(partition.cells))]
    met = {-a / b for planes in walls for a, b in planes if b != 0}
    for low, high in pairwise(sorted({fmpq(0)} | {t for t in met if t > 0})):
        middle = (low + high) / 2
        cell = next((c for c, planes in enumerate(walls) if all(a + b * middle <= 0 for a, b in planes)), None)
        if cell is not None:
            yield low, high, along[int(partition.piece_of[cell])]


def _along(patch: Polynomial, origin: Vector, direction: Vector) -> fmpq_poly:
    """The polynomial t -> patch(origin + t direction)."""
    t = GENERATORS[0]
    terms = patch.raw.compose(*(t * d + o for o, d in zip(origin, direction, strict=True)), ctx=RING).to_dict()
    size = max((e[0] for e in terms), default=-1) + 1
    return fmpq_poly([terms.get((i, 0, 0), fmpq(0)) for i in range(size)])


def _line(plane: Polynomial, origin: Vector, direction: Vector) -> tuple[fmpq, fmpq]:
    constant, *slope = plane.row(1)
    at = constant + sum((s * o for s, o in zip(slope, origin, strict=True)), fmpq(0))
    return at, sum((s * d for s, d in zip(slope, direction, strict=True)), fmpq(0))


def _roots(span: Span) -> Iterator[RealRoot]:
    """The zeros on a stretch, its ends counted; of one that lies in the surface, its start."""
    low, high, polynomial = span
    first = rational_root(low)
    if polynomial.degree() < 0:
        yield first
        return
    last = None if high is None else rational_root(high)
    for root in real_roots(polynomial):
        if root >= first and (last is None or root <= last):
            yield root


def _side(root: RealRoot, found: set[RealRoot], spans: list[Span]) -> int:
    """1 where the sign rises, -1 where it falls, 0 where it is the same on both sides.

    Where the region ends there is one side only, and the sign is taken to change.
    """
    before = after = 0
    for low, high, polynomial in spans:
        first, last = rational_root(low), None if high is None else rational_root(high)
        if first < root and (last is None or root <= last):
            previous = max((r for r in found if r < root), default=first)
            before = _sign(polynomial, between(max(previous, first), root))
        if first <= root and (last is None or root < last):
            following = min((r for r in found if root < r), default=last)
            ends = [r for r in (following, last) if r is not None]
            after = _sign(polynomial, between(root, min(ends) if ends else None))
    before, after = before or -after, after or -before
    return (after > before) - (after < before)


def _sign(polynomial: fmpq_poly, at: fmpq) -> int:
    value = polynomial(at)
    return int(value > 0) - int(value < 0)
