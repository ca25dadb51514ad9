"""Walking along a space curve, with a proof that the walk stays on one component and misses no point of it.

Around a point of V(g, h) the curve is looked at in coordinates s along its tangent and a, b across, in
which linear combinations of the two polynomials read a + R1 and b + R2.  Where for |s| <= sigma and
|a|, |b| <= rho sums of absolute coefficients show |R| < 7/8 rho and |dR/da| + |dR/db| < 1/2, the curve is
one graph over s there, since (a, b) -> -R contracts (Krawczyk 1969), and its point at s = 0 is at most twice
as far from a = b = 0 as R is large there.  All of that is exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

import numpy as np
from flint import fmpq, fmpq_mat

from pas.algebra.curve import SpaceCurve, gradient
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import Vector, rational, to_float
from pas.algebra.roots import bounds
from pas.algebra.zeros import RealZero
from pas.limits import checkpoint

STEPS = 3000
"""Boxes after which a walk is given up."""

SMALLEST = fmpq(1, 1 << 160)
"""sigma below which a walk is given up: the curve is singular there, or nearly."""

FORWARD, SLIM = fmpq(3, 4), fmpq(1, 4)
"""How far a walk goes in a box, and rho, over sigma."""

INNER, HALF = fmpq(7, 8), fmpq(1, 2)
"""Bounds of |R| over rho, and of its slope: points of the graph are well inside the box."""

EXACT, CORRECTIONS = fmpq(1, 1 << 20), 20
"""How well the points of a walk lie on the curve, over sigma; and how often they are moved closer."""

GUARD_BITS = 60
"""Bits that are kept of a point beyond those of sigma."""

CLOSE = 4.0
"""Distance over sigma within which a stop may be in a box."""


@dataclass(frozen=True)
class Stop:
    """A point at which a walk may stop; `last` towards low, towards high values of the sweeping form."""

    point: RealZero
    last: tuple[bool, bool]


@dataclass
class Walk:
    """The stops, by number, that a walk came by; `complete` if certainly no others are on the component.

    `place` is where an incomplete walk was given up.
    """

    reached: set[int]
    complete: bool = True
    place: tuple[float, float, float] | None = None


def walk(curve: SpaceCurve, stops: Sequence[Stop], start: int, goals: AbstractSet[int] = frozenset()) -> Walk:
    """Walk both ways from a stop to the ends of the component, or round it, or to the first of `goals`."""
    result = Walk({start})
    for direction in (1, -1):
        if _one_way(curve, stops, start, direction, goals, result):
            break
    return result


def _one_way(
    curve: SpaceCurve, stops: Sequence[Stop], start: int, direction: int, goals: AbstractSet[int], result: Walk
) -> bool:
    """Walk one way and note what is reached; whether the walk came round or to a goal."""
    point = stops[start].point
    if _is_end(curve, stops[start], direction):
        return False
    frame, sigma = _Frame.near(curve, point.near(_bits(fmpq(1))), direction, fmpq(1)), fmpq(1)
    first, left = None, False
    for _ in range(STEPS):
        checkpoint("following a curve")
        while frame is not None and sigma > SMALLEST and not frame.is_graph(sigma):
            sigma /= 2
        if frame is None or sigma <= SMALLEST:
            break
        if first is None:
            if not frame.has_zero(point, sigma):
                break
            first = (frame, sigma)
        for number in frame.stops(stops, sigma):
            result.reached.add(number)
            if number != start and _is_end(curve, stops[number], direction):
                return False
        if goals & result.reached:
            result.complete = False
            return True
        back = first[0].has(frame, first[1])
        if left and back:
            return True
        left |= not back
        following = frame.following(curve, direction, sigma)
        if following is None:
            sigma /= 2
        else:
            frame, sigma = following, 2 * sigma
    result.complete = False
    result.place = (0.0, 0.0, 0.0) if frame is None else frame.place
    return False


def _is_end(curve: SpaceCurve, stop: Stop, direction: int) -> bool:
    """Whether nothing but a way to infinity is ahead."""
    return stop.last[direction * stop.point.sign(curve.turn) > 0]


class _Frame:
    """Coordinates s, a, b about a point near the curve, and the remainders R1, R2 of the curve's equations."""

    def __init__(
        self, at: Vector, axes: tuple[Vector, Vector, Vector], rests: list[dict[tuple[int, ...], fmpq]]
    ) -> None:
        self.at, self.axes, self._rests = at, axes, rests
        self._inverse = fmpq_mat([list(row) for row in zip(*axes, strict=True)]).inv()

    @classmethod
    def near(cls, curve: SpaceCurve, at: Vector, direction: int, sigma: fmpq) -> _Frame | None:
        """The frame at the curve's point next to a given one; None where the curve seems singular."""
        for _ in range(CORRECTIONS):
            frame = cls._at(curve, at, direction)
            if frame is None or frame._offset <= EXACT * sigma:
                return frame
            a, b = (-rest.get((0, 0, 0), fmpq(0)) for rest in frame._rests)
            at = frame._moved((fmpq(0), a, b), sigma)
        return None

    @classmethod
    def _at(cls, curve: SpaceCurve, at: Vector, direction: int) -> _Frame | None:
        slopes = [tuple(fmpq(d.raw(*at)) for d in gradient(p)) for p in curve.pair]
        axes = _axes(slopes, direction)
        if axes is None:
            return None
        images = [
            Polynomial.from_raw(
                sum((g * axis[i] for g, axis in zip(GENERATORS, axes, strict=True)), GENERATORS[0] * 0 + c)
            )
            for i, c in enumerate(at)
        ]
        g, h = (p.compose(*images).raw for p in curve.pair)
        (ga, gb), (ha, hb) = ([fmpq(p[e]) for e in ((0, 1, 0), (0, 0, 1))] for p in (g, h))
        det = ga * hb - gb * ha
        if det == 0:
            return None
        combined = (g * (hb / det) - h * (gb / det), h * (ga / det) - g * (ha / det))
        rests = [p - GENERATORS[i + 1] for i, p in enumerate(combined)]
        return cls(at, axes, [{tuple(map(int, e)): c for e, c in p.to_dict().items()} for p in rests])

    @property
    def place(self) -> tuple[float, float, float]:
        """The point, rounded."""
        x, y, z = map(to_float, self.at)
        return x, y, z

    @property
    def _offset(self) -> fmpq:
        """How far the point is from the curve, about."""
        return max(abs(rest.get((0, 0, 0), fmpq(0))) for rest in self._rests)

    def is_graph(self, sigma: fmpq) -> bool:
        """Whether the curve is certainly one graph in the box of that half length."""
        rho = SLIM * sigma
        for rest in self._rests:
            size, slope = fmpq(0), fmpq(0)
            for (i, j, k), c in rest.items():
                term = abs(c) * sigma**i
                size += term * rho ** (j + k)
                slope += term * (j + k) * rho ** (j + k - 1) if j + k else 0
            if size >= INNER * rho or slope >= HALF:
                return False
        return True

    def has_zero(self, zero: RealZero, sigma: fmpq) -> bool:
        """Whether a point of the curve is certainly on the graph."""
        ends = [bounds(ball) for ball in zero.balls(_bits(sigma))]
        x, y, z = ((low + high) / 2 for low, high in ends)
        return self._holds((x, y, z), max(high - low for low, high in ends), sigma)

    def has(self, other: _Frame, sigma: fmpq) -> bool:
        """Whether the curve's point at another frame is certainly on the graph."""
        reach = 2 * other._offset * sum(abs(c) for axis in other.axes[1:] for c in axis)
        return self._holds(other.at, reach, sigma)

    def stops(self, stops: Sequence[Stop], sigma: fmpq) -> list[int]:
        """The numbers of the stops on the graph."""
        result = []
        for number, stop in enumerate(stops):
            away = [to_float(a - b) for a, b in zip(stop.point.near(_bits(sigma)), self.at, strict=True)]
            if max(map(abs, away)) <= CLOSE * to_float(sigma) and self.has_zero(stop.point, sigma):
                result.append(number)
        return result

    def following(self, curve: SpaceCurve, direction: int, sigma: fmpq) -> _Frame | None:
        """The frame at a point further along the graph; None where none is found."""
        result = _Frame.near(curve, self._moved((FORWARD * sigma, fmpq(0), fmpq(0)), sigma), direction, sigma)
        return result if result is not None and self.has(result, sigma) else None

    def _moved(self, local: tuple[fmpq, fmpq, fmpq], sigma: fmpq) -> Vector:
        """A point near the one with given coordinates in the frame, rounded."""
        grid = fmpq(1, 1 << (GUARD_BITS + max(0, -_exponent(sigma))))
        moved = (c + sum(v * axis[i] for v, axis in zip(local, self.axes, strict=True)) for i, c in enumerate(self.at))
        x, y, z = (fmpq((c / grid).floor()) * grid for c in moved)
        return x, y, z

    def _holds(self, point: Vector, reach: fmpq, sigma: fmpq) -> bool:
        """Whether all points up to `reach` (in each coordinate) from a point are inside the box."""
        away = [a - b for a, b in zip(point, self.at, strict=True)]
        for row, limit in enumerate((sigma, SLIM * sigma, SLIM * sigma)):
            line = [self._inverse[row, i] for i in range(3)]
            value = sum((a * b for a, b in zip(line, away, strict=True)), fmpq(0))
            if abs(value) + reach * sum(abs(c) for c in line) >= limit:
                return False
        return True


def _axes(slopes: list[tuple[fmpq, ...]], direction: int) -> tuple[Vector, Vector, Vector] | None:
    """The tangent, as a vector of length about 1, and two about normal to it; None where the slopes are parallel."""
    g, h = slopes
    exact = [direction * (g[(i + 1) % 3] * h[(i + 2) % 3] - g[(i + 2) % 3] * h[(i + 1) % 3]) for i in range(3)]
    largest = max(map(abs, exact))
    if largest == 0:
        return None
    tangent = np.array([to_float(c / largest) for c in exact])
    tangent /= np.linalg.norm(tangent)
    across = np.cross(tangent, np.eye(3)[np.abs(tangent).argmin()])
    across /= np.linalg.norm(across)
    t, a, b = (tuple(rational(float(c)) for c in v) for v in (tangent, across, np.cross(tangent, across)))
    return t, a, b  # type: ignore[return-value]


def _bits(sigma: fmpq) -> int:
    """Enough bits for points in a box of that half length, one of few numbers."""
    return 2 * GUARD_BITS * (1 + max(0, -_exponent(sigma)) // GUARD_BITS)


def _exponent(number: fmpq) -> int:
    """About the logarithm to base 2."""
    return int(number.p).bit_length() - int(number.q).bit_length()
