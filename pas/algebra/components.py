"""The components of a real space curve on which points lie: exact, however close others come.

Planes of the sweeping form cut the curve in points.  Between two planes without a turn in between, each
point goes on to one point, and a second linear form keeps their order as long as no two have one value of
it: nowhere but at finitely many places, at which another form serves.  Around each point where the curve
turns or is singular a window is found in the plane of both forms through whose top and bottom no arc passes,
and in which all arcs end in that one point (see Basu, Pollack and Roy 2006, section 11.6).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, islice, pairwise

from flint import arb, ctx, fmpq, fmpq_mat, fmpq_poly

from pas.algebra.affine import ORIGIN, height
from pas.algebra.curve import SpaceCurve
from pas.algebra.ideal import Ideal
from pas.algebra.polynomial import Polynomial
from pas.algebra.roots import (
    FIRST_BITS,
    RealRoot,
    accuracies,
    between,
    bounds,
    hull,
    in_one,
    middle_of,
    rational_root,
    real_roots,
    simplest,
)
from pas.algebra.zeros import RealZero, count_zeros, linear_form, linear_forms, real_zeros, value_at
from pas.limits import checkpoint


class LostError(Exception):
    """It could not be decided how the arcs of a curve continue; `place` is where, if known."""

    def __init__(self, place: tuple[float, float, float] | None = None) -> None:
        super().__init__(str(place))
        self.place = place


class Components:
    """The components of a reduced curve, found as far as planes are looked at."""

    def __init__(self, curve: SpaceCurve) -> None:
        from scipy.cluster.hierarchy import DisjointSet

        self.curve = curve
        self._turns = sorted(set(curve.whole.turns or ()))
        others = (linear for linear in linear_forms() if linear != curve.linear)
        shadows = 3  # second linear forms that are tried
        self._shadows = [Shadow(curve, linear) for linear in islice(others, shadows)]
        self._points: dict[fmpq, list[RealZero]] = {}
        self._parts = DisjointSet()

    def of(self, points: Sequence[tuple[fmpq, RealZero]]) -> list[tuple[fmpq, int]]:
        """For each point, with the value of the sweeping form, what all on its component have in common.

        Raises `LostError` where that cannot be decided.
        """
        ends = [None, *self._turns, None]
        planes = sorted({value for value, _ in points} | {between(*slab) for slab in pairwise(ends)})
        for low, high in pairwise(planes):
            turn = next((t for t in self._turns if rational_root(low) < t < rational_root(high)), None)
            if turn is None:
                self._pass(low, high)
            else:
                self._turn(low, turn, high)
        return [self._parts[value, self._number(value, point)] for value, point in points]

    def _in_plane(self, value: fmpq) -> list[RealZero]:
        if value not in self._points:
            checkpoint("telling a curve's components apart")
            self._points[value] = self.curve.whole.points(value)
            for i in range(len(self._points[value])):
                self._parts.add((value, i))
        return self._points[value]

    def _number(self, value: fmpq, point: RealZero) -> int:
        """Which of the points in its plane a point is."""
        others = self._in_plane(value)
        near = ([i for i, other in enumerate(others) if other.overlaps(point, bits)] for bits in accuracies())
        return next(found[0] for found in near if len(found) == 1)

    def _pass(self, low: fmpq, high: fmpq) -> None:
        """Join each point of a plane with the one to which its arc leads in another, without a turn in between."""
        while low < high:
            start, stop = rational_root(low), rational_root(high)
            ahead = [[v for v in shadow.special if start <= v <= stop] for shadow in self._shadows]
            firsts = [values[0] if values else None for values in ahead]
            number, plane = firsts.index(None) if None in firsts else -1, high
            if number < 0:  # go with the one that goes farthest, beyond all other values so that another serves next
                end = max(v for v in firsts if v is not None)
                if all(v == end for v in firsts):
                    raise LostError
                number = firsts.index(end)
                plane = between(max(v for v in (start, *chain(*ahead)) if v < end), end)
            orders = [[(v, i) for i in self._shadows[number].order(self._in_plane(v))] for v in (low, plane)]
            for pair in zip(*orders, strict=True):
                self._parts.merge(*pair)
            low = plane

    def _turn(self, low: fmpq, turn: RealRoot, high: fmpq) -> None:
        """Join the points of two planes on both sides of a value where the curve turns or is singular."""
        at = [p for p in self._turning_points if self._value(p) == turn]
        windows = next(filter(None, (s.windows(at, turn, low, high) for s in self._shadows)), None)
        if windows is None:
            raise LostError(at[0].point if at else None)
        self._pass(low, windows.planes[0])
        self._pass(windows.planes[1], high)
        sides = []
        for plane in windows.planes:
            points = self._in_plane(plane)
            order = [(plane, i) for i in windows.shadow.order(points)]
            sides.append([[n for n in order if windows.place(points[n[1]]) == k] for k in range(2 * len(at) + 1)])
        for k, (before, after) in enumerate(zip(*sides, strict=True)):
            for pair in pairwise([*before, *after]) if k % 2 else zip(before, after, strict=True):
                self._parts.merge(*pair)

    @cached_property
    def _turning_points(self) -> list[RealZero]:
        found = real_zeros(Ideal(*self.curve.ideal.groebner_basis(), self.curve.turn))
        assert found is not None
        return found

    def _value(self, point: RealZero) -> RealRoot:
        """The value of the sweeping form at a turning point."""
        values = ((point.value(self.curve.form, bits), bits) for bits in accuracies())
        near = ([t for t in self._turns if t.ball(bits).overlaps(value)] for value, bits in values)
        return next(found[0] for found in near if len(found) == 1)


class Shadow:
    """The image of a curve in the plane of two linear forms (t, m): the zeros of a polynomial monic in m."""

    def __init__(self, curve: SpaceCurve, linear: tuple[int, int, int]) -> None:
        self.curve, self.linear, self.form = curve, linear, linear_form(linear)

    @cached_property
    def polynomial(self) -> Polynomial:
        """The polynomial, with t written x and m written y: the resultant of both surfaces.

        A line on which both forms are constant meets the curve at no point at infinity, so that one of the surfaces is
        monic along it, and nothing else comes in.
        """
        other = next(linear for linear in linear_forms() if linear not in (self.curve.linear, self.linear))
        inverse = fmpq_mat([list(linear) for linear in (self.curve.linear, self.linear, other)]).inv()
        images = [Polynomial.from_raw(height(ORIGIN, row)) for row in inverse.tolist()]
        first, second = (surface.compose(*images).raw for surface in self.curve.pair)
        found = first.resultant(second, "z")
        return Polynomial.from_raw(found) / found.to_dict()[0, found.total_degree(), 0]

    @cached_property
    def _discriminant(self) -> fmpq_poly:
        return in_one(self.polynomial.raw.discriminant("y"))

    @cached_property
    def special(self) -> list[RealRoot]:
        """Values of t at which two points, real or not, have one value of m, ascending."""
        return sorted(real_roots(self._discriminant))

    def is_faithful(self, turn: RealRoot) -> bool:
        """Whether no two points, real or not, of the curve over a value of t have one value of m."""
        square = fmpq_poly(turn.polynomial * turn.polynomial)
        if (self._discriminant % square).degree() >= 0:  # then it is one fold and nothing else
            return True
        value = sum((self.curve.form**k * fmpq(c) for k, c in enumerate(turn.polynomial.coeffs())), Polynomial(0))
        image = sum((Polynomial("x") ** k * fmpq(c) for k, c in enumerate(turn.polynomial.coeffs())), Polynomial(0))
        points = count_zeros(Ideal(*self.curve.ideal.groebner_basis(), value))
        return points == count_zeros(Ideal(self.polynomial, image, "z"))

    def order(self, points: Sequence[RealZero]) -> list[int]:
        """The numbers of points, no two with one value of m, by ascending values."""
        for bits in accuracies():
            values = [point.value(self.form, bits) for point in points]
            numbers = sorted(range(len(points)), key=lambda i: middle_of(values[i]))
            if not any(values[i].overlaps(values[j]) for i, j in pairwise(numbers)):
                return numbers
        raise AssertionError

    def windows(self, points: Sequence[RealZero], turn: RealRoot, low: fmpq, high: fmpq) -> Windows | None:
        """Windows around the images of all turning points of one value of t; None where others share their images."""
        if not self.is_faithful(turn):
            return None
        ends = [rational_root(low), *(v for v in self.special if v != turn), rational_root(high)]
        around = (between(max(v for v in ends if v < turn), turn), between(turn, min(v for v in ends if turn < v)))
        bends = [self._bend(point) for point in points]
        most_halvings = 1000  # of a window, before the question is given up
        sizes = (self._windows(points, bends, turn, around, halved) for halved in range(most_halvings))
        return next(filter(None, sizes), None)

    def _windows(
        self,
        points: Sequence[RealZero],
        bends: Sequence[tuple[int, Polynomial]],
        turn: RealRoot,
        around: tuple[fmpq, fmpq],
        halved: int,
    ) -> Windows | None:
        """Windows whose sizes are halved so often, if they serve."""
        checkpoint("telling a curve's components apart")
        faster = 1 + max((k for k, _ in bends), default=1)  # planes come closer faster than arcs leave the point
        bits, width = FIRST_BITS + 2 * faster * halved, around[1] - around[0]
        (low, high), beside = turn.bounds(bits), width / 2 ** (faster * halved)
        planes = (
            max(around[0], simplest(low - 2 * beside, low - beside)),
            min(around[1], simplest(high + beside, high + 2 * beside)),
        )
        middles = [bounds(point.value(self.form, bits)) for point in points]
        reach = width / 2**halved
        rows = sorted(((a - reach, b + reach), i) for i, (a, b) in enumerate(middles))
        found = Windows(self, planes, [pair for pair, _ in rows])
        return found if found.are_certain([bends[i][1] for _, i in rows], bits) else None

    def _bend(self, point: RealZero) -> tuple[int, Polynomial]:
        """The number of the first derivative by m, from the second on, that a turning point's image is no zero of."""
        number, result = 2, self.polynomial.diff(1).diff(1)
        while point.sign(result.compose(self.curve.form, self.form, Polynomial(0))) == 0:
            number, result = number + 1, result.diff(1)
        return number, result


@dataclass(frozen=True)
class Windows:
    """Rectangles between two planes of the sweeping form around turning points, with arcs entering from the sides only.

    `heights` are intervals of the second form, ascending.
    """

    shadow: Shadow
    planes: tuple[fmpq, fmpq]
    heights: list[tuple[fmpq, fmpq]]

    def are_certain(self, bends: Sequence[Polynomial], bits: int) -> bool:
        """Whether they are disjoint, and arcs enter them from the sides only.

        Where the derivative number k by m (one of the `bends`) has no zero, no plane has more than k points of a
        window.  In that of the turning point all k are one, so that all arcs in the window end there.
        """
        if any(below[1] >= above[0] for below, above in pairwise(self.heights)):
            return False
        with ctx.workprec(bits):
            t = hull(*self.planes)
            crossed = [value_at(self.shadow.polynomial, (t, arb(m), arb(0))) for pair in self.heights for m in pair]
            bent = [value_at(b, (t, hull(*pair), arb(0))) for b, pair in zip(bends, self.heights, strict=True)]
        return not any(value.contains(0) for value in crossed + bent)

    def place(self, point: RealZero) -> int:
        """Where a point of one of the planes is: 2 k + 1 in window k, 2 k below that."""
        edges = [edge for pair in self.heights for edge in pair]
        for bits in accuracies():
            low, high = bounds(point.value(self.shadow.form, bits))
            below = sum(edge < low for edge in edges)
            if below == sum(edge <= high for edge in edges):
                return below
        raise AssertionError
