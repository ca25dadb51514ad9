"""Rational curves with rational fields over Q, and what is decided of them exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isqrt

from flint import fmpq, fmpq_mpoly, fmpq_poly

from pas.algebra.inputs import shown
from pas.algebra.rational import Exact, rational, to_float
from pas.algebra.rational_function import GENERATORS, RationalFunction, total
from pas.errors import GeometryError
from pas.parametric.components import Components
from pas.parametric.roots import roots_between


def on_unit_interval(interval: Sequence[Exact], name: str) -> tuple[tuple[float, float], RationalFunction]:
    """The ends of an interval of s, and the map low + (high - low) s; raises `ValueError` for a bad one."""
    if isinstance(interval, str) or not hasattr(interval, "__len__") or len(interval) != 2:
        raise ValueError(f"the interval of {name} must be two numbers (low, high), not {shown(interval)}")
    low, high = (rational(end, f"an end of the interval of {name}") for end in interval)
    if not low < high:
        raise ValueError(f"the interval of {name} must have low < high, not {shown(interval)}")
    line = RationalFunction.quotient(GENERATORS[0] * (high - low) + low, GENERATORS[0] ** 0, ("s", "t"))
    return (to_float(low), to_float(high)), line


@dataclass(frozen=True)
class ExactCurve:
    """Three rational functions of s (`curve`), and the field along it: a normal where `has_normal`, else a tangent."""

    curve: Components
    field: Components
    has_normal: bool

    @cached_property
    def velocity(self) -> Components:
        """C'(s)."""
        x, y, z = (c.diff(1, 0) for c in self.curve)
        return x, y, z

    @cached_property
    def across(self) -> Components:
        """N x C', or V."""
        return exact_cross(self.field, self.velocity) if self.has_normal else self.field

    @cached_property
    def normal(self) -> Components:
        """N, or V x C'."""
        return self.field if self.has_normal else exact_cross(self.field, self.velocity)

    @property
    def lies_in_plane(self) -> bool:
        """Whether C' and the field across it are perpendicular to the normal, identically."""
        return all(exact_dot(v, self.normal).is_zero for v in (self.velocity, self.across))

    def require_regular(self, name: str) -> None:
        """Raise `GeometryError` where a pole, C' = 0 or a vanishing field lies in [0, 1]."""
        for part in (*self.curve, *self.field):
            _refuse(name, "a denominator vanishes", _zeros([part.denominator]))
        _refuse(name, "the curve is not regular; its derivative vanishes", _zeros([c.numerator for c in self.velocity]))
        what = "the surface's normal vanishes" if self.has_normal else "the tangent vector given vanishes"
        _refuse(name, what, _zeros([c.numerator for c in self.field]))
        if not self.has_normal:
            along = [c.numerator for c in exact_cross(self.field, self.velocity)]
            _refuse(name, "the tangent vector given is along the curve", _zeros(along))


def exact_cross(a: Sequence[RationalFunction], b: Sequence[RationalFunction]) -> Components:
    """The vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def exact_dot(a: Sequence[RationalFunction], b: Sequence[RationalFunction]) -> RationalFunction:
    """The scalar product."""
    return total([x * y for x, y in zip(a, b, strict=True)])


def square_root(value: fmpq) -> fmpq | None:
    """The root of a rational number >= 0 where that is rational, else None."""
    root = fmpq(isqrt(int(value.p)), isqrt(int(value.q)))
    return root if root * root == value else None


def in_s(polynomial: fmpq_mpoly) -> fmpq_poly:
    """A polynomial of the ring that depends on s alone, as one in one variable."""
    terms = {int(e[0]): c for e, c in polynomial.to_dict().items()}
    return fmpq_poly([terms.get(i, fmpq(0)) for i in range(max(terms, default=-1) + 1)])


def zeros_in_unit_interval(polynomial: fmpq_poly) -> list[float]:
    """The real zeros in [0, 1], rounded; whether they lie there is decided exactly."""
    if polynomial.degree() < 1:
        return []
    ends = [float(e) for e in (0, 1) if polynomial(e) == 0]
    return sorted([*ends, *roots_between(polynomial, fmpq(0), fmpq(1))])


def _zeros(polynomials: Sequence[fmpq_mpoly]) -> list[float]:
    """The common zeros in [0, 1] of polynomials in s; all of it, [0.0], where all are zero."""
    common = fmpq_poly([0])
    for polynomial in polynomials:
        common = common.gcd(in_s(polynomial))
    return [0.0] if common.is_zero() else zeros_in_unit_interval(common)


def _refuse(name: str, what: str, zeros: list[float]) -> None:
    if zeros:
        raise GeometryError(f"{name}: {what} at s = {zeros[0]:.6g}; choose another curve or interval")
