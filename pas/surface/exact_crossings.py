"""All crossings of one ray with a piecewise surface, in exact arithmetic: for rays on which doubles cannot decide.

What is a crossing is said in `pas.surface.crossings`.
"""

from __future__ import annotations

from collections.abc import Iterator

from flint import fmpq, fmpq_mat, fmpq_poly

from pas.algebra.monomials import Floats
from pas.algebra.polynomial import GENERATORS, RING, Polynomial
from pas.algebra.rational import Vector, exact_vector, to_float
from pas.algebra.roots import RealRoot, between, rational_root, real_roots
from pas.algebra.roots import exact as middle_of
from pas.surface.rays import RayTarget

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
    terms = patch.raw.compose(*(t * d + o for o, d in zip(origin, direction, strict=True)), ctx=RING).to_dict()
    size = max((e[0] for e in terms), default=-1) + 1
    return fmpq_poly([terms.get((i, 0, 0), fmpq(0)) for i in range(size)])


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
