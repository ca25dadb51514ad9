"""Curves and vectors along them as the user gives them: three expressions in s, one callable, or samples.

Rational curves with rational fields over Q are held exactly, and their zeros and poles are decided.  Samples are
interpolated by cubic splines (scipy), which also give any curve its length as parameter.  What is asked of a boundary
before it is used, that it is regular, closed as it says and has a plane at each s, is asked at samples.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
from flint import fmpq, fmpq_mpoly, fmpq_poly
from numpy.typing import ArrayLike

from pas.algebra.callables import ComponentLike, component
from pas.algebra.expressions import Names
from pas.algebra.inputs import check_count, shown
from pas.algebra.lengths import lengths, unit
from pas.algebra.polynomial import Polynomial
from pas.algebra.rational import Exact, cross, dot, rational, three, to_float
from pas.algebra.rational_function import GENERATORS, RationalFunction
from pas.algebra.roots import in_one
from pas.arrays import Floats
from pas.errors import GeometryError
from pas.parametric.series import Components, rounded_roots
from pas.parametric.surface import ParametricSurface, one_parameter

NAMES: Names = ("s", "t")

CurveLike: TypeAlias = "Sequence[ComponentLike] | Callable[[Floats], ArrayLike]"
"""What is taken for vectors along a curve: three expressions in s, or a callable from (n,) to (n, 3)."""

Curve = Callable[[Floats], Floats]
"""Vectors (n, 3), or numbers (n,), at parameters (n,)."""


CHECKED = np.linspace(0.0, 1.0, 257)
"""Parameters at which numeric data are checked."""

STILL = 1e-9
"""A derivative or field below this share of its largest value counts as zero: roundoff of differences is 1e-10."""

ON_SURFACE = 1e-8
"""Distance from its surface, over the curve's size, up to which a numeric curve counts as lying on it: data typed
with nine digits pass, a wrong formula does not."""


def on_unit_interval(interval: Sequence[Exact], name: str) -> tuple[tuple[float, float], RationalFunction]:
    """The ends of an interval of s, and the map low + (high - low) s; raises `ValueError` for a bad one."""
    check_count(interval, 2, f"the interval of {name} must be two numbers (low, high)", ValueError)
    low, high = (rational(end, f"an end of the interval of {name}") for end in interval)
    if not low < high:
        raise ValueError(f"the interval of {name} must have low < high, not {shown(interval)}")
    line = RationalFunction.quotient(GENERATORS[0] * (high - low) + low, GENERATORS[0] ** 0, NAMES)
    return (to_float(low), to_float(high)), line


def space_curve(expression: CurveLike, name: str) -> ParametricSurface:
    """A curve given by three expressions in s or one callable, as a surface that does not depend on t."""
    if callable(expression):
        coordinate = lambda axis: lambda s, _: np.asarray(expression(s), dtype=float)[..., axis]  # noqa: E731
        x, y, z = map(coordinate, range(3))
        return ParametricSurface(x, y, z, NAMES)
    if isinstance(expression, str) or not hasattr(expression, "__len__") or len(expression) != 3:
        raise TypeError(f"{name} must be three expressions in s or one callable, not {shown(expression)}")
    read = (
        component(one_parameter(e), ("s", ""), f"{axis} of {name}") for e, axis in zip(expression, "xyz", strict=True)
    )
    x, y, z = (made.formula if made.exact is None else made.exact for made in read)
    return ParametricSurface(x, y, z, NAMES)


def read_path(curve: CurveLike, interval: Sequence[Exact], name: str) -> ParametricSurface:
    """A curve as a surface in (s, t), t without influence, over 0 <= s <= 1."""
    (low, high), line = on_unit_interval(interval, name)
    path = space_curve(curve, name)
    if path.is_exact:
        x, y, z = (c.substitute(line, line) for c in path.components)
        return ParametricSurface(x, y, z, NAMES)
    return ParametricSurface.from_parts(
        lambda s, t: path.values(low + (high - low) * s, t), None, NAMES, None, path.inexact
    )


def value_at(path: ParametricSurface, s: Floats, order: int = 0) -> Floats:
    """Points, or derivatives in s of an order, (n, 3) at s (n,)."""
    return path.derivative(np.stack([s, np.zeros_like(s)], axis=-1), order, 0)


def splined(points: ArrayLike, normals: ArrayLike, closed: bool, name: str) -> tuple[Curve, Curve, Curve]:
    """C, C' and N as functions of s in [0, 1]: periodic or natural cubic splines over the chords' lengths.

    The interpolated normals are made perpendicular to C', which changes them between the samples, and at a sample only
    as far as they were not.  Raises `ValueError` for arrays of other shapes, `GeometryError` for repeated points.
    """
    from scipy.interpolate import CubicSpline

    p, n = (_samples(a, what, name) for a, what in ((points, "points"), (normals, "normals")))
    if len(p) != len(n):
        raise ValueError(f"{name} has {len(p)} points but {len(n)} normals; give one for each")
    number = len(p)
    if closed:
        p, n = np.concatenate([p, p[:1]]), np.concatenate([n, n[:1]])
    chords, sizes = lengths(np.diff(p, axis=0)), lengths(n)
    if not chords.min() > 1e-12 * chords.max():
        where = int(chords.argmin())
        raise GeometryError(f"{name}: points {where} and {(where + 1) % number} coincide; leave one out")
    if not sizes.min() > 0:
        raise GeometryError(f"{name}: normal {int(sizes.argmin())} is zero")
    s = np.concatenate([[0.0], np.cumsum(chords)])
    s /= s[-1]
    kind = "periodic" if closed else "natural"
    curve, field = CubicSpline(s, p, bc_type=kind), CubicSpline(s, unit(n), bc_type=kind)
    velocity = curve.derivative()

    def direction(at: Floats) -> Floats:
        along, raw = np.nan_to_num(unit(velocity(at))), field(at)
        return np.asarray(raw - (raw * along).sum(axis=1)[:, None] * along)

    return curve, velocity, direction


def _samples(values: ArrayLike, what: str, name: str) -> Floats:
    array = np.asarray(values, dtype=float)
    if array.ndim != 2 or array.shape[1] != 3 or len(array) < 4:
        raise ValueError(f"{what} of {name} must have shape (n, 3) with n >= 4, not {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{what} of {name} must be finite")
    return array


def by_length(speed: Curve, closed: bool) -> tuple[Curve, Curve]:
    """For |C'| as a function of u in [0, 1]: u as a function of the share s of the length, and du/ds.

    Lengths by Simpson's rule, their inverse by a cubic spline of u - s (periodic for closed curves).
    """
    from scipy.interpolate import CubicSpline

    u = np.linspace(0.0, 1.0, 1025)
    at = speed(u)
    pieces = (at[1:] + at[:-1] + 4 * speed((u[1:] + u[:-1]) / 2)) / 6
    s = np.concatenate([[0.0], np.cumsum(pieces)]) / pieces.sum()
    s[-1] = 1.0
    away = u - s
    away[-1] = away[0]
    inverse = CubicSpline(s, away, bc_type="periodic" if closed else "not-a-knot")
    slope = inverse.derivative()
    return lambda s: s + inverse(s), lambda s: 1.0 + slope(s)


@dataclass(frozen=True)
class ExactCurve:
    """Three rational functions of s (`curve`), and the field along it: a normal where `has_normal`, else a tangent."""

    curve: Components
    field: Components
    has_normal: bool

    @cached_property
    def velocity(self) -> Components:
        """C'(s)."""
        return three(c.diff(1, 0) for c in self.curve)

    @cached_property
    def across(self) -> Components:
        """N x C', or V."""
        return cross(self.field, self.velocity) if self.has_normal else self.field

    @cached_property
    def normal(self) -> Components:
        """N, or V x C'."""
        return self.field if self.has_normal else cross(self.field, self.velocity)

    @property
    def lies_in_plane(self) -> bool:
        """Whether C' and the field across it are perpendicular to the normal, identically."""
        return all(dot(v, self.normal).is_zero for v in (self.velocity, self.across))

    def require_regular(self, name: str) -> None:
        """Raise `GeometryError` where a pole, C' = 0 or a vanishing field lies in [0, 1]."""
        for part in (*self.curve, *self.field):
            _refuse(name, "a denominator vanishes", [part.denominator])
        _refuse(name, "the curve is not regular; its derivative vanishes", [c.numerator for c in self.velocity])
        what = "the surface's normal vanishes" if self.has_normal else "the tangent vector given vanishes"
        _refuse(name, what, [c.numerator for c in self.field])
        if not self.has_normal:
            _refuse(name, "the tangent vector given is along the curve", [c.numerator for c in self.normal])


def _refuse(name: str, what: str, polynomials: Sequence[fmpq_mpoly]) -> None:
    """Raise `GeometryError` where polynomials in s have a common zero in [0, 1]."""
    common = fmpq_poly([0])
    for polynomial in polynomials:
        common = common.gcd(in_one(polynomial, 0))
    zeros = [0.0] if common.is_zero() else rounded_roots(common, fmpq(0), fmpq(1))
    if zeros:
        raise GeometryError(f"{name}: {what} at s = {zeros[0]:.6g}; choose another curve or interval")


def require_boundary(name: str, curve: Curve, velocity: Curve, field: Curve, has_normal: bool, closed: bool) -> None:
    """Raise `GeometryError` where a curve, its C' and the field along it are no boundary of a blend, saying where."""
    points, slopes, vectors = (np.asarray(f(CHECKED)) for f in (curve, velocity, field))
    for what, array in (("the curve", points), ("its derivative", slopes), ("the surface's direction", vectors)):
        bad = np.flatnonzero(~np.isfinite(array).all(axis=-1))
        if len(bad):
            raise GeometryError(f"{name}: {what} is not finite at s = {CHECKED[bad[0]]:.6g}; choose another interval")
    size, far = float(np.ptp(points, axis=0).max()), float(np.abs(points).max())
    if 0 < size < 1e-280 or far > 1e280:  # near the ends of the range of doubles digits are lost
        raise GeometryError(
            f"{name} is {size:.2g} long and {far:.2g} away from the origin; blends by a generatrix are made from "
            "1e-280 to 1e+280: choose another unit of length"
        )
    _require_positive(lengths(slopes), f"{name}: the curve is not regular; its derivative vanishes")
    what = "surface's normal" if has_normal else "tangent vector given"
    _require_positive(lengths(vectors), f"{name}: the {what} vanishes")
    sine = lengths(np.cross(unit(vectors), unit(slopes)))
    if not has_normal:
        _require_positive(sine, f"{name}: the tangent vector given is along the curve")
    slant = np.sqrt(np.maximum(0.0, 1.0 - sine**2))
    worst = int(slant.argmax())
    if has_normal and slant[worst] > np.sqrt(ON_SURFACE):
        raise GeometryError(
            f"{name}: the normal is not perpendicular to the curve at s = {CHECKED[worst]:.4g} "
            f"(cosine {slant[worst]:.2g})"
        )
    if closed:
        _require_closed(points, slopes, vectors, name)


def require_on(f: Polynomial, path: ParametricSurface, name: str) -> None:
    """Raise `GeometryError` where a numeric curve is off the surface f = 0."""
    points = value_at(path, CHECKED)
    with np.errstate(all="ignore"):
        away = np.abs(f(points)) / np.maximum(lengths(f.gradient(points)), 1e-300)
    worst = int(np.nanargmax(away))
    if not away[worst] <= 2 * ON_SURFACE * np.abs(points).max():
        raise GeometryError(f"{name}: the curve is off the surface by {away[worst]:.2g} at s = {CHECKED[worst]:.4g}")


def closes(points: Floats) -> bool:
    """Whether the first and the last of the points (n, 3) along a curve agree, as measured by all of them."""
    with np.errstate(all="ignore"):
        return bool(np.abs(points[0] - points[-1]).max() <= STILL * np.abs(points).max())


def _require_positive(values: Floats, message: str) -> None:
    worst = int(values.argmin())
    if not values[worst] > STILL * values.max():
        raise GeometryError(f"{message} at s = {CHECKED[worst]:.6g}")


def _require_closed(points: Floats, velocity: Floats, vectors: Floats, name: str) -> None:
    if not closes(points):
        gap = float(np.linalg.norm(points[0] - points[-1]))
        raise GeometryError(f"{name} is called closed, but its ends are {gap:.3g} apart; say closed=False")
    for array, message in (
        (velocity, " has a corner at s = 0 where it closes; say closed=False, or round it"),
        (vectors, ": the surface's direction at s = 0 and s = 1 differ, though the curve is closed"),
    ):
        first, last = unit(array[[0, -1]])
        if float(first @ last) < 1.0 - 1e-6:
            raise GeometryError(name + message)
