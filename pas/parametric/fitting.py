"""B-splines within a tolerance of parametric surfaces.

Guaranteed: `fit_patch` of an exact surface is certified: S being the B-spline and N / D the surface, the Bernstein
coefficients of N - D S over the least of D's bound the distance on each rectangle between knots, and rounding is
counted in.  For other surfaces the distance is measured at DENSE points for each of these and each parameter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb, factorial
from typing import Unpack

import numpy as np
from flint import fmpq

from pas.algebra.brief import brief
from pas.algebra.inputs import shown
from pas.algebra.lengths import lengths
from pas.algebra.rational import Exact, check_tolerance, exact, to_float
from pas.arrays import Floats
from pas.bernstein.forms import UNIT_ROUNDOFF
from pas.errors import GeometryError
from pas.limits import WorkLimits, checkpoint, limited
from pas.parametric.maps import DomainLike, ParametricMap
from pas.parametric.meshing import distances
from pas.parametric.nets import Framed, Nets, exact_net, exact_rectangle
from pas.parametric.patches import Knots, RationalPatch
from pas.parametric.surface import ParametricSurface
from pas.settings import RELATIVE_TOLERANCE
from pas.shape import Shape

DEGREE, DENSE = 3, 6
"""Of B-splines in both parameters, and points for each span at which surfaces that are not exact are compared."""

MOST = 512
"""Spans of a B-spline in one parameter."""


@dataclass(frozen=True, eq=False)
class FittedPatch(RationalPatch):
    """A B-spline with its distance from the surface, at equal parameters: proved where `certified`, else measured."""

    deviation: float = 0.0
    certified: bool = False

    __repr__ = brief


@limited("fitting a patch", "a coarser tolerance or a smaller domain")
def fit_patch(
    surface: Shape,
    tolerance: Exact | None = None,
    domain: DomainLike = None,
    **limits: Unpack[WorkLimits],
) -> FittedPatch:
    """A bicubic B-spline nowhere further than `tolerance` (the model's units) from the surface.

    By default a thousandth of its extent.  For a blend, of its `surface`.  It interpolates at the Greville abscissae of
    uniform knots (Farin 2002).

    Raises `TypeError` for what is no surface, `ValueError` for an infinite domain, `GeometryError` for a pole or where
    MOST spans do not suffice.
    """
    whole = surface if isinstance(surface, ParametricSurface) else getattr(surface, "surface", None)
    if not isinstance(whole, ParametricSurface):
        raise TypeError(f"surface must be a parametric surface or a blend of such, not {shown(surface)}")
    rectangle = exact_rectangle(whole, domain)
    framed = Framed.of(whole.with_domain(rectangle))
    aim = RELATIVE_TOLERANCE * framed.size if tolerance is None else framed.inside(check_tolerance(tolerance))
    nets = exact_net(framed.bounded, rectangle, framed).rounded() if whole.is_exact else None
    spans = [_spans(framed.surface, axis, 0.4 * aim) for axis in (0, 1)]  # a share for each parameter
    while True:
        knots, points = _interpolated(framed.surface, spans)
        outer, moved = zip(*(_outer(k, e) for k, e in zip(knots, rectangle, strict=True)), strict=True)
        away = _compared(framed.surface, knots, points) if nets is None else _bound(nets, knots, points, moved)
        control, rounding = framed.points_outside(points)
        away += rounding
        deviation, ends = framed.outside(away), (outer[0], outer[1])
        if away <= aim:
            return FittedPatch(control, np.ones(points.shape[:2]), ends, None, deviation, nets is not None)
        if max(spans) >= MOST:
            raise GeometryError(
                f"the tolerance {framed.outside(aim):.3g} needs more than {MOST} spans; {deviation:.2g} is reached "
                f"with {spans[0]} x {spans[1]}; fit parts of the surface, or give a larger tolerance"
            )
        spans = [2 * s for s in spans]


def even_knots(interval: tuple[float, float], spans: int, degree: int = DEGREE) -> Floats:
    """The knots of a B-spline over `spans` equal spans, those at both ends degree + 1 times."""
    inner = np.linspace(*interval, spans + 1)
    return np.concatenate([np.full(degree, interval[0]), inner, np.full(degree, interval[1])])


def sites(knots: Floats, degree: int = DEGREE) -> Floats:
    """Greville abscissae: the means of `degree` successive knots."""
    windows = np.lib.stride_tricks.sliding_window_view(knots[1:-1], degree)
    return np.asarray(np.clip(windows.mean(axis=1), knots[0], knots[-1]))


def _spline(knots: Floats, values: Floats) -> Floats:
    """Coefficients of the B-spline that has the values (r, ...) at the sites."""
    from scipy.interpolate import make_interp_spline

    return np.asarray(make_interp_spline(sites(knots), values, k=DEGREE, t=knots).c)


def _spans(surface: ParametricMap, axis: int, tolerance: float) -> int:
    """The power of 2 of spans in one parameter that suffices along some lines."""
    from scipy.interpolate import BSpline

    lines = np.linspace(*surface.domain[1 - axis], 17)

    def along(t: Floats) -> Floats:
        values = surface.on_grid(t, lines) if axis == 0 else np.swapaxes(surface.on_grid(lines, t), 0, 1)
        if not np.isfinite(values).all():
            raise GeometryError("the surface is not finite on the whole domain; give one that avoids its poles")
        return values

    spans = 1
    while spans < MOST:
        knots, dense = even_knots(surface.domain[axis], spans), np.linspace(*surface.domain[axis], DENSE * spans + 1)
        errors = along(dense) - BSpline(knots, _spline(knots, along(sites(knots))), DEGREE)(dense)
        if np.linalg.norm(errors, axis=-1).max() <= tolerance:
            break
        spans *= 2
    return spans


def _interpolated(surface: ParametricMap, spans: list[int]) -> tuple[Knots, Floats]:
    first, second = (even_knots(interval, s) for interval, s in zip(surface.domain, spans, strict=True))
    values = surface.on_grid(sites(first), sites(second))
    rows = _spline(first, values)
    return (first, second), np.swapaxes(_spline(second, np.swapaxes(rows, 0, 1)), 0, 1)


def _compared(surface: ParametricMap, knots: Knots, points: Floats) -> float:
    """The greatest distance at DENSE points a span, and 97 at least in each parameter, some rows at once."""
    from scipy.interpolate import BSpline

    places = [np.linspace(k[0], k[-1], max(96, DENSE * (len(k) - 2 * DEGREE - 1)) + 1) for k in knots]
    first, second = (BSpline(k, np.eye(len(k) - DEGREE - 1), DEGREE)(p) for k, p in zip(knots, places, strict=True))
    worst = 0.0
    for rows in np.array_split(np.arange(len(places[0])), -(-len(places[0]) // 64)):
        values = np.einsum("bj,ajx->abx", second, np.tensordot(first[rows], points, 1), optimize=True)
        off = surface.on_grid(places[0][rows], places[1]) - values
        worst = max(worst, float(np.linalg.norm(off, axis=-1).max()))
    return worst


def _outer(knots: Floats, interval: tuple[fmpq, fmpq]) -> tuple[Floats, float]:
    """Knots in the surface's own parameter, rounded, and by what share of their distance that moves them at most."""
    low, high = interval
    true = [low + (high - low) * exact(k) for k in knots]
    rounded = np.array([to_float(k) for k in true])
    worst = max(abs(exact(r) - k) for r, k in zip(rounded, true, strict=True))
    return rounded, to_float(worst * (len(knots) - 2 * DEGREE - 1) / (high - low))


def _bound(nets: Nets, knots: Knots, points: Floats, moved: Sequence[float]) -> float:
    """The greatest coefficient of N - D S over the least of D's, over all rectangles between knots, and rounding.

    Knots that move by a share e of their distance change each of de Boor's weights by 3 e at most, and the spline by
    3 DEGREE e times the greatest step between control points (here taken twice).
    """
    first, second = (_extraction(k) for k in knots)
    strips = _spread(nets, 0, len(first))
    worst = 0.0
    for number in range(len(strips)):
        checkpoint("bounding the distance of a B-spline", number / len(strips))
        cells = _spread(strips.select(np.array([number])), 1, len(second))
        pieces = np.einsum("ai,ijx,cbj->cabx", first[number], points, second, optimize=True)
        rounding = 256 * UNIT_ROUNDOFF  # of products of nets by bicubic ones, themselves made from control points
        errors, slack = distances(cells, pieces, rounding)
        worst = max(worst, float((lengths(errors).max(axis=(1, 2)) + slack).max()))
    steps = [float(lengths(np.diff(points, axis=axis)).max()) for axis in (0, 1)]
    return worst + sum(6 * DEGREE * share * step for share, step in zip(moved, steps, strict=True))


def _spread(nets: Nets, axis: int, count: int) -> Nets:
    """A net over `count` (a power of 2) equal parts of its interval, in order."""
    while len(nets) < count:
        order = np.arange(2 * len(nets)).reshape(2, -1).T.ravel()
        nets = nets.halves(axis).select(order)
    return nets


def _extraction(knots: Floats) -> Floats:
    """Matrices (spans, DEGREE + 1, r) from B-spline to Bernstein coefficients on each span, by Taylor coefficients."""
    from scipy.interpolate import BSpline

    size = len(knots) - DEGREE - 1
    basis = BSpline(knots, np.eye(size), DEGREE)
    starts, widths = knots[DEGREE:size], np.diff(knots[DEGREE : size + 1])
    taylor = [basis(starts, nu=j) * (widths**j / factorial(j))[:, None] for j in range(DEGREE + 1)]
    shares = np.array([[comb(i, j) / comb(DEGREE, j) for j in range(DEGREE + 1)] for i in range(DEGREE + 1)])
    return np.asarray(np.einsum("ij,jsr->sir", shares, np.stack(taylor)))
