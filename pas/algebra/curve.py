"""Space curves V(g, h) in pieces: what vanishes on them, where, and one exact point on each arc.

A linear form whose planes cut the curve in finitely many points, everywhere and at infinity, sweeps
over it.  Between the values at which the curve is singular or touches the plane, it consists of arcs
along which the form rises, one through each point of any plane in between (Basu, Pollack and Roy 2006,
chapter 11).  More values may cut the arcs: those at which some polynomial changes its sign.

Guaranteed: every arc has its point, and all numbers are exact.  A curve that is not cut out
transversally says so (`CurvePart.turns` is None).
"""

from __future__ import annotations

from functools import cached_property
from itertools import count, pairwise

from flint import fmpq, fmpq_mpoly

from pas.algebra.ideal import Ideal
from pas.algebra.polynomial import RING, Polynomial
from pas.algebra.rational import cross, dot
from pas.algebra.roots import RealRoot, between
from pas.algebra.zeros import (
    Quotient,
    RealZero,
    linear_form,
    linear_forms,
    real_zeros,
    values_at_zeros,
)
from pas.limits import checkpoint

VectorField = tuple[Polynomial, Polynomial, Polynomial]

PLANES = (fmpq(1, 3), fmpq(-2, 5), fmpq(7, 4))
"""Values of the linear form where a curve is asked for being irreducible."""


class SplitError(Exception):
    """A polynomial vanishes on some components of a curve and not on others: `CurvePart.split` by it."""

    def __init__(self, polynomial: Polynomial) -> None:
        super().__init__(str(polynomial))
        self.polynomial = polynomial


class SpaceCurve:
    """The curve V(g, h) of two polynomials without a common factor, with a linear form to sweep over it."""

    def __init__(self, g: Polynomial, h: Polynomial) -> None:
        self.pair = (g, h)
        self.ideal = Ideal(g, h)
        self.linear = next(filter(self._sweeps, linear_forms()))

    @cached_property
    def form(self) -> Polynomial:
        """The linear form."""
        return linear_form(self.linear)

    @cached_property
    def turn(self) -> Polynomial:
        """`det(grad g, grad h, grad form)`: zero where the curve is singular or touches a plane of the form."""
        normal = cross(gradient(self.pair[0]), gradient(self.pair[1]))
        return along(normal, self.form)

    @cached_property
    def whole(self) -> CurvePart:
        """All of it."""
        return CurvePart(self, self.ideal)

    def _sweeps(self, linear: tuple[int, int, int]) -> bool:
        """Whether the curve has no point at infinity, not even a complex one, where a form is 0.

        No component lies in a plane of the form then, and none goes to infinity between two of them.
        """
        tops = [Polynomial.from_raw(leading_form(p.raw)) for p in self.ideal.groebner_basis()]
        return Quotient.of(Ideal(*tops, linear_form(linear))) is not None


class CurvePart:
    """Some components of a space curve, given by an ideal.

    Where they are `reduced`, the ideal holds all polynomials that vanish on them.
    """

    def __init__(self, curve: SpaceCurve, ideal: Ideal, reduced: bool = True) -> None:
        self.curve, self.ideal, self.reduced = curve, ideal, reduced
        self._crossings: dict[tuple[Polynomial, ...], list[RealRoot]] = {}
        self._singular_points: dict[Polynomial, list[RealZero]] = {}

    def contains(self, polynomial: Polynomial) -> bool:
        """Whether a polynomial vanishes on all of it; raises `SplitError` where it does so on some components only."""
        if self.ideal.contains(polynomial):
            return True
        if not self._irreducible:
            self.crossings(polynomial)
        return False

    def crossings(self, *polynomials: Polynomial) -> list[RealRoot]:
        """Values of the form among which are those where all of the polynomials vanish on the curve.

        One of them at least must not vanish on all of it.  Raises `SplitError` for components on which all vanish.
        """
        key = tuple(p.primitive() for p in polynomials)
        if key not in self._crossings:
            checkpoint("cutting a curve into arcs")
            rests = [Polynomial.from_raw(self.ideal.remainder(p.raw)) for p in key]
            found = values_at_zeros(Ideal(*self.ideal.groebner_basis(), *rests), self.curve.linear)
            if found is None:
                raise SplitError(next(p for p in key if not self.ideal.contains(p)))
            self._crossings[key] = found
        return self._crossings[key]

    @cached_property
    def turns(self) -> list[RealRoot] | None:
        """Values of the form where the curve is singular or touches its plane; None for a curve that is not reduced."""
        reduced = self.reduced and not self.contains(self.curve.turn)
        return self.crossings(self.curve.turn) if reduced else None

    def points(self, value: fmpq) -> list[RealZero]:
        """All real points of the curve in the plane `form = value`, no value of `turns`."""
        plane = self.curve.form - Polynomial(value)
        found = real_zeros(Ideal(*self.ideal.groebner_basis(), plane))
        assert found is not None
        return found

    def singular_points(self, polynomial: Polynomial) -> list[RealZero]:
        """The real points of the curve where a polynomial that vanishes on it has no gradient, finitely many."""
        if polynomial not in self._singular_points:
            found = real_zeros(Ideal(*self.ideal.groebner_basis(), *gradient(polynomial)))
            assert found is not None
            self._singular_points[polynomial] = found
        return self._singular_points[polynomial]

    def split(self, polynomial: Polynomial) -> list[CurvePart]:
        """The components on which a polynomial vanishes, and the others."""
        off = self.ideal.saturated(polynomial)
        if off.is_whole_ring:  # it vanishes everywhere and yet is no member
            return [CurvePart(self.curve, self.ideal, reduced=False)]
        basis = off.groebner_basis()
        for n in count():  # vanishes on the others, and on none of the components
            weights = (n**i for i in range(len(basis)))
            separator = sum((p * w for p, w in zip(basis, weights, strict=True)), Polynomial(0))
            both = Ideal(*self.ideal.groebner_basis(), polynomial, separator)
            if Quotient.of(both) is not None:
                return [CurvePart(self.curve, self.ideal.saturated(separator)), CurvePart(self.curve, off)]
        raise AssertionError

    @cached_property
    def _irreducible(self) -> bool:
        """Whether the curve is certainly irreducible over the rationals, since its points in some plane are."""
        for value in PLANES:
            quotient = Quotient.of(Ideal(*self.ideal.groebner_basis(), self.curve.form - Polynomial(value)))
            if quotient is not None and quotient.standard:
                other = next(f for f in linear_forms() if f != self.curve.linear)
                factors = quotient.times(other).charpoly().numer().factor()[1]
                if [multiplicity for _, multiplicity in factors] == [1]:
                    return True
        return False


def gradient(polynomial: Polynomial) -> VectorField:
    """The three partial derivatives."""
    return polynomial.diff(0), polynomial.diff(1), polynomial.diff(2)


def along(field: VectorField, polynomial: Polynomial) -> Polynomial:
    """The derivative of a polynomial along a vector field."""
    return dot(field, gradient(polynomial))


def has_real_curve(surface: Polynomial, clip: Polynomial) -> bool | None:
    """Whether V(surface, clip) is a real curve somewhere, not empty nor isolated points.

    Asked for polynomials without a common factor that have a common complex point.  None where the two touch along
    a whole component.
    """
    whole = SpaceCurve(surface, clip).whole
    try:
        turns = whole.turns
    except SplitError:
        return None
    if turns is None:
        return None
    return any(whole.points(between(*slab)) for slab in pairwise([None, *sorted(set(turns)), None]))


def leading_form(raw: fmpq_mpoly) -> fmpq_mpoly:
    """The terms of the highest degree."""
    degree = raw.total_degree()
    return RING.from_dict({e: c for e, c in raw.to_dict().items() if sum(map(int, e)) == degree})
