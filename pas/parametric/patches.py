"""Rational tensor-product patches, Bezier and B-spline, and exact surfaces as such.

    x(u, v) = sum w_ij N_i(u) N_j(v) p_ij / sum w_ij N_i(u) N_j(v)

N_i are the B-splines of clamped knots, each end as often as the degree and once more; with no other knots they are the
Bernstein polynomials of the interval.  Over a rectangle an exact surface is a rational Bezier patch over its least
common denominator; weights are the denominator's Bernstein coefficients.  Where these are not all positive the
rectangle is halved: if the denominator has no zero they become positive.

Guaranteed: a patch of an exact surface keeps its control points and weights as fractions, and `surface` gives back the
same rational functions; that of any Bezier patch is exact for the doubles that it has.  Weights are positive, so the
patch has no pole and lies in the convex hull of its control points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any, Unpack

import numpy as np
from flint import fmpq
from numpy.typing import ArrayLike

from pas.algebra.brief import brief
from pas.algebra.callables import on_series
from pas.algebra.expressions import Names
from pas.algebra.inputs import set_fields, short
from pas.algebra.rational import Exact, plain, rational, three, to_float, to_fraction
from pas.algebra.rational_function import GENERATORS, ONE, PARAMETERS, RationalFunction
from pas.arrays import AnyArray, Floats
from pas.errors import GeometryError
from pas.limits import WorkLimits, checkpoint, limited
from pas.mesh.mesh import Mesh
from pas.mesh.quality import Quality
from pas.parametric.maps import DomainLike
from pas.parametric.nets import ExactNet, bernstein_polynomials, exact_net, exact_rectangle
from pas.parametric.series import Components
from pas.parametric.surface import ParametricSurface
from pas.shape import Shape
from pas.verdicts import Findings

Knots = tuple[Floats, Floats]


@dataclass(frozen=True, eq=False)
class ExactControl:
    """Control points (m+1, n+1, 3), weights (m+1, n+1) and the rectangle's ends (2, 2) as arrays of fractions."""

    points: AnyArray
    weights: AnyArray
    rectangle: AnyArray


@dataclass(frozen=True, eq=False, repr=False)
class RationalPatch(Shape):
    """A rational patch with control points (r, s, 3) and positive weights (r, s) (Piegl and Tiller 1997, 3 and 4).

    `knots` are two clamped knot vectors, of lengths r + m + 1 and s + n + 1 for the degrees (m, n); without them the
    patch is a Bezier patch on [0, 1]^2.  `exact` is what the doubles stand for, where that is known.

    Raises `ValueError` for other shapes, numbers that are not finite, weights that are not positive or bad knots.
    """

    points: Floats
    weights: Floats
    knots: Knots = ()  # type: ignore[assignment]  # filled in below
    exact: ExactControl | None = None
    kind = "rational patch"

    __repr__ = brief

    def __post_init__(self) -> None:
        points, weights = np.array(self.points, dtype=float), np.array(self.weights, dtype=float)
        if points.ndim != 3 or points.shape[2] != 3 or weights.shape != points.shape[:2]:
            raise ValueError(
                "points and weights must have shapes (m+1, n+1, 3) and (m+1, n+1), "
                f"not {points.shape} and {weights.shape}"
            )
        if not np.isfinite(points).all() or not np.isfinite(weights).all() or not (weights > 0).all():
            raise ValueError("points must be finite, and weights finite and positive")
        given = self.knots or tuple(np.repeat([0.0, 1.0], size) for size in weights.shape)
        knots = tuple(_checked(k, size, name) for k, size, name in zip(given, weights.shape, "uv", strict=True))
        set_fields(self, points=points, weights=weights, knots=knots)

    @cached_property
    def certificate(self) -> Findings:
        """The verdict of `pas.regularity` on the patch as a surface."""
        return self.surface().certificate

    @limited("meshing a surface", "a coarser tolerance")
    def mesh(
        self,
        tolerance: Exact | None = None,
        domain: DomainLike = None,
        *,
        quality: Quality | str = Quality.BALANCED,
        **limits: Unpack[WorkLimits],
    ) -> Mesh:
        """The patch's mesh, over a part of its domain, too; see `ParametricSurface.mesh`."""
        return self.surface().mesh(tolerance, domain, quality=quality)

    @property
    def degrees(self) -> tuple[int, int]:
        """The degrees in u and v."""
        m, n = (len(k) - size - 1 for k, size in zip(self.knots, np.shape(self.weights), strict=True))
        return m, n

    @property
    def is_bezier(self) -> bool:
        """Whether there are no knots but the ends."""
        return all(len(k) == 2 * (d + 1) for k, d in zip(self.knots, self.degrees, strict=True))

    @property
    def domain(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The ends of the knots."""
        u, v = self.knots
        return (float(u[0]), float(u[-1])), (float(v[0]), float(v[-1]))

    @property
    def control_points(self) -> AnyArray:
        """The control points (r, s, 3): fractions where they are exact, else doubles."""
        return self.points if self.exact is None else self.exact.points

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """Points (..., 3) at parameters within the knots that broadcast to (...)."""
        four = self._homogeneous(u, v)
        return np.asarray(four[..., :3] / four[..., 3:])

    def surface(self, parameters: Names = PARAMETERS) -> ParametricSurface:
        """The patch as a parametric surface: exact for a Bezier patch, else one that can be evaluated."""
        if not self.is_bezier:
            reason = "a B-spline with inner knots is no rational function"
            return ParametricSurface.from_parts(self._values, None, parameters, self.domain, reason)
        return ParametricSurface(*self._components(parameters), parameters=parameters, domain=self.domain)

    def __str__(self) -> str:
        m, n = self.degrees
        rows, columns = np.shape(self.weights)
        kind = "Bezier" if self.is_bezier else "B-spline"
        return f"a rational {kind} patch of degrees ({m}, {n}), {rows} x {columns} control points"

    def _homogeneous(self, u: ArrayLike, v: ArrayLike, *orders: int) -> Floats:
        """Partial derivatives of weight times point, and of the weight (..., 4), at u, v that broadcast."""
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        table = np.concatenate([self.points * self.weights[..., None], self.weights[..., None]], axis=-1)
        if any(order > degree for order, degree in zip(orders, self.degrees, strict=False)):
            return np.zeros((*u.shape, 4))
        from scipy.interpolate import NdBSpline

        return np.asarray(
            NdBSpline(self.knots, table, self.degrees)(np.stack([u, v], axis=-1), nu=list(orders) or None)
        )

    def _values(self, t: Any, h: Any) -> tuple[Any, ...]:
        """Coordinates at arrays or Taylor series."""
        x, y, z, w = on_series(self._homogeneous, 4)(t, h)
        return x / w, y / w, z / w

    def _components(self, names: Names) -> Components:
        exact = self.exact
        points, weights = (self.points, self.weights) if exact is None else (exact.points, exact.weights)
        ends = np.array(self.domain) if exact is None else exact.rectangle
        first, second = (
            enumerate(bernstein_polynomials(d, g, *map(rational, e)))
            for d, g, e in zip(self.degrees, GENERATORS, ends, strict=True)
        )
        terms = [(f * g * rational(weights[i, j]), points[i, j]) for (i, f), (j, g) in product(first, second)]
        below = sum((term for term, _ in terms), ONE * 0)
        tops = (sum((term * rational(p[axis]) for term, p in terms), ONE * 0) for axis in range(3))
        return three(RationalFunction.quotient(top, below, names) for top in tops)


def _checked(knots: Any, size: int, name: str) -> Floats:
    array = np.array(knots, dtype=float)
    degree = len(array) - size - 1 if array.ndim == 1 else 0
    if degree < 1 or degree >= size:
        raise ValueError(f"degrees must be from 1 to the number of control points - 1; in {name} it is {degree}")
    clamped = (array[: degree + 1] == array[0]).all() and (array[-degree - 1 :] == array[-1]).all()
    if not (np.isfinite(array).all() and (np.diff(array) >= 0).all() and clamped and array[0] < array[-1]):
        raise ValueError(f"the knots of {name} must not fall, with each end {degree + 1} times")
    return array


def bezier_patch(surface: ParametricSurface, domain: DomainLike = None) -> RationalPatch:
    """The exact rational Bezier patch of an exact surface over a rectangle of rational numbers.

    `domain` is by default the surface's own, None for an interval or an end that is its own.  Raises `ValueError` for a
    surface that is not exact or an infinite domain, `GeometryError` where a weight is not positive: then
    `bezier_patches` gives several patches, if there is no pole (Farouki and Rajan 1988).
    """
    net = exact_net(surface, exact_rectangle(surface, domain))
    least = net.weights.min()
    if least <= 0:
        raise GeometryError(
            f"a weight of this patch is not positive ({short(plain(least))}); bezier_patches splits it into several"
        )
    return _patch(net)


@limited("splitting a surface into patches", "a smaller domain")
def bezier_patches(
    surface: ParametricSurface, domain: DomainLike = None, **limits: Unpack[WorkLimits]
) -> tuple[RationalPatch, ...]:
    """Exact rational Bezier patches of positive weights that cover a rectangle; one where that is possible.

    The rectangle is halved until all weights are positive (Farouki and Rajan 1988).

    Raises what `bezier_patch` raises, but `GeometryError` only for a pole.
    """
    pending = [(exact_net(surface, exact_rectangle(surface, domain)), 0)]
    found: list[RationalPatch] = []
    while pending:
        net, depth = pending.pop()
        checkpoint("splitting a surface into patches")
        if net.weights.min() > 0:
            found.append(_patch(net))
            continue
        if depth >= 16 or net.weights[[0, 0, -1, -1], [0, -1, 0, -1]].min() <= 0:  # by then there is a zero
            place = ", ".join(
                f"{name} = {to_float((a + b) / 2):.6g}"
                for name, (a, b) in zip(surface.parameters, net.rectangle, strict=True)
            )
            raise GeometryError(
                f"the surface has, or nearly has, a pole or base point near {place}; give a domain that avoids it"
            )
        pairs = net.halves(0), net.halves(1)  # that is taken in which the least weight over the greatest is most
        best = max(pairs, key=lambda pair: min(half.weights.min() / np.abs(half.weights).max() for half in pair))
        pending += [(half, depth + 1) for half in reversed(best)]
    return tuple(found)


def _patch(net: ExactNet) -> RationalPatch:
    """The patch of a net; weights are as they are unless doubles would not hold them, then over the greatest."""
    least, greatest, lightest = net.weights.min(), net.weights.max(), fmpq(1, 10**100)
    if least / greatest < lightest:
        raise GeometryError(
            "the weights of this patch differ by more than a factor of 1e+100; convert a part of the domain where the "
            "denominators vary less"
        )
    scale = fmpq(1) if least > lightest and greatest < 1 / lightest else greatest
    fractions = np.vectorize(to_fraction, otypes=[object])
    points, weights = fractions(net.table[..., :3] / net.weights[..., None]), fractions(net.weights / scale)
    ends = fractions(np.array(net.rectangle))
    knots = tuple(np.repeat(e, size) for e, size in zip(_doubles(ends), weights.shape, strict=True))
    exact = ExactControl(points, weights, ends)
    return RationalPatch(_doubles(points), _doubles(weights), (knots[0], knots[1]), exact)


def _doubles(numbers: Any) -> Floats:
    """An array of fractions in doubles; raises `GeometryError` where one is beyond their range."""
    found = np.vectorize(lambda x: to_float(rational(x)), otypes=[float])(numbers)
    if not np.isfinite(found).all():
        raise GeometryError("a control point is beyond the range of doubles (1.8e308); scale the surface")
    return np.asarray(found)
