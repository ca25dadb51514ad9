"""Parametric surfaces as patches: exact rational Bezier patches, and B-splines within a tolerance.

Over a rectangle an exact surface is a rational Bezier patch over its least common denominator; weights are the
denominator's Bernstein coefficients.  Where these are not all positive the rectangle is halved: if the
denominator has no zero they become positive (Farouki and Rajan 1988 on convergence).

Guaranteed: `bezier_patches` are the surface, identically.  `fit_patch` of an exact surface is certified: S being the
B-spline and N / D the surface, the Bernstein coefficients of N - D S over the least of D's bound the distance on each
rectangle between knots, and rounding is counted in.  For other surfaces the distance is measured at DENSE points for
each of these and each parameter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb, factorial
from typing import Any, Protocol

import numpy as np
from flint import fmpq

from pas.algebra.inputs import check_tolerance, short, shown
from pas.algebra.lengths import lengths
from pas.algebra.monomials import Floats
from pas.algebra.rational import exact, plain, rational, to_float, to_fraction
from pas.bernstein.boxes import product
from pas.bernstein.signs import UNIT_ROUNDOFF
from pas.bernstein.subdivision import halves
from pas.errors import GeometryError
from pas.limits import Report, checkpoint, limited
from pas.parametric.framed import Framed
from pas.parametric.meshing import RELATIVE, exact_rectangle
from pas.parametric.nets import ExactNet, Nets, exact_net
from pas.parametric.patches import ExactControl, Knots, RationalPatch
from pas.parametric.surface import ParametricSurface

HALVINGS = 16
"""Halvings after which a denominator without positive coefficients is taken to have a zero."""

LIGHTEST = fmpq(1, 10**100)
"""Weights from this to its inverse are left as they are; doubles hold them and their products."""

PRODUCT = 256 * UNIT_ROUNDOFF
"""Relative error of the coefficients of products of nets by bicubic ones, themselves worked out from control points."""

DEGREE = 3
"""Of B-splines in both parameters."""

MOST = 512
"""Spans of a B-spline in one parameter."""

LINES = 17
"""Lines of one parameter along which the spans of the other are chosen."""

DENSE, LEAST = 6, 96
"""Points for each span at which surfaces that are not exact are compared, and in all at least."""

ROWS = 64
"""Rows of them at once."""

SHARE = 0.4
"""Of the tolerance: what the choice of spans allows each parameter."""


@dataclass(frozen=True, eq=False)
class FittedPatch(RationalPatch):
    """A B-spline with its distance from the surface, at equal parameters: proved where `certified`, else measured."""

    deviation: float = 0.0
    certified: bool = False


def bezier_patch(surface: ParametricSurface, domain: Any = None) -> RationalPatch:
    """The exact rational Bezier patch of an exact surface over a rectangle of rational numbers.

    `domain` is by default the surface's own, None for an interval or an end that is its own.  Raises `ValueError` for a
    surface that is not exact or an infinite domain, `GeometryError` where a weight is not positive: then
    `bezier_patches` gives several patches, if there is no pole.
    """
    net = exact_net(surface, exact_rectangle(surface, domain))
    least = min(w for row in net.below for w in row)
    if least <= 0:
        raise GeometryError(
            f"a weight of this patch is not positive ({short(plain(least))}); bezier_patches splits it into several"
        )
    return _patch(net)


@limited("splitting a surface into patches", "a smaller domain")
def bezier_patches(
    surface: ParametricSurface, domain: Any = None, *, seconds: float | None = None, progress: Report | None = None
) -> tuple[RationalPatch, ...]:
    """Exact rational Bezier patches of positive weights that cover a rectangle; one where that is possible.

    Raises what `bezier_patch` raises, but `GeometryError` only for a pole.
    """
    pending = [(exact_net(surface, exact_rectangle(surface, domain)), 0)]
    found: list[RationalPatch] = []
    while pending:
        net, depth = pending.pop()
        checkpoint("splitting a surface into patches")
        if min(w for row in net.below for w in row) > 0:
            found.append(_patch(net))
            continue
        corners = [net.below[i][j] for i in (0, -1) for j in (0, -1)]
        if depth >= HALVINGS or min(corners) <= 0:
            place = ", ".join(
                f"{name} = {to_float((a + b) / 2):.6g}"
                for name, (a, b) in zip(surface.parameters, net.rectangle, strict=True)
            )
            raise GeometryError(
                f"the surface has, or nearly has, a pole or base point near {place}; give a domain that avoids it"
            )
        splits = [_split(net, axis) for axis in (0, 1)]
        best = max(splits, key=lambda halves: min(_least(half) for half in halves))
        pending += [(half, depth + 1) for half in reversed(best)]
    return tuple(found)


class HasSurface(Protocol):
    """A blend, say."""

    @property
    def surface(self) -> ParametricSurface:
        """The surface that it is."""


def surface_of(thing: ParametricSurface | HasSurface) -> ParametricSurface:
    """A surface itself, or that of a blend; raises `TypeError` for what has none."""
    found = thing if isinstance(thing, ParametricSurface) else getattr(thing, "surface", None)
    if not isinstance(found, ParametricSurface):
        raise TypeError(f"surface must be a parametric surface or a blend of such, not {shown(thing)}")
    return found


@limited("fitting a patch", "a coarser tolerance or a smaller domain")
def fit_patch(
    surface: ParametricSurface | HasSurface,
    tolerance: Any = None,
    domain: Any = None,
    *,
    seconds: float | None = None,
    progress: Report | None = None,
) -> FittedPatch:
    """A bicubic B-spline nowhere further than `tolerance` from the surface (by default a thousandth of its extent).

    For a blend, of its `surface`.  It interpolates at the Greville abscissae of uniform knots.

    Raises `ValueError` for an infinite domain, `GeometryError` for a pole or where MOST spans do not suffice.
    """
    whole = surface_of(surface)
    rectangle = exact_rectangle(whole, domain)
    framed = Framed.of(whole.with_domain(rectangle))
    aim = RELATIVE * framed.size if tolerance is None else framed.inside(check_tolerance(tolerance))
    nets = exact_net(framed.bounded, rectangle).rounded(framed.unit) if whole.is_exact else None
    spans = [_spans(framed.surface, axis, aim * SHARE) for axis in (0, 1)]
    while True:
        knots, points = _interpolated(framed.surface, spans)
        outer = tuple(_outer(k, e) for k, e in zip(knots, rectangle, strict=True))
        away = _compared(framed.surface, knots, points) if nets is None else _bound(nets, knots, points, outer)
        deviation = framed.outside(away)
        if away <= aim:
            ends, control = (outer[0].knots, outer[1].knots), framed.points_outside(points)
            return FittedPatch(control, np.ones(points.shape[:2]), ends, None, deviation, nets is not None)
        if max(spans) >= MOST:
            raise GeometryError(
                f"the tolerance {framed.outside(aim):.3g} needs more than {MOST} spans; {deviation:.2g} is reached "
                f"with {spans[0]} x {spans[1]}; fit parts of the surface, or give a larger tolerance"
            )
        spans = [2 * s for s in spans]


def _patch(net: ExactNet) -> RationalPatch:
    scale = _weight_scale(net)
    weights = np.array([[to_fraction(w / scale) for w in row] for row in net.below], dtype=object)
    points = np.empty((*weights.shape, 3), dtype=object)
    for axis, table in enumerate(net.tops):
        for i, (row, below) in enumerate(zip(table, net.below, strict=True)):
            points[i, :, axis] = [to_fraction(c / w) for c, w in zip(row, below, strict=True)]
    ends = np.array([[to_fraction(e) for e in interval] for interval in net.rectangle], dtype=object)
    knots = tuple(np.repeat(e, size) for e, size in zip(_doubles(ends), weights.shape, strict=True))
    exact = ExactControl(points, weights, ends)
    return RationalPatch(_doubles(points), _doubles(weights), (knots[0], knots[1]), exact)


def _weight_scale(net: ExactNet) -> fmpq:
    """What the weights are divided by: 1, or the greatest of them where doubles would not hold them as they are."""
    weights = [w for row in net.below for w in row]
    least, greatest = min(weights), max(weights)
    if least / greatest < LIGHTEST:
        raise GeometryError(
            f"the weights of this patch differ by more than a factor of {to_float(1 / LIGHTEST):.0e}; convert a part "
            "of the domain where the denominators vary less"
        )
    return fmpq(1) if least > LIGHTEST and greatest < 1 / LIGHTEST else greatest


def _doubles(numbers: Any) -> Floats:
    """An array of fractions in doubles; raises `GeometryError` where one is beyond their range."""
    found = np.vectorize(lambda x: to_float(rational(x)), otypes=[float])(numbers)
    if not np.isfinite(found).all():
        raise GeometryError("a control point is beyond the range of doubles (1.8e308); scale the surface")
    return np.asarray(found)


def _split(net: ExactNet, axis: int) -> tuple[ExactNet, ExactNet]:
    tables = [halves(np.array(table, dtype=object), axis) for table in (*net.tops, net.below)]
    low, high = net.rectangle[axis]
    parts = []
    for side, interval in ((0, (low, (low + high) / 2)), (1, ((low + high) / 2, high))):
        x, y, z, w = (pair[side].tolist() for pair in tables)
        sides = (interval, net.rectangle[1]) if axis == 0 else (net.rectangle[0], interval)
        parts.append(ExactNet((x, y, z), w, sides))
    return parts[0], parts[1]


def _least(net: ExactNet) -> Fraction:
    """The least weight over the greatest."""
    weights = [w for row in net.below for w in row]
    return to_fraction(min(weights) / max(abs(w) for w in weights))


def _knots(interval: tuple[float, float], spans: int) -> Floats:
    inner = np.linspace(*interval, spans + 1)
    return np.concatenate([np.full(DEGREE, interval[0]), inner, np.full(DEGREE, interval[1])])


def _sites(knots: Floats) -> Floats:
    """Greville abscissae: means of DEGREE successive knots."""
    windows = np.lib.stride_tricks.sliding_window_view(knots[1:-1], DEGREE)
    return np.asarray(np.clip(windows.mean(axis=1), knots[0], knots[-1]))


def _spline(knots: Floats, values: Floats) -> Floats:
    """Coefficients of the B-spline that has the values (r, ...) at the sites."""
    from scipy.interpolate import make_interp_spline

    return np.asarray(make_interp_spline(_sites(knots), values, k=DEGREE, t=knots).c)


def _spans(surface: ParametricSurface, axis: int, tolerance: float) -> int:
    """The power of 2 of spans in one parameter that suffices along some lines."""
    from scipy.interpolate import BSpline

    lines = np.linspace(*surface.domain[1 - axis], LINES)

    def along(t: Floats) -> Floats:
        values = surface.on_grid(t, lines) if axis == 0 else np.swapaxes(surface.on_grid(lines, t), 0, 1)
        if not np.isfinite(values).all():
            raise GeometryError("the surface is not finite on the whole domain; give one that avoids its poles")
        return values

    spans = 1
    while spans < MOST:
        knots = _knots(surface.domain[axis], spans)
        dense = np.linspace(*surface.domain[axis], DENSE * spans + 1)
        errors = along(dense) - BSpline(knots, _spline(knots, along(_sites(knots))), DEGREE)(dense)
        if np.linalg.norm(errors, axis=-1).max() <= tolerance:
            break
        spans *= 2
    return spans


def _interpolated(surface: ParametricSurface, spans: list[int]) -> tuple[Knots, Floats]:
    first, second = (_knots(interval, s) for interval, s in zip(surface.domain, spans, strict=True))
    values = surface.on_grid(_sites(first), _sites(second))
    rows = _spline(first, values)
    return (first, second), np.swapaxes(_spline(second, np.swapaxes(rows, 0, 1)), 0, 1)


def _compared(surface: ParametricSurface, knots: Knots, points: Floats) -> float:
    """The greatest distance at DENSE points a span."""
    from scipy.interpolate import BSpline

    places = [np.linspace(k[0], k[-1], max(LEAST, DENSE * (len(k) - 2 * DEGREE - 1)) + 1) for k in knots]
    first, second = (BSpline(k, np.eye(len(k) - DEGREE - 1), DEGREE)(p) for k, p in zip(knots, places, strict=True))
    worst = 0.0
    for start in range(0, len(places[0]), ROWS):
        rows = slice(start, start + ROWS)
        values = np.einsum("bj,ajx->abx", second, np.tensordot(first[rows], points, 1), optimize=True)
        off = surface.on_grid(places[0][rows], places[1]) - values
        worst = max(worst, float(np.linalg.norm(off, axis=-1).max()))
    return worst


@dataclass(frozen=True)
class _Outer:
    """Knots in the surface's own parameter, rounded, and by what share of their distance that moves them at most."""

    knots: Floats
    moved: float


def _outer(knots: Floats, interval: tuple[fmpq, fmpq]) -> _Outer:
    low, high = interval
    true = [low + (high - low) * exact(k) for k in knots]
    rounded = np.array([to_float(k) for k in true])
    spans = len(knots) - 2 * DEGREE - 1
    worst = max(abs(exact(r) - k) for r, k in zip(rounded, true, strict=True))
    return _Outer(rounded, to_float(worst * spans / (high - low)))


def _bound(nets: Nets, knots: Knots, points: Floats, outer: Sequence[_Outer]) -> float:
    """The greatest coefficient of N - D S over the least of D's, over all rectangles between knots, and rounding.

    Knots that move by a share e of their distance change each of de Boor's weights by 3 e at most, and the spline by
    3 DEGREE e times the greatest step between control points (here taken twice).
    """
    first, second = (_extraction(k) for k in knots)
    strips = _spread(nets, 0, len(first))
    worst = 0.0
    for number in range(len(strips)):
        checkpoint("bounding the distance of a B-spline", number / len(strips))
        cells = _spread(strips.part([number]), 1, len(second))
        pieces = np.einsum("ai,ijx,cbj->cabx", first[number], points, second, optimize=True)
        tops, weights = cells.table[..., :3], cells.table[..., 3:]
        least = weights.min(axis=(1, 2, 3)) - cells.off
        if not (least > 0).all():
            return float("inf")
        errors = product(tops, np.ones((1, DEGREE + 1, DEGREE + 1, 1))) - product(weights, pieces)
        far = 1.0 + np.abs(pieces).max(axis=(1, 2, 3))
        slack = 2 * far * (cells.off + PRODUCT * np.abs(cells.table).max(axis=(1, 2, 3)))
        worst = max(worst, float(((lengths(errors).max(axis=(1, 2)) + slack) / least).max()))
    steps = [float(lengths(np.diff(points, axis=axis)).max()) for axis in (0, 1)]
    return worst + sum(6 * DEGREE * o.moved * step for o, step in zip(outer, steps, strict=True))


def _spread(nets: Nets, axis: int, count: int) -> Nets:
    """A net over `count` (a power of 2) equal parts of its interval, in order."""
    while len(nets) < count:
        order = np.arange(2 * len(nets)).reshape(2, -1).T.ravel()
        nets = nets.halves(axis).part(order)
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
