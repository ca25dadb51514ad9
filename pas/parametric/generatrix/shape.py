"""Shape functions of s and the four that shape a generatrix blend: lengths l_i > 0 and slants -1 < lambda_i < 1.

Polynomials are exact; their least and greatest values on [0, 1] are found among the real zeros of the derivative,
isolated with certainty, and whether they reach a bound by the zeros of the difference.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

import numpy as np
from flint import fmpq, fmpq_poly
from numpy.typing import ArrayLike

from pas.algebra.brief import brief
from pas.algebra.inputs import WIDEST, short, shown
from pas.algebra.rational import Exact, plain, rational, to_float, to_fraction
from pas.algebra.rational_function import ONE, RationalFunction
from pas.arrays import Floats
from pas.parametric.generatrix.paths import NAMES, CurveLike
from pas.parametric.hermite import taylor_basis
from pas.parametric.series import rounded_roots, univariate

MANY = 24
"""Data pairs above make an interpolating polynomial swing wildly between them."""

FOUR = ("l1", "l2", "lambda1", "lambda2")
"""The shape functions."""


@dataclass(frozen=True)
class ShapeFunction:
    """A polynomial in s (`coefficients`, ascending), or for closed curves a cosine.

    `wave` = (low, high, start) stands for (1 - cos 2 pi (s - start)) (high - low)/2 + low.
    """

    coefficients: tuple[Fraction, ...] = ()
    wave: tuple[float, float, float] | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        if any(abs(c) > 10**WIDEST for c in self.coefficients):
            raise ValueError(f"shape values must not be above 1e{WIDEST}, which cannot be evaluated in floating point")

    @classmethod
    def constant(cls, value: Exact) -> ShapeFunction:
        """The constant function of a value."""
        return cls((to_fraction(rational(value, "the shape value")),))

    @classmethod
    def through(cls, pairs: Sequence[Sequence[Exact]]) -> ShapeFunction:
        """The polynomial of least degree through data pairs (s, value), s distinct in [0, 1]."""
        read = [tuple(rational(x, f"pairs[{i}]") for x in pair) for i, pair in enumerate(pairs)]
        if not read or any(len(pair) != 2 for pair in read):
            raise ValueError(f"pairs must be data pairs (s, value) such as [(0, 1), (1, '1/2')], not {shown(pairs)}")
        places = [pair[0] for pair in read]
        if len(set(places)) < len(places) or min(places) < 0 or max(places) > 1:
            raise ValueError(f"the s of pairs must be distinct and in [0, 1], not {shown([plain(p) for p in places])}")
        if len(read) > MANY:
            raise ValueError(f"{len(read)} pairs are too many for one polynomial; give at most {MANY}")
        terms = (taylor_basis(places, i, 0)[0] * value for i, (_, value) in enumerate(read))
        result = sum(terms, fmpq_poly([0]))
        return cls(tuple(to_fraction(c) for c in result.coeffs()) or (Fraction(0),))

    @classmethod
    def cosine(cls, low: Exact, high: Exact, start: Exact = 0) -> ShapeFunction:
        """For closed curves: `low` at s = `start`, `high` half a turn on, and periodic."""
        parts = zip((low, high, start), ("low", "high", "start"), strict=True)
        a, b, c = (to_float(rational(value, name)) for value, name in parts)
        return cls(wave=(a, b, c))

    def scaled(self, factor: float) -> ShapeFunction:
        """The function times a number."""
        if self.wave is not None:
            return ShapeFunction(wave=(factor * self.wave[0], factor * self.wave[1], self.wave[2]))
        return ShapeFunction(tuple(c * Fraction(factor) for c in self.coefficients))

    def __call__(self, s: ArrayLike, order: int = 0) -> Floats:
        """Values at `s`, or derivatives of an order."""
        array = np.asarray(s, dtype=float)
        if self.wave is not None:
            low, high, start = self.wave
            wave = np.cos(2 * np.pi * (array - start) + order * np.pi / 2) * (2 * np.pi) ** order
            return np.asarray((high - low) / 2 * ((order == 0) - wave) + (low if order == 0 else 0.0))
        row = np.array([float(c) for c in self.coefficients])
        return np.asarray(np.polynomial.polynomial.polyval(array, np.polynomial.polynomial.polyder(row, order)))

    @property
    def polynomial(self) -> fmpq_poly | None:
        """The exact polynomial; None for a cosine that is not constant."""
        if self.wave is None:
            return fmpq_poly([fmpq(c.numerator, c.denominator) for c in self.coefficients])
        return fmpq_poly([rational(self.wave[0])]) if self.wave[0] == self.wave[1] else None

    @property
    def exact(self) -> RationalFunction | None:
        """The function of (s, t) where it is a polynomial, else None."""
        p = self.polynomial
        return None if p is None else RationalFunction.quotient(univariate(p, 0), ONE, NAMES)

    @property
    def value(self) -> Fraction | None:
        """The value of a constant one, else None."""
        p = self.polynomial
        return None if p is None or p.degree() > 0 else to_fraction(p[0])

    @property
    def is_periodic(self) -> bool:
        """Whether value and slope at s = 0 and s = 1 agree, as closed curves need."""
        p = self.polynomial
        if p is None:
            return True
        slope = p.derivative()
        return bool(p(0) == p(1) and slope(0) == slope(1))

    def require_beyond(self, bound: int, sign: int, what: str, remedy: str) -> None:
        """Raise `ValueError` where the function is not above (`sign` 1) or below (-1) a bound somewhere in [0, 1]."""
        p = self.polynomial
        if p is None:
            assert self.wave is not None
            low, high, start = self.wave
            ends = {start % 1.0: low, (start + 0.5) % 1.0: high}
            bad = [s for s, v in ends.items() if sign * (v - bound) <= 0]
        else:
            difference = (p - bound) * sign
            bad = [0.0] if difference(0) <= 0 else rounded_roots(difference, fmpq(0), fmpq(1))
        if bad:
            value = float(self(bad[0])) if p is None or p.degree() > 0 else plain(p[0])
            told = f"{value:.6g}" if isinstance(value, float) else short(value)
            place = "" if p is not None and p.degree() < 1 else f" at s = {bad[0]:.6g}"
            raise ValueError(f"{what} is {told}{place}; {remedy}")


ShapeLike: TypeAlias = ShapeFunction | Exact
"""What is taken for a shape function."""


@dataclass(frozen=True, init=False)
class GeneratrixShape:
    """What shapes a blend: lengths `l1`, `l2` of the control legs, slants `lambda1`, `lambda2`, a `middle` curve.

    Each of the four is a number or a `ShapeFunction`; a length None is chosen by the blend.  `middle`, where given,
    is the middle control curve of a quartic blend: three expressions in s, or a callable from (n,) to (n, 3).

    Raises `ValueError` for l <= 0 or lambda outside (-1, 1), saying where.
    """

    l1: ShapeFunction | None
    l2: ShapeFunction | None
    lambda1: ShapeFunction
    lambda2: ShapeFunction
    middle: CurveLike | None

    __repr__ = brief

    def __init__(
        self,
        l1: ShapeLike | None = None,
        l2: ShapeLike | None = None,
        lambda1: ShapeLike = 0,
        lambda2: ShapeLike = 0,
        middle: CurveLike | None = None,
    ) -> None:
        for name, value in (("l1", l1), ("l2", l2)):
            made = None if value is None else _function(value)
            if made is not None:
                made.require_beyond(0, 1, name, "it must be positive on all of [0, 1]")
            object.__setattr__(self, name, made)
        for name, value in (("lambda1", lambda1), ("lambda2", lambda2)):
            made = _function(value)
            for bound in (-1, 1):
                made.require_beyond(bound, -bound, name, "it must lie between -1 and 1")
            object.__setattr__(self, name, made)
        object.__setattr__(self, "middle", middle)

    def changed(self, **changes: ShapeLike | CurveLike | None) -> GeneratrixShape:
        """The shape with some of the five replaced; raises `TypeError` for another name."""
        names = (*FOUR, "middle")
        strange = sorted(set(changes) - set(names))
        if strange:
            raise TypeError(f"a shape has {', '.join(names)}, no {', '.join(strange)}")
        return GeneratrixShape(**({name: getattr(self, name) for name in names} | changes))

    def require_periodic(self) -> None:
        """Raise `ValueError` for functions that would tear or crease a closed blend at s = 0."""
        for name in FOUR:
            function = getattr(self, name)
            if function is not None and not function.is_periodic:
                raise ValueError(
                    f"{name} differs (or its slope does) between s = 0 and s = 1, but the curves are closed; "
                    "use ShapeFunction.cosine(low, high) or a constant"
                )


def _function(value: ShapeLike) -> ShapeFunction:
    return value if isinstance(value, ShapeFunction) else ShapeFunction.constant(value)
