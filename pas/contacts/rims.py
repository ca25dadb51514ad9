"""Rims: the closed curves in which contacts meet their blends, where these are plane curves.

A contact (f, h) meets its blend along V(f, h).  Where one of the two is a plane, as the clip of a pipe or a plate
itself, the other is restricted to it and taken apart over the rationals.  An ellipse has an exact centre, and its
semi-axes follow from two eigenvalues (Salmon 1879); ovals of factors of higher degree are followed (see
`pas.contacts.ovals`).

Guaranteed: plane and centre are exact, and points are on the curve to rounding.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import atan2, copysign, cos, prod, sin, sqrt

import numpy as np
from flint import fmpq

from pas.algebra.affine import height, slope_at
from pas.algebra.brief import brief
from pas.algebra.ideal import Ideal
from pas.algebra.inputs import short, shown_point
from pas.algebra.polynomial import GENERATORS, Polynomial
from pas.algebra.rational import (
    Vector,
    VectorLike,
    binary_exponent,
    dot,
    exact,
    moved,
    three,
    to_float,
    to_floats,
    two_across,
    vector,
)
from pas.algebra.scaling import Scaled, scaled
from pas.algebra.zeros import RealZero, real_zeros
from pas.arrays import Floats
from pas.contacts.ovals import Oval, Strip, ovals
from pas.errors import GeometryError

USUAL_POINTS = 64
"""The number of points of a rim, unless another one is asked for."""

DIRECTIONS = ((fmpq(7), fmpq(-5)), (fmpq(3), fmpq(8)))
"""Linear forms a s + b t in the plane's coordinates: where they are greatest and least ovals are looked for."""

LINES = (fmpq(0), fmpq(1), fmpq(-3, 2), fmpq(10))
"""Values of s and t on whose lines a curve without ovals is looked for, to tell an open one from none."""


@dataclass(frozen=True, eq=False)
class Ellipse:
    """An ellipse by its centre and its semi-axes as vectors (3,), the longer one first, rounded to doubles."""

    center: Floats
    semiaxes: tuple[Floats, Floats]

    __repr__ = brief

    def points(self, number: int) -> Floats:
        """Points (number, 3) of the ellipse, at equal angles of the circle whose affine image it is."""
        angles = np.arange(number) * (2 * np.pi / number)
        first, second = self.semiaxes
        return np.asarray(self.center + np.cos(angles)[:, None] * first + np.sin(angles)[:, None] * second)


@dataclass(frozen=True, eq=False)
class Rim:
    """The closed curve of a contact and its plane.

    `center` is an exact point of the plane: the centre of an ellipse, else one near the centroid of what the curve
    encloses.  `normal` is the plane's, exact, of any length, and points away from the blend.  `curve` is the closed
    curve.
    """

    center: Vector
    normal: Vector
    curve: Ellipse | Oval

    __repr__ = brief

    def points(self, number: int = USUAL_POINTS) -> Floats:
        """Points (number, 3) of the curve to rounding, in order, counterclockwise seen from the tip of the normal."""
        return self.curve.points(number)

    @property
    def semiaxes(self) -> tuple[Floats, Floats] | None:
        """The semi-axes of an ellipse as vectors (3,), the longer one first; None for another curve."""
        return self.curve.semiaxes if isinstance(self.curve, Ellipse) else None

    @cached_property
    def plane(self) -> Polynomial:
        """The plane as a polynomial that is negative on the blend's side."""
        return Polynomial.from_raw(height(self.center, self.normal))

    @cached_property
    def radii(self) -> tuple[float, float]:
        """The least and the largest distance of the curve from its centre; both the radius of a circle."""
        if self.semiaxes is not None:
            longer, shorter = (float(np.linalg.norm(axis)) for axis in self.semiaxes)
            return shorter, longer
        away = np.linalg.norm(self.points(4 * USUAL_POINTS) - np.array(to_floats(self.center)), axis=1)
        return float(away.min()), float(away.max())


def outlook(surface: Polynomial, rim: Rim, center: VectorLike) -> tuple[float, Floats]:
    """How a surface is seen from a point along a rim, and where it is seen worst.

    The least cosine between the surface's gradient and the line of sight at points of the rim: a surface that rays from
    `center` (three numbers) leave along the whole rim has a positive one.  With one that is not no blend meets each ray
    once: the centre must be nearer to the rim's plane, or the clip where the surface opens.  Measured, not proved.
    """
    points = rim.points()
    sight = points - np.array(to_floats(vector(center, "center")))
    slopes = scaled(surface).gradient(points)
    cosines = (slopes * sight).sum(axis=1) / (np.linalg.norm(slopes, axis=1) * np.linalg.norm(sight, axis=1))
    worst = int(cosines.argmin())
    return float(cosines[worst]), points[worst]


@dataclass(frozen=True)
class PlaneChart:
    """Exact coordinates (s, t) in a plane: `origin + s first + t second`, the two vectors across one another."""

    normal: Vector
    origin: Vector
    first: Vector
    second: Vector

    @classmethod
    def of(cls, plane: Polynomial) -> PlaneChart:
        """The chart of a plane, a polynomial of degree 1; its origin is the point next to the origin of space."""
        slope = Scaled.of([plane - plane.at((0, 0, 0))])
        normal = slope_at(slope.polynomials[0])
        share = -plane.raw(0, 0, 0) / fmpq(2) ** slope.exponent / dot(normal, normal)
        (a, b, c), (d, e, f) = two_across(normal)
        return cls(normal, three(share * n for n in normal), (-a, -b, -c), (-d, -e, -f))

    def point(self, s: fmpq, t: fmpq) -> Vector:
        """The point with given coordinates."""
        return moved(self.origin, (s, self.first), (t, self.second))

    def restricted(self, polynomial: Polynomial) -> Polynomial:
        """A polynomial on the plane, as one in x = s and y = t."""
        s, t, _ = GENERATORS
        images = (s * a + t * b + o for o, a, b in zip(self.origin, self.first, self.second, strict=True))
        return polynomial.compose(*map(Polynomial.from_raw, images))

    def extended(self, polynomial: Polynomial) -> Polynomial:
        """A polynomial in s and t as one of space, constant along the normal."""
        s, t = (height(self.origin, axis) * (1 / dot(axis, axis)) for axis in (self.first, self.second))
        return polynomial.compose(Polynomial.from_raw(s), Polynomial.from_raw(t), Polynomial(0))


def rim_of(surface: Polynomial, clip: Polynomial, near: VectorLike | None = None) -> Rim:
    """The closed curve where a clip cuts a surface, one of which is a plane.

    Of several closed curves the one that comes next to the point `near` (three numbers) is taken.

    Raises `GeometryError` where the curve is empty, open, singular, not known to be plane, or where there are several
    and nothing is said of which one is meant.
    """
    words = f"the clip {short(str(clip))} cuts the surface {short(str(surface))}"
    if clip.degree != 1 and surface.degree != 1:
        raise GeometryError(
            f"{words} in a curve that is in no plane; a rim needs a clip, or a surface, that is a plane"
        )
    plane, other = (clip, surface) if clip.degree == 1 else (-surface, clip)
    chart = PlaneChart.of(plane)
    restricted = chart.restricted(other)
    found: list[Rim] = []
    branches = set[str]()
    for factor, times in restricted.raw.factor()[1]:
        rims, kind = _closed(Polynomial.from_raw(factor), chart)
        branches.add(kind)
        if rims and times > 1:
            raise GeometryError(f"{words} nowhere at an angle, but touches it along a closed curve; the two must cross")
        found += rims
    if not found:
        kind = next((k for k in ("a curve that is not closed", "a single point") if k in branches), "no real point")
        raise GeometryError(f"{words} in {kind}; a contact needs a closed curve")
    chosen = _chosen(found, near, words)
    _check_regular(restricted, chart, chosen, words)
    return chosen


def _chosen(found: list[Rim], near: VectorLike | None, words: str) -> Rim:
    if near is not None:
        target = np.array(to_floats(vector(near, "near")))
        return min(found, key=lambda rim: float(np.linalg.norm(rim.points() - target, axis=1).min()))
    if len(found) > 1:
        places = ", ".join(shown_point(rim.center) for rim in found)
        raise GeometryError(f"{words} in {len(found)} closed curves, around {places}; say near which point yours is")
    return found[0]


def _closed(factor: Polynomial, chart: PlaneChart) -> tuple[list[Rim], str]:
    """The closed curves of an irreducible plane curve, and in words what else it has."""
    if factor.degree == 1:
        return [], "a curve that is not closed"
    if factor.degree == 2:
        return _conic(factor, chart)
    strips = _strips(factor, chart)
    branches, opened = (
        ovals(chart.extended(factor), np.array(to_floats(chart.normal)), strips) if strips else ([], False)
    )
    rims = [Rim(_rounded(oval.centroid(), oval.polygon, chart), chart.normal, oval) for oval in branches]
    return rims, "a curve that is not closed" if opened or _met(factor) else "no real point"


def _conic(factor: Polynomial, chart: PlaneChart) -> tuple[list[Rim], str]:
    """The rim that is an ellipse `a s^2 + 2 b s t + c t^2 = k` around its centre, or in words what it is instead."""
    a, b, c = (factor.diff(i).diff(j).raw(0, 0, 0) / 2 for i, j in ((0, 0), (0, 1), (1, 1)))
    d, e = (factor.diff(i).raw(0, 0, 0) / 2 for i in (0, 1))
    determinant = a * c - b * b
    if determinant <= 0:  # at 0 it may be two parallel lines that are not real
        return [], "a curve that is not closed" if _met(factor) else "no real point"
    s, t = (b * e - c * d) / determinant, (b * d - a * e) / determinant
    k = -factor.raw(s, t, 0)
    if k * a <= 0:
        return [], "a single point" if k == 0 else "no real point"
    center = chart.point(s, t)
    semiaxes = _semiaxes((a / k, b / k, c / k), chart)
    return [Rim(center, chart.normal, Ellipse(np.array(to_floats(center)), semiaxes))], ""


def _semiaxes(form: tuple[fmpq, fmpq, fmpq], chart: PlaneChart) -> tuple[Floats, Floats]:
    """The semi-axes of `a s^2 + 2 b s t + c t^2 = 1`, the longer one first, counterclockwise.

    Of the form in unit vectors the difference of the diagonal, the product of the rest and the determinant are
    exact before they are rounded, so that a circle is one and slender ellipses lose nothing.
    """
    a, b, c = form
    e, f = dot(chart.first, chart.first), dot(chart.second, chart.second)
    a, c, across = a / e, c / f, b * b / (e * f)
    skew = copysign(sqrt(to_float(across)), to_float(b))
    half = sqrt(to_float((a - c) * (a - c) / 4 + across))
    large = to_float((a + c) / 2) + half
    small = to_float(a * c - across) / large
    angle = atan2(2 * skew, to_float(a - c)) / 2 if half else 0.0
    u, v = (np.array(to_floats(axis)) / sqrt(to_float(dot(axis, axis))) for axis in (chart.first, chart.second))
    # across the direction of the larger eigenvalue, turned back by a quarter
    longer, shorter = sin(angle) * u - cos(angle) * v, cos(angle) * u + sin(angle) * v
    return longer / sqrt(small), shorter / sqrt(large)


def _strips(factor: Polynomial, chart: PlaneChart) -> list[Strip]:
    """The strips of two directions with the regular points at which these are stationary along a curve that is no line.

    None where there are no such points, and so no ovals.
    """
    slopes, flat, strips = (factor.diff(0), factor.diff(1)), Polynomial("z"), []
    for a, b in DIRECTIONS:
        zeros = real_zeros(Ideal(factor, slopes[0] * b - slopes[1] * a, flat)) or ()
        points = [_place(zero, chart) for zero in zeros if any(zero.sign(slope) for slope in slopes)]
        if not points:
            return []
        scaled = [(axis, w / dot(axis, axis)) for axis, w in ((chart.first, a), (chart.second, b))]
        direction = [sum((axis[i] * w for axis, w in scaled), fmpq(0)) for i in range(3)]
        strips.append(Strip(np.array(to_floats(direction)), np.array(points)))
    return strips


def _place(zero: RealZero, chart: PlaneChart) -> Floats:
    s, t, _ = map(exact, zero.point)
    return np.array(to_floats(chart.point(s, t)))


def _met(factor: Polynomial) -> bool:
    """Whether some lines meet a plane curve."""
    lines: Iterator[Polynomial] = (Polynomial.from_raw(g - v) for g in GENERATORS[:2] for v in LINES)
    return any(real_zeros(Ideal(factor, line, Polynomial("z"))) for line in lines)


def _rounded(point: Floats, polygon: Floats, chart: PlaneChart) -> Vector:
    """An exact point of the plane near one in doubles."""
    # Binary digits of the centre of a curve that is no ellipse: any point near its centroid will do, a short one
    # best.
    digits = 12
    away = point - np.array(to_floats(chart.origin))
    size = float(np.ptp(polygon, axis=0).max())
    coordinates = []
    for axis in (chart.first, chart.second):
        vector_, square = np.array(to_floats(axis)), to_float(dot(axis, axis))
        step = fmpq(2) ** (binary_exponent(exact(size / sqrt(square))) - digits)
        coordinates.append(fmpq(round(float(away @ vector_) / square / to_float(step))) * step)
    return chart.point(*coordinates)


def _check_regular(restricted: Polynomial, chart: PlaneChart, rim: Rim, words: str) -> None:
    """Raise `GeometryError` for a singular point of the whole plane curve, as where two components cross, on a rim."""
    if restricted.degree < 3:
        return
    product = prod((Polynomial.from_raw(p) for p, _ in restricted.raw.factor()[1]), start=Polynomial(1))
    singular = real_zeros(Ideal(product, product.diff(0), product.diff(1), Polynomial("z"))) or ()
    points = rim.points(8 * USUAL_POINTS) if singular else np.empty((0, 3))
    for place in (_place(zero, chart) for zero in singular):
        spacing = np.linalg.norm(np.diff(points, axis=0), axis=1).max()
        if np.linalg.norm(points - place, axis=1).min() <= spacing:
            raise GeometryError(f"{words} in a curve with a singular point at {shown_point(place, 6)}")
