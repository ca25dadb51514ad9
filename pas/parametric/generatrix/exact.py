"""Rational curves with rational fields over Q, and what is decided of them exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import fmpq_mpoly, fmpq_poly

from pas.algebra.rational_function import RationalFunction, total
from pas.errors import GeometryError
from pas.parametric.series import Components, in_one, zeros_in_unit_interval


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
            _refuse(name, "a denominator vanishes", [part.denominator])
        _refuse(name, "the curve is not regular; its derivative vanishes", [c.numerator for c in self.velocity])
        what = "the surface's normal vanishes" if self.has_normal else "the tangent vector given vanishes"
        _refuse(name, what, [c.numerator for c in self.field])
        if not self.has_normal:
            _refuse(name, "the tangent vector given is along the curve", [c.numerator for c in self.normal])


def exact_cross(a: Sequence[RationalFunction], b: Sequence[RationalFunction]) -> Components:
    """The vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def exact_dot(a: Sequence[RationalFunction], b: Sequence[RationalFunction]) -> RationalFunction:
    """The scalar product."""
    return total([x * y for x, y in zip(a, b, strict=True)])


def _refuse(name: str, what: str, polynomials: Sequence[fmpq_mpoly]) -> None:
    """Raise `GeometryError` where polynomials in s have a common zero in [0, 1]."""
    common = fmpq_poly([0])
    for polynomial in polynomials:
        common = common.gcd(in_one(polynomial, 0))
    zeros = [0.0] if common.is_zero() else zeros_in_unit_interval(common)
    if zeros:
        raise GeometryError(f"{name}: {what} at s = {zeros[0]:.6g}; choose another curve or interval")
